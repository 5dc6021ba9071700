/// Scene files (JSON) to Scene, Method and what else a run needs.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/algebra/linear_solver.hpp"
#include "core/mesh/msh_reader.hpp"
#include "core/model/scene.hpp"
#include "methods/options.hpp"
#include "studies/io/json_document.hpp"

namespace stickslip {

/// Bytes for the states of a run that an adjoint follows: half a gigabyte, a thousand states of some 60 000
/// displacements. A number and no share of the machine's memory, so that every machine counts the same.
inline constexpr double megabyte = 1024 * 1024, default_state_memory = 512 * megabyte;

/// A mesh file as read, with the fingerprint of its text.
struct MeshFile {
  ImportResult content;
  std::string fingerprint;
};
/// By path, and the dimension of the space that it is read for. The scenes of a study share one, so that a mesh file is
/// read once.
using MeshFiles = std::map<std::pair<std::string, int>, MeshFile>;

/// A valid scene file with all that it asks for.
struct Input {
  Scene scene;
  Method method;
  LinearAlgebra linear_algebra;
  Backend backend = Backend::automatic;
  int fields_every = 0;                        ///< fields are of each n-th increment and the last; 0: of the last alone
  double state_memory = default_state_memory;  ///< RunOptions::state_memory of an adjoint
  /// The scene as it is simulated: overrides carried out, the method that runs, parameters without those dropped.
  nlohmann::json document;
  std::string file;
  std::map<std::string, std::string> mesh_fingerprints;  ///< by file name as the scene gives it
};

/// "POINTER=VALUE" each, as after --set.
using Overrides = std::vector<std::string>;

/// Reads a document that the caller may have changed (JsonDocument::set). Mesh files are looked for beside the
/// document's file. `method_name` replaces the scene's method (and need not differ from it): the options of another
/// method, and parameters that point to them, are then dropped, the latter with a note. None where there is a fault;
/// all faults are in the diagnostics.
std::optional<Input> read_scene(const JsonDocument&, const std::optional<std::string>& method_name, Diagnostics&,
                                MeshFiles&);

/// Reads a document with overrides, which are carried out after the method was replaced: they may be about its options.
std::optional<Input> read_scene(JsonDocument, const Overrides&, const std::optional<std::string>& method_name,
                                Diagnostics&);

/// Reads a file.
std::optional<Input> read_scene(const std::string& file, const Overrides&,
                                const std::optional<std::string>& method_name, Diagnostics&);

/// Text that is equal for two inputs only where they simulate the same: the document without its title, every option
/// of the method, the content of mesh files. fingerprint() of it is the scene's hash.
std::string canonical_text(const Input&);

}  // namespace stickslip
