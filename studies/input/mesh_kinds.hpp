/// Meshes as files name them: schema and readers, made from what each generator says of its keys
/// (core/algebra/described.hpp); and meshes of files. A generator more needs nothing here.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// The "mesh" of a body; none where it is at fault. Faults are reported.
std::optional<MeshDescription> read_mesh(const JsonNode&, SceneReading&);

/// The surface of space, or curve of the plane, of this name that is on no body of a file of gmsh: its nodes and the
/// side. `mesh`: {"gmsh": FILE} without a body. None, reported at `side`, where the file has no such.
std::optional<ImportedMesh> read_loose_side(const JsonNode& mesh, const JsonNode& side, SceneReading&);

/// JSON Schema of the "mesh" of a body; of one that is drawn out into space.
nlohmann::ordered_json mesh_schema();
nlohmann::ordered_json plane_mesh_schema();

}  // namespace stickslip
