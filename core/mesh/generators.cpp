#include "core/mesh/generators.hpp"

#include <stdexcept>

namespace stickslip {

Filling filling_of(const MeshDescription& description) {
  return std::visit([](const auto& mesh) { return mesh.filling; }, description);
}

std::string mesh_fault(const MeshDescription& description, const std::string& element, int dimension) {
  return std::visit([&](const auto& mesh) { return fault(mesh, element, dimension); }, description);
}

Mesh make_mesh(const MeshDescription& description, const std::string& element, int dimension) {
  if (const std::string message = mesh_fault(description, element, dimension); !message.empty())
    throw std::invalid_argument(message);
  Mesh mesh = std::visit([&](const auto& kind) { return topology(kind, element, dimension); }, description);
  const bool imported = std::holds_alternative<ImportedMesh>(description);
  const auto quadratic = quadratic_shape(element);
  return quadratic && !imported ? with_middles(mesh, *quadratic) : mesh;
}

template Points<double> make_points(const MeshDescription&, const Numbers<double>&, int);
template Points<double> make_points(const MeshDescription&, const Mesh&, const Numbers<double>&);

}  // namespace stickslip
