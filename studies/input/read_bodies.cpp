#include <algorithm>

#include "core/mesh/generators.hpp"
#include "core/model/model.hpp"
#include "studies/input/file_objects.hpp"
#include "studies/input/made_mesh.hpp"
#include "studies/input/materials.hpp"
#include "studies/input/mesh_kinds.hpp"

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
    if (auto made = made_mesh(node, *mesh_node, *mesh, body.element, MeshOf::body, reading)) {
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
