#include "core/mesh/imported.hpp"

#include <map>

#include "core/mesh/structured.hpp"

namespace stickslip {

std::string fault(const ImportedMesh& imported, const std::string& element, int dimension) {
  if (imported.mesh.dimension != dimension) return "an imported mesh is plane, the space is not";
  static const std::map<ElementShape, std::string> names = {
      {ElementShape::tri3, "T3"}, {ElementShape::quad4, "Q4"}, {ElementShape::tri6, "T6"}, {ElementShape::quad8, "Q8"}};
  const std::string& own = names.at(imported.mesh.shape);
  const bool averaged = own == "Q4" && has_mean_dilatation(element);
  if (!element.empty() && element != own && !averaged)
    return "body " + imported.body + " is made of " + own + ", not " + element;
  return "";
}

Mesh topology(const ImportedMesh& imported, const std::string&, int) { return imported.mesh; }

}  // namespace stickslip
