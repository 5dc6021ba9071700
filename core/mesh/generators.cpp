#include "core/mesh/generators.hpp"

#include <stdexcept>

namespace stickslip {

std::string fault(const ImportedMesh& imported, const std::string& element, int dimension) {
  if (imported.mesh.dimension != dimension) return "an imported mesh is plane, the space is not";
  const std::string own = imported.mesh.shape == ElementShape::tri3 ? "T3" : "Q4";
  if (!element.empty() && element != own) return "body " + imported.body + " is made of " + own + ", not " + element;
  return "";
}

Mesh topology(const ImportedMesh& imported, const std::string&, int) { return imported.mesh; }

std::string mesh_fault(const MeshDescription& description, const std::string& element, int dimension) {
  return std::visit([&](const auto& mesh) { return fault(mesh, element, dimension); }, description);
}

Mesh make_mesh(const MeshDescription& description, const std::string& element, int dimension) {
  if (const std::string message = mesh_fault(description, element, dimension); !message.empty())
    throw std::invalid_argument(message);
  return std::visit([&](const auto& mesh) { return topology(mesh, element, dimension); }, description);
}

}  // namespace stickslip
