#include "studies/input/mesh_kinds.hpp"

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <type_traits>
#include <utility>

#include "core/mesh/split.hpp"
#include "studies/input/described.hpp"
#include "studies/input/file_objects.hpp"

namespace stickslip {
namespace {

using Schema = nlohmann::ordered_json;

// What numbers of one mesh must be beside each other.

void compare(const JsonNode& node, const BoxMesh& box) {
  for (std::size_t axis = 0; axis < box.max.size(); ++axis)
    if (box.max[axis].value <= box.min[axis].value)
      node.find("max")->elements()[axis].must_be("greater than min, which is " + shown(box.min[axis].value));
}

void compare(const JsonNode& node, const ExtrudedMesh& extruded) {
  if (extruded.to.value <= extruded.from.value)
    node.find("to")->must_be("greater than from, which is " + shown(extruded.from.value));
}

void compare(const JsonNode& node, const RingMesh& ring) {
  if (ring.outer.value <= ring.inner.value)
    node.find("outer")->must_be("greater than inner, which is " + shown(ring.inner.value));
}

/// A generator without its type.
struct MeshKind {
  const char* key;
  bool is_in_space;  ///< there are meshes of the kind in the space solid
  Schema (*schema)();
  std::optional<MeshDescription> (*read)(const JsonNode& node, SceneReading& reading);
};

template <class AnyMesh, Described M>
std::optional<AnyMesh> read_generator(const JsonNode& node, SceneReading& reading) {
  auto mesh = read_described<M>(node, reading);
  if (!mesh) return std::nullopt;
  if constexpr (requires { compare(node, *mesh); }) compare(node, *mesh);
  return *std::move(mesh);
}

/// All, in the order of MeshDescription, but for the mesh of a file.
const std::vector<MeshKind>& mesh_kinds() {
  static const auto all = [] {
    std::vector<MeshKind> kinds;
    for_each_alternative<MeshDescription>([&]<class M>(std::type_identity<M>) {
      if constexpr (!std::is_same_v<M, ImportedMesh>) {
        constexpr bool is_in_space = M::filling != Filling::continuum || requires { M::fills_space; };
        kinds.push_back({M::key, is_in_space, schema_of_object<M>, read_generator<MeshDescription, M>});
      }
    });
    return kinds;
  }();
  return all;
}

/// The mesh file's content, read at most once; none where it cannot be read.
const MeshFile* mesh_file(const JsonNode& node, const std::string& name, SceneReading& reading) {
  const std::string path = reading.path_of(name);
  const std::pair of_space{path, reading.dimension()};
  auto found = reading.mesh_files.find(of_space);
  if (found == reading.mesh_files.end()) {
    constexpr std::uintmax_t most = std::uintmax_t{1} << 30;  // some 10 million nodes
    const auto text = reading.content_of(node, name, "mesh", most);
    if (!text) return nullptr;
    std::istringstream content(*text);
    const MeshFile file{read_msh(content, path, reading.dimension()), fingerprint(*text)};
    found = reading.mesh_files.emplace(of_space, file).first;
  }
  reading.mesh_fingerprints[name] = found->second.fingerprint;
  for (const std::string& error : found->second.content.errors) reading.diagnostics.error({{}, "", error});
  return &found->second;
}

/// The mesh, split as often as `node` says: into a million elements at most, as they are made before any memory is
/// estimated.
std::optional<MeshDescription> split_often(ImportedMesh mesh, const JsonNode& node) {
  const double parts = mesh.mesh.dimension == 2 ? 4 : 8;
  int most = 0;
  for (double elements = parts * mesh.mesh.element_count(); elements <= 1e6; elements *= parts) ++most;
  const auto times = node.count(0, most);
  if (!times) return std::nullopt;
  for (int k = 0; k < *times; ++k) mesh = split(mesh);
  return mesh;
}

std::optional<MeshDescription> read_gmsh(const JsonNode& mesh, const JsonNode& node, SceneReading& reading) {
  const auto name = node.text();
  const auto body = mesh.find("body");
  if (!body)
    mesh.error(R"(the key "body" is missing: the physical name of a surface, in space of a volume, in the mesh file)");
  const auto body_name = body ? body->text() : std::nullopt;
  const MeshFile* file = name ? mesh_file(node, *name, reading) : nullptr;
  if (file && !file->content.no_body.empty()) reading.diagnostics.error({{}, "", file->content.no_body});
  if (!file || !body_name || !file->content.no_body.empty()) return std::nullopt;
  const auto splits = mesh.find("split");
  for (const ImportedMesh& each : file->content.bodies)
    if (each.body == *body_name) return splits ? split_often(each, *splits) : each;
  // a file that is at fault may lack the body for that reason
  if (file->content.errors.empty()) body->error(body_error(file->content, *body_name));
  return std::nullopt;
}

}  // namespace

namespace detail {

void read_key(const KeyAt& at, PlaneMesh& to, const MeshInPlane&) {
  const auto given = at.find();
  if (!given) return;
  SceneReading& reading = at.reading;
  const auto named =
      given->kind(list_of<PlaneMesh>([]<class M>(std::type_identity<M>) { return std::string(M::key); }));
  if (!named) return;
  reading.in_plane_mesh = true;
  for_each_alternative<PlaneMesh>([&]<class M>(std::type_identity<M>) {
    if (named->first != M::key) return;
    if (auto mesh = read_generator<PlaneMesh, M>(named->second, reading)) to = *std::move(mesh);
  });
  reading.in_plane_mesh = false;
}

}  // namespace detail

std::optional<MeshDescription> read_mesh(const JsonNode& node, SceneReading& reading) {
  std::vector<std::string> keys;
  keys.reserve(mesh_kinds().size() + 1);
  for (const auto& kind : mesh_kinds()) keys.emplace_back(kind.key);
  keys.emplace_back("gmsh");
  const auto beside_gmsh = keys_of(scene_object("mesh"), {"gmsh"}).optional;
  const auto named = node.kind(keys, {"sphere"}, beside_gmsh);
  if (!named) return std::nullopt;
  const auto& [name, mesh] = *named;
  if (name != "gmsh")
    for (const std::string& key : beside_gmsh)
      if (const auto found = node.find(key)) found->error_at_key("belongs to gmsh, not to " + name);
  const auto generator = std::find_if(mesh_kinds().begin(), mesh_kinds().end(),
                                      [&name = name](const MeshKind& kind) { return name == kind.key; });
  const bool from_file = generator == mesh_kinds().end();
  if (reading.dimension() == 3 && !from_file && !generator->is_in_space) {
    std::vector<std::string> allowed;
    for (const auto& kind : mesh_kinds())
      if (kind.is_in_space) allowed.emplace_back(kind.key);
    allowed.emplace_back("gmsh");
    mesh.error_at_key(in_quotes(name) +
                      " in the space solid is not available in this version; allowed: " + listed(allowed));
    return std::nullopt;
  }
  return from_file ? read_gmsh(node, mesh, reading) : generator->read(mesh, reading);
}

std::optional<ImportedMesh> read_loose_side(const JsonNode& mesh, const JsonNode& side, SceneReading& reading) {
  const auto node = mesh.find("gmsh");
  const auto name = node->text(), of_side = side.text();
  const MeshFile* file = name ? mesh_file(*node, *name, reading) : nullptr;
  if (const auto splits = mesh.find("split")) splits->error_at_key("belongs to a body of the file");
  if (!file || !of_side || !file->content.errors.empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const ImportedMesh& each : file->content.loose) {
    names.push_back(each.mesh.sides.begin()->first);
    if (names.back() == *of_side) return each;
  }
  const std::string kind = reading.dimension() == 3 ? "physical surface" : "physical curve";
  side.error("is " + in_quotes(*of_side) + "; the mesh has no " + kind + " of this name that is on no body" +
             (names.empty() ? "" : "; those that are: " + listed(names)) +
             "; for a side of a body the mesh needs the key \"body\"");
  return std::nullopt;
}

Schema plane_mesh_schema() {
  Schema properties = Schema::object();
  for_each_alternative<PlaneMesh>([&]<class M>(std::type_identity<M>) { properties[M::key] = schema_of_object<M>(); });
  return one_of(properties);
}

Schema mesh_schema() { return with_kinds(scene_object("mesh"), mesh_kinds()); }

}  // namespace stickslip
