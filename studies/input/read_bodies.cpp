#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

#include "core/mesh/generators.hpp"
#include "core/mesh/quality.hpp"
#include "core/model/model.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/size_estimate.hpp"
#include "studies/io/atomic_file.hpp"

namespace stickslip {
namespace {

std::array<Number, 2> pair_of(const std::vector<Number>& numbers) { return {numbers[0], numbers[1]}; }

/// "cells": [a, b].
std::array<int, 2> cells_of(const JsonNode& node, SceneReading& reading) {
  std::array<int, 2> cells{1, 1};
  const auto list = node.find("cells");
  const auto both = list ? list->array(2, "an array of 2 whole numbers >= 1") : std::nullopt;
  for (int i = 0; both && i < 2; ++i) cells[i] = reading.count((*both)[i], 1).value_or(1);
  constexpr double most = std::numeric_limits<int>::max() / 4.0;  // nodes of a quadrilateral are numbered by an int
  if (static_cast<double>(cells[0]) * cells[1] > most) list->must_be("fewer cells than 5e8 in all");
  return cells;
}

/// "grade": {SIDE: ratio}.
template <class Graded>
void read_grade(const JsonNode& node, const std::vector<std::string>& sides, Graded& mesh, SceneReading& reading) {
  const auto grade = node.find("grade");
  const auto towards = grade ? grade->kind(sides) : std::nullopt;
  if (!towards) return;
  mesh.grade_towards = towards->first;
  mesh.grade = reading.number(towards->second, positive);
}

std::optional<BoxMesh> read_box(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"min", "max", "cells"}, {"grade"}})) return std::nullopt;
  BoxMesh box;
  box.min = pair_of(reading.required_vector(node, "min", 2));
  box.max = pair_of(reading.required_vector(node, "max", 2));
  box.cells = cells_of(node, reading);
  for (int axis = 0; axis < 2; ++axis)
    if (box.max[axis].value <= box.min[axis].value)
      node.find("max")->elements()[axis].must_be("greater than min, which is " + shown(box.min[axis].value));
  read_grade(node, {"left", "right", "bottom", "top"}, box, reading);
  return box;
}

std::optional<QuadMesh> read_quad(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"corners", "cells"}, {"grade"}})) return std::nullopt;
  QuadMesh quad;
  const auto corners = node.find("corners");
  const auto list = corners ? corners->array(4, "four corners [x, y], counter-clockwise") : std::nullopt;
  if (!list) return std::nullopt;
  for (int k = 0; k < 4; ++k) quad.corners[k] = pair_of(reading.vector((*list)[k], 2));
  quad.cells = cells_of(node, reading);
  read_grade(node, {"left", "right", "bottom", "top"}, quad, reading);
  return quad;
}

std::optional<RingMesh> read_ring(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"center", "inner", "outer", "cells"}, {"from_angle", "to_angle", "grade"}}))
    return std::nullopt;
  RingMesh ring;
  ring.center = pair_of(reading.required_vector(node, "center", 2));
  ring.inner = reading.required(node, "inner", positive);
  ring.outer = reading.required(node, "outer", positive);
  if (ring.outer.value <= ring.inner.value)
    node.find("outer")->must_be("greater than inner, which is " + shown(ring.inner.value));
  ring.cells = cells_of(node, reading);
  ring.from_angle = reading.optional(node, "from_angle", 0, any_number);
  const auto to = node.find("to_angle");
  const double end = to ? to->number(any_number).value_or(std::numeric_limits<double>::quiet_NaN()) : 360;
  if (is_full_turn(ring.from_angle.value, end)) {
    ring.to_angle = end;
    reading.constants[child_pointer(node.pointer(), "to_angle")] =
        "where a closed ring ends, which is where it starts: from_angle is the number that turns it";
  } else {
    ring.to_angle = reading.optional(node, "to_angle", 360, any_number);
  }
  read_grade(node, {"inner", "outer"}, ring, reading);
  return ring;
}

std::optional<DiskMesh> read_disk(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"center", "radius", "cells"}, {"grade"}})) return std::nullopt;
  DiskMesh disk;
  disk.center = pair_of(reading.required_vector(node, "center", 2));
  disk.radius = reading.required(node, "radius", positive);
  disk.cells = cells_of(node, reading);
  disk.grade = reading.optional(node, "grade", 1, positive);
  return disk;
}

std::optional<HalfDiskMesh> read_half_disk(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"center", "radius", "cells"}, {"grade", "facing"}})) return std::nullopt;
  HalfDiskMesh disk;
  disk.center = pair_of(reading.required_vector(node, "center", 2));
  disk.radius = reading.required(node, "radius", positive);
  disk.cells = cells_of(node, reading);
  disk.grade = reading.optional(node, "grade", 1, positive);
  if (const auto facing = node.find("facing")) disk.facing = facing->choice({"down", "up"}).value_or("down");
  return disk;
}

std::optional<PointMesh> read_point(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"at"}})) return std::nullopt;
  return PointMesh{reading.required_vector(node, "at", reading.dimension())};
}

int chain_cells(const JsonNode& node, SceneReading& reading) {
  const auto cells = node.find("cells");
  return cells ? reading.count(*cells, 1).value_or(1) : 1;
}

std::optional<LineMesh> read_line(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"from", "to", "cells"}})) return std::nullopt;
  LineMesh line;
  line.from = reading.required_vector(node, "from", reading.dimension());
  line.to = reading.required_vector(node, "to", reading.dimension());
  line.cells = chain_cells(node, reading);
  return line;
}

std::optional<ArcMesh> read_arc(const JsonNode& node, SceneReading& reading) {
  if (!node.is_object({{"center", "radius", "from_angle", "to_angle", "cells"}})) return std::nullopt;
  ArcMesh arc;
  arc.center = pair_of(reading.required_vector(node, "center", 2));
  arc.radius = reading.required(node, "radius", positive);
  arc.from_angle = reading.required(node, "from_angle", any_number);
  arc.to_angle = reading.required(node, "to_angle", any_number);
  arc.cells = chain_cells(node, reading);
  return arc;
}

/// The mesh file's content, read at most once; none where it cannot be read.
const MeshFile* mesh_file(const JsonNode& node, const std::string& name, SceneReading& reading) {
  const std::string path = (reading.folder / name).lexically_normal().string();
  auto found = reading.mesh_files.find(path);
  if (found == reading.mesh_files.end()) {
    constexpr std::uintmax_t most = std::uintmax_t{1} << 30;  // some 10 million nodes
    if (const std::string fault = unreadable(path, most); !fault.empty()) {
      node.error("the mesh file " + path + " " + fault);
      return nullptr;
    }
    const std::string text = read_file(path);
    std::istringstream content(text);
    found = reading.mesh_files.emplace(path, MeshFile{read_msh(content, path), fingerprint(text)}).first;
  }
  reading.mesh_fingerprints[name] = found->second.fingerprint;
  for (const std::string& error : found->second.content.errors) reading.diagnostics.error({{}, "", error});
  return &found->second;
}

std::optional<ImportedMesh> read_gmsh(const JsonNode& mesh, const JsonNode& node, SceneReading& reading) {
  const auto name = node.text();
  const auto body = mesh.find("body");
  if (!body) mesh.error(R"(the key "body" is missing: the physical name of a surface in the mesh file)");
  const auto body_name = body ? body->text() : std::nullopt;
  const MeshFile* file = name ? mesh_file(node, *name, reading) : nullptr;
  if (!file || !body_name) return std::nullopt;
  for (const ImportedMesh& each : file->content.bodies)
    if (each.body == *body_name) return each;
  // a file that is at fault may lack the body for that reason
  if (file->content.errors.empty()) body->error(body_error(file->content, *body_name));
  return std::nullopt;
}

template <class Kind>
std::optional<MeshDescription> described(std::optional<Kind> mesh) {
  if (!mesh) return std::nullopt;
  return MeshDescription(*std::move(mesh));
}

std::optional<MeshDescription> read_mesh(const JsonNode& node, SceneReading& reading) {
  const auto kind =
      node.kind({"box", "quad", "ring", "disk", "half_disk", "point", "line", "arc", "gmsh"}, {"sphere"}, {"body"});
  if (!kind) return std::nullopt;
  const auto& [name, mesh] = *kind;
  if (name != "gmsh")
    if (const auto body = node.find("body")) body->error_at_key("belongs to gmsh, not to " + name);
  if (reading.dimension() == 3 && name != "point" && name != "line" && name != "arc") {
    mesh.error_at_key(in_quotes(name) +
                      " in the space solid is not available in this version; allowed: point, line, arc");
    return std::nullopt;
  }
  if (name == "box") return described(read_box(mesh, reading));
  if (name == "quad") return described(read_quad(mesh, reading));
  if (name == "ring") return described(read_ring(mesh, reading));
  if (name == "disk") return described(read_disk(mesh, reading));
  if (name == "half_disk") return described(read_half_disk(mesh, reading));
  if (name == "point") return described(read_point(mesh, reading));
  if (name == "line") return described(read_line(mesh, reading));
  if (name == "arc") return described(read_arc(mesh, reading));
  return described(read_gmsh(node, mesh, reading));
}

Filling filling_of(const MeshDescription& mesh) {
  if (std::holds_alternative<PointMesh>(mesh)) return Filling::point;
  const bool chain = std::holds_alternative<LineMesh>(mesh) || std::holds_alternative<ArcMesh>(mesh);
  return chain ? Filling::bars : Filling::continuum;
}

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
  const double limit = memory_limit(), bytes = estimated_bytes({reading.dimension() * reading.nodes});
  if (bytes <= limit) return true;
  std::string message = "makes " + shown(std::round(nodes)) + " nodes, which need " + too_much(bytes, limit);
  if (reading.nodes > nodes) message = message + " (with the bodies before it)";
  message = message + "; try fewer cells, half of them each way need about a quarter";
  for (const auto& [kind, generator] : node.members())
    if (const auto cells = generator.value().is_object() ? generator.find("cells") : std::nullopt) {
      cells->error("is " + shown(cells->value()) + ", which " + message);
      return false;
    }
  node.error(message);
  return false;
}

/// The mesh with cells that are all alike; none where it has no grade, or one that makes no difference.
std::optional<MeshDescription> without_grade(const MeshDescription& description) {
  return std::visit(
      []<class M>(const M& mesh) -> std::optional<MeshDescription> {
        if constexpr (requires { mesh.grade; }) {
          M even = mesh;
          even.grade = 1.0;
          if (mesh.grade.value != 1) return even;
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
    fault += " (" + shown(x[0]) + ", " + shown(x[1]) + ")";
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
  const bool bars = std::holds_alternative<LineMesh>(mesh) || std::holds_alternative<ArcMesh>(mesh);
  if (bars)
    body.area = reading.optional(node, "area", 1, positive);
  else if (area)
    area->error_at_key("only bars (line, arc) have an area");
  const Space space = reading.scene.space;
  const bool plane = space == Space::plane_strain || space == Space::plane_stress;
  if (plane && !bars && !std::holds_alternative<PointMesh>(mesh))
    body.thickness = reading.optional(node, "thickness", 1, positive);
  else if (thickness)
    thickness->error_at_key(plane ? "only a continuum has a thickness; a bar has an area"
                                  : "only a body of plane_strain or plane_stress has a thickness");
  if (const auto message = space_fault(space, {body.name, mesh, {}, body.element}); !message.empty())
    node.find(has_mean_dilatation(body.element) && !bars ? "element" : "mesh")->error(message);
}

void read_body(const std::string& name, const JsonNode& node, SceneReading& reading) {
  check_name(node, name);
  if (!node.is_object({{"mesh", "material"}, {"element", "area", "thickness"}})) return;
  Body body;
  body.name = name;
  if (const auto element = node.find("element")) {
    body.element = element->choice({"Q4", "Q4_mean_dilatation", "Q8", "T3", "T6", "bar", "point"}).value_or("");
  }
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
