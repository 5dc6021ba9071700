#include "core/mesh/imported.hpp"

#include <map>

#include "core/mesh/structured.hpp"

namespace stickslip {

std::string fault(const ImportedMesh& imported, const std::string& element, int dimension) {
  const std::string body = "body " + imported.body;
  if (imported.mesh.dimension != dimension)
    return body + (dimension == 3 ? " is a plane mesh, the space is not" : " fills space, the space is plane");
  static const std::map<ElementShape, std::string> names = {
      {ElementShape::tri3, "T3"},   {ElementShape::quad4, "Q4"},  {ElementShape::tri6, "T6"},
      {ElementShape::quad8, "Q8"},  {ElementShape::tet4, "T4"},   {ElementShape::hex8, "H8"},
      {ElementShape::tet10, "T10"}, {ElementShape::hex20, "H20"}, {ElementShape::hex27, "H27"}};
  const std::string& own = names.at(imported.mesh.shape);
  const bool averaged = has_mean_dilatation(element) && element == own + "_mean_dilatation";
  if (!element.empty() && element != own && !averaged) return body + " is made of " + own + ", not " + element;
  return "";
}

Mesh topology(const ImportedMesh& imported, const std::string&, int) { return imported.mesh; }

}  // namespace stickslip
