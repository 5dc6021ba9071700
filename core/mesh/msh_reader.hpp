/// Bodies and sides from a mesh file of Gmsh (MSH 2.2 and 4.1, ASCII): a physical surface is a body, the physical
/// curves and points on it are its sides. Groups without a name go by their number.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "core/mesh/imported.hpp"

namespace stickslip {

struct ImportResult {
  /// One per physical surface, by its number. Each has nodes of its own, in the order of the file, without those that
  /// none of its elements has; triangles or quadrangles, linear or quadratic, counter-clockwise. The nodes and facets
  /// of a side run along it with the solid on the left (piece after piece where it has several; a curve inside a body
  /// as the file directs it).
  std::vector<ImportedMesh> bodies;
  std::vector<std::string> errors;  ///< "FILE:LINE:COL: what is wrong"; if there is one, `bodies` may lack some
  std::vector<std::string> notes;   ///< what the file holds and no body uses, and nodes at one place
};

/// Reads a stream to its end. Never throws on a bad file, however broken; errors say what is wrong with it:
/// an unknown version, binary, truncated, wrong counts, other elements than these, elements of a
/// body that are mixed, degenerate, turned against each other, listed twice or overlap, lines or points of a group that
/// are listed twice, no physical surface, two groups of one name, not plane.
ImportResult read_msh(std::istream&, const std::string& file_name);

/// What is wrong with asking for this body: "" if it is there, else which there are and which is nearest.
std::string body_error(const ImportResult&, const std::string& body);

}  // namespace stickslip
