#include "studies/input/made_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "core/mesh/quality.hpp"
#include "core/model/model.hpp"
#include "studies/input/size_estimate.hpp"

namespace stickslip {
namespace {

/// Reports a fault of a generator, which begins with the key that it is about, at that key, with what it was given.
void report_mesh_fault(const JsonNode& mesh, const std::string& fault) {
  for (const auto& [kind, generator] : mesh.members())
    if (const auto named =
            generator.value().is_object() ? generator.find(fault.substr(0, fault.find(' '))) : std::nullopt)
      return named->error("is " + shown(named->value()) + "; " + fault);
  mesh.error(fault);
}

/// Whether there is memory for the mesh, and those before it; reported at its cells where there is not.
bool fits(const JsonNode& node, const MeshDescription& description, const std::string& element, MeshOf whose,
          SceneReading& reading) {
  constexpr double bytes_of_rigid_node = 800;  // measured 730 in space
  const double nodes = estimated_nodes(description, element);
  (whose == MeshOf::body ? reading.nodes : reading.rigid_nodes) += nodes;
  const bool in_space = reading.dimension() == 3;
  const double limit = memory_limit(),
               bytes = estimated_bytes({.displacements = reading.dimension() * reading.nodes, .in_space = in_space}) +
                       bytes_of_rigid_node * reading.rigid_nodes;
  if (bytes <= limit) return true;
  std::string message = "makes " + shown(std::round(nodes)) + " nodes, which need " + too_much(bytes, limit);
  if (reading.nodes + reading.rigid_nodes > nodes) message = message + " (with the meshes before it)";
  message =
      message + "; try fewer cells, half of them each way need " + (in_space ? "less than a tenth" : "about a quarter");
  for (const auto& [kind, generator] : node.members())
    if (const auto cells = generator.value().is_object() ? generator.find("cells") : std::nullopt) {
      cells->error("is " + shown(cells->value()) + ", which " + message);
      return false;
    }
  node.error(message);
  return false;
}

bool is_graded(const Number& ratio) { return ratio.value != 1; }
bool is_graded(const std::vector<Grading>& grade) {
  return std::any_of(grade.begin(), grade.end(), [](const Grading& g) { return is_graded(g.ratio); });
}

/// The mesh with cells that are all alike; none where it has no grade, or one that makes no difference.
std::optional<MeshDescription> without_grade(const MeshDescription& description) {
  return std::visit(
      []<class M>(const M& mesh) -> std::optional<MeshDescription> {
        if constexpr (requires { mesh.grade; }) {
          M even = mesh;
          even.grade = M{}.grade;
          if (is_graded(mesh.grade)) return even;
        }
        return std::nullopt;
      },
      description);
}

/// Reports a fault of an element: at the grade, where cells that are all alike would be sound. `is_sound(points)`.
template <class IsSound>
void report_element(const JsonNode& node, const MeshDescription& description, const Mesh& mesh,
                    const std::string& fault, const SceneReading& reading, IsSound&& is_sound) {
  const auto even = without_grade(description);
  if (even && is_sound(make_points<double>(*even, mesh, reading.scene.as<double>())))
    for (const auto& [kind, generator] : node.members())
      if (const auto grade = generator.find("grade"))
        return grade->error("is " + shown(grade->value()) + "; with it " + fault + "; try one nearer to 1");
  node.error(fault);
}

/// Reports the inverted element `bad`.
void report_inverted(const JsonNode& node, const MeshDescription& description, const Mesh& mesh,
                     const Points<double>& points, int bad, const SceneReading& reading) {
  std::string fault = "element " + std::to_string(bad + 1) + " is inverted or flat; its corners are";
  const int n = nodes_of(mesh.shape);
  for (int a = 0; a < n; ++a) {
    const auto x = points.col(mesh.connectivity[bad * n + a]);
    for (Eigen::Index i = 0; i < x.size(); ++i) fault += (i == 0 ? " (" : ", ") + shown(x[i]);
    fault += ")";
  }
  report_element(node, description, mesh, fault, reading,
                 [&](const auto& even) { return !first_inverted_element(mesh, even); });
}

/// Reports an element that is too thin for its strain to have digits.
void report_thin(const JsonNode& node, const MeshDescription& description, const Mesh& mesh, const ThinElement& thin,
                 const SceneReading& reading) {
  const std::string fault = "element " + std::to_string(thin.element + 1) + " is " + shown(thin.thickness) +
                            " thick where coordinates reach " + shown(thin.size) +
                            ": rounding leaves its strain less than four digits";
  report_element(node, description, mesh, fault, reading,
                 [&](const auto& even) { return !first_thin_element(mesh, even); });
}

}  // namespace

std::optional<Mesh> made_mesh(const JsonNode& owner, const JsonNode& node, const MeshDescription& description,
                              const std::string& element, MeshOf whose, SceneReading& reading) {
  if (reading.diagnostics.has_error_in(node.pointer())) return std::nullopt;
  if (const auto message = mesh_fault(description, "", reading.dimension()); !message.empty()) {
    report_mesh_fault(node, message);
    return std::nullopt;
  }
  if (const auto message = mesh_fault(description, element, reading.dimension()); !message.empty()) {
    owner.find("element")->error(message);
    return std::nullopt;
  }
  if (!fits(node, description, element, whose, reading)) return std::nullopt;
  Mesh mesh = make_mesh(description, element, reading.dimension());
  const auto points = make_points<double>(description, mesh, reading.scene.as<double>());
  if (const auto message = radius_fault(reading.scene.space, points, {mesh}); !message.empty()) {
    node.error(message);
    return std::nullopt;
  }
  if (const auto bad = first_inverted_element(mesh, points)) {
    report_inverted(node, description, mesh, points, *bad, reading);
    return std::nullopt;
  }
  if (const auto thin = first_thin_element(mesh, points)) {
    report_thin(node, description, mesh, *thin, reading);
    return std::nullopt;
  }
  return mesh;
}

}  // namespace stickslip
