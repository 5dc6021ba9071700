#include "core/mesh/generators.hpp"

#include <map>
#include <stdexcept>

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

std::string mesh_fault(const MeshDescription& description, const std::string& element, int dimension) {
  return std::visit([&](const auto& mesh) { return fault(mesh, element, dimension); }, description);
}

Mesh make_mesh(const MeshDescription& description, const std::string& element, int dimension) {
  if (const std::string message = mesh_fault(description, element, dimension); !message.empty())
    throw std::invalid_argument(message);
  Mesh mesh = std::visit([&](const auto& kind) { return topology(kind, element, dimension); }, description);
  const bool imported = std::holds_alternative<ImportedMesh>(description);
  return is_quadratic(element) && !imported ? with_middles(mesh) : mesh;
}

template Points<double> make_points(const MeshDescription&, const Numbers<double>&, int);
template Points<double> make_points(const MeshDescription&, const Mesh&, const Numbers<double>&);

}  // namespace stickslip
