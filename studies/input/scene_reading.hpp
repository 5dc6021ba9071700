/// What the parts of the scene reader share while a scene grows.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/sides.hpp"
#include "core/model/scene.hpp"
#include "studies/input/scene_reader.hpp"
#include "studies/io/json_node.hpp"

namespace stickslip {

/// A side of a body that exists.
struct NamedSide {
  std::string body;
  const Mesh* mesh;
  Side side;
};

struct SceneReading {
  SceneReading(Diagnostics& diagnostics, std::filesystem::path folder, MeshFiles& mesh_files)
      : diagnostics(diagnostics), folder(std::move(folder)), mesh_files(mesh_files) {}

  Diagnostics& diagnostics;
  std::filesystem::path folder;  ///< of the scene file
  MeshFiles& mesh_files;
  std::map<std::string, std::string> mesh_fingerprints;  ///< by file name as given

  Scene scene;
  std::map<std::string, int> slots;              ///< by JSON pointer
  std::map<std::string, std::string> constants;  ///< pointers of numbers that cannot be a parameter, and why
  std::map<int, int> equal;                      ///< slots of two numbers that must change together
  std::vector<std::string> body_names, obstacle_names, contact_names;  ///< valid or not: all that the file has
  double nodes = 0;                                  ///< of all bodies so far, as estimated before they are made
  double rigid_nodes = 0;                            ///< of meshes of obstacles, likewise
  std::map<std::string, Mesh> meshes;                ///< by body; none where the body's mesh is at fault
  std::map<std::string, MeshDescription> described;  ///< of each of these what it is made from

  bool in_plane_mesh = false;  ///< a mesh of the plane is being read, which is drawn out into space
  int dimension() const { return in_plane_mesh ? 2 : scene.dimension(); }
  /// Axes of the space: x, y (, z).
  std::vector<std::string> axes() const;

  /// A physical or geometric number, with its slot. NaN where it is at fault, so that no comparison with it holds.
  Number number(const JsonNode&, const Rule&);
  /// Member of an object; NaN where it is missing (which Keys report).
  Number required(const JsonNode& object, const std::string& key, const Rule&);
  /// Member of an object, or its default, which has a slot of its own as well.
  Number optional(const JsonNode& object, const std::string& key, double standard, const Rule&);
  /// As many numbers as given; NaN where it is at fault.
  std::vector<Number> vector(const JsonNode&, int size);
  std::vector<Number> required_vector(const JsonNode& object, const std::string& key, int size);
  /// A value in time: a number, [[t, value], ...] with increasing t, or {"table": [...], "repeat": n}. One point at
  /// least.
  Table table(const JsonNode&);
  /// Members by axis of {"x": table, ...}.
  std::map<char, Table> move(const JsonNode&);
  /// A direction: as many numbers as axes, not all zero (`what` completes "must be ...").
  std::vector<Number> direction(const JsonNode&, const char* what);
  /// {"center", "angle"} and in space "axis".
  Rotation rotation(const JsonNode&);

  /// Slot of a number 0 that the file does not write: a shape parameter's distance.
  int extra_slot(const std::string& pointer) { return slot(pointer, 0); }

  // Numbers that cannot be parameters.
  std::optional<double> time(const JsonNode&, const Rule&);
  std::optional<int> count(const JsonNode&, int least);
  std::optional<double> setting(const JsonNode&, const Rule&);

  /// Where a file is that the scene names.
  std::string path_of(const std::string& name) const { return (folder / name).lexically_normal().string(); }
  /// The content of such a file; none, reported, where it cannot be read or has more than `most` bytes. `what`: "mesh".
  std::optional<std::string> content_of(const JsonNode&, const std::string& name, const std::string& what,
                                        std::uintmax_t most);

  /// "; did you mean "BODY.NAME"?" of the bodies that have a side of this name; "" where none has.
  std::string sides_called(const std::string& name) const;
  /// A side expression of a deformable body; faults are reported, except those that follow from a body at fault.
  std::optional<NamedSide> side(const JsonNode&);

 private:
  /// Reads [[t, value], ...] into a table.
  void points(const JsonNode&, Table&);
  int slot(const std::string& pointer, double value);
};

/// Reports a name that side expressions could not tell from something else.
void check_name(const JsonNode&, const std::string& name);
/// Reports a name with characters that no terminal and no XML file can hold.
void check_characters(const JsonNode&, const std::string& name);

// One part of the scene each; "bodies" come first, the method before "parameters".
void read_bodies(const JsonNode&, SceneReading&);
void read_obstacles(const JsonNode&, SceneReading&);
void read_contacts(const JsonNode&, SceneReading&);
void read_supports(const JsonNode&, SceneReading&);
void read_loads(const JsonNode&, SceneReading&);
void read_time(const JsonNode&, SceneReading&);
void read_responses(const JsonNode&, SceneReading&);
void read_objectives(const JsonNode&, SceneReading&);

/// Parameters. `root`: the whole scene. A pointer to an option of a method other than `method`: a fault, or where
/// `drop_others` a note; the pointers dropped are returned, as pointers of the file.
std::vector<std::string> read_parameters(const JsonNode&, const nlohmann::json& root, const std::string& method,
                                         bool drop_others, SceneReading&);

}  // namespace stickslip
