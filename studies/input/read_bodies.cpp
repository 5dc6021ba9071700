#include <algorithm>
#include <cmath>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/model/model.hpp"
#include "studies/input/file_objects.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/mesh_kinds.hpp"
#include "studies/input/size_estimate.hpp"

namespace stickslip {
namespace {

std::optional<Material> read_material(const JsonNode& node, const MeshDescription* mesh, SceneReading& reading) {
  const auto& kinds = material_kinds();
  std::vector<std::string> keys, allowed;
  std::string places;
  const bool finite = reading.scene.finite_strain;
  for (const auto& kind : kinds) {
    keys.push_back(kind.key);
    if (mesh && kind.goes_with(filling_of(*mesh), finite)) allowed.push_back(kind.key);
    places += (places.empty() ? "" : ", ") + keys.back() + " " + kind.place;
  }
  const auto chosen = node.kind(keys);
  if (!chosen) return std::nullopt;
  const auto& [name, material] = *chosen;
  if (mesh && std::find(allowed.begin(), allowed.end(), name) == allowed.end())
    material.error_at_key(in_quotes(name) + " does not go with this mesh at " + (finite ? "finite" : "small") +
                          " strain; allowed: " + listed(allowed) + " (" + places + ")");
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&name = name](const auto& k) { return name == k.key; });
  return kind->read(material, reading);
}

/// Reports a fault of a generator, which begins with the key that it is about, at that key, with what it was given.
void report_mesh_fault(const JsonNode& mesh, const std::string& fault) {
  for (const auto& [kind, generator] : mesh.members())
    if (const auto named =
            generator.value().is_object() ? generator.find(fault.substr(0, fault.find(' '))) : std::nullopt)
      return named->error("is " + shown(named->value()) + "; " + fault);
  mesh.error(fault);
}

/// Whether there is memory for the mesh, and those before it; reported at its cells where there is not.
bool fits(const JsonNode& node, const MeshDescription& description, const std::string& element, SceneReading& reading) {
  const double nodes = estimated_nodes(description, element);
  reading.nodes += nodes;
  const bool in_space = reading.dimension() == 3;
  const double limit = memory_limit(),
               bytes = estimated_bytes({.displacements = reading.dimension() * reading.nodes, .in_space = in_space});
  if (bytes <= limit) return true;
  std::string message = "makes " + shown(std::round(nodes)) + " nodes, which need " + too_much(bytes, limit);
  if (reading.nodes > nodes) message = message + " (with the bodies before it)";
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

/// Makes the mesh and looks at it; none where it is at fault.
std::optional<Mesh> check_mesh(const JsonNode& body, const JsonNode& node, const MeshDescription& description,
                               const std::string& element, SceneReading& reading) {
  if (reading.diagnostics.has_error_in(node.pointer())) return std::nullopt;
  if (const auto message = mesh_fault(description, "", reading.dimension()); !message.empty()) {
    report_mesh_fault(node, message);
    return std::nullopt;
  }
  if (const auto message = mesh_fault(description, element, reading.dimension()); !message.empty()) {
    body.find("element")->error(message);
    return std::nullopt;
  }
  if (!fits(node, description, element, reading)) return std::nullopt;
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

/// The area of bars, the thickness of a plane continuum.
void read_section(const JsonNode& node, const MeshDescription& mesh, Body& body, SceneReading& reading) {
  const auto area = node.find("area"), thickness = node.find("thickness");
  const Filling filling = filling_of(mesh);
  const bool bars = filling == Filling::bars;
  if (bars)
    body.area = read_number(node, scene_object("body"), "area", reading);
  else if (area)
    area->error_at_key("only bars (line, arc) have an area");
  const Space space = reading.scene.space;
  const bool plane = space == Space::plane_strain || space == Space::plane_stress;
  if (plane && filling == Filling::continuum)
    body.thickness = read_number(node, scene_object("body"), "thickness", reading);
  else if (thickness)
    thickness->error_at_key(plane ? "only a continuum has a thickness; a bar has an area"
                                  : "only a body of plane_strain or plane_stress has a thickness");
  if (const auto message = space_fault(space, {body.name, mesh, {}, body.element}); !message.empty())
    node.find(has_mean_dilatation(body.element) && !bars ? "element" : "mesh")->error(message);
}

void read_body(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_name(node, name);
  if (!node.is_object(keys_of(scene_object("body")))) return;
  Body body;
  body.name = name;
  if (const auto element = node.find("element"))
    body.element = element->choice(choices_of(scene_object("body"), "element")).value_or("");
  const auto mesh_node = node.find("mesh");
  const auto mesh = mesh_node ? read_mesh(*mesh_node, reading) : std::nullopt;
  const auto material_node = node.find("material");
  const auto material = material_node ? read_material(*material_node, mesh ? &*mesh : nullptr, reading) : std::nullopt;
  if (mesh) read_section(node, *mesh, body, reading);
  if (mesh)
    if (auto made = check_mesh(node, *mesh_node, *mesh, body.element, reading)) {
      reading.meshes.emplace(name, *std::move(made));
      reading.described.emplace(name, *mesh);
    }
  if (!mesh || !material) return;
  body.mesh = *mesh;
  body.material = *material;
  reading.scene.bodies.push_back(std::move(body));
}

}  // namespace

void read_bodies(const JsonNode& node, SceneReading& reading) {
  if (!node.is_map("bodies by name")) return;
  if (node.value().empty()) node.error("is empty; must hold one body at least");
  for (const auto& [name, body] : node.members()) reading.body_names.push_back(name);
  for (const auto& [name, body] : node.members()) read_body(name, body, reading);
}

}  // namespace stickslip
