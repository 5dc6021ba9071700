/// Meshes that are described, made and looked at.
#pragma once

#include <optional>
#include <string>

#include "core/mesh/generators.hpp"
#include "studies/input/scene_reading.hpp"

namespace stickslip {

/// Whose mesh it is: the nodes of a body have displacements, those of an obstacle have places alone.
enum class MeshOf { body, obstacle };

/// The mesh of a description; none, reported, where the description is at fault, where there is no memory for it beside
/// those before it, or where an element is inverted or thin.
///
///   owner    the object that holds the mesh, and the element where one is asked for
///   node     the mesh
///   element  as in core/mesh/generators.hpp
std::optional<Mesh> made_mesh(const JsonNode& owner, const JsonNode& node, const MeshDescription& description,
                              const std::string& element, MeshOf whose, SceneReading& reading);

}  // namespace stickslip
