/// Bodies and sides from a mesh file of Gmsh (MSH 2.2 and 4.1, ASCII). In the plane a physical surface is a body, and
/// the physical curves and points on it are its sides; in space a physical volume is a body, and the physical surfaces,
/// curves and points on it are its sides. Surfaces of space, and curves of the plane, that are on no body are loose: a
/// rigid obstacle may have their shape. Groups without a name go by their number.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "core/mesh/imported.hpp"

namespace stickslip {

struct ImportResult {
  /// One per physical surface (in space volume), by its number. Each has nodes of its own, in the order of the file,
  /// without those that none of its elements has. In the plane: triangles or quadrangles, linear or quadratic,
  /// counter-clockwise; the nodes and facets of a side run along it with the solid on the left (piece after piece where
  /// it has several). In space: tetrahedra of 4 or hexahedra of 8 nodes, right-handed; the facets of a surface are
  /// counter-clockwise seen from outside; a curve or a point is nodes alone. A side inside a body is directed as the
  /// file directs it.
  std::vector<ImportedMesh> bodies;
  /// One per physical surface (in the plane curve) on no body: its nodes and no element; the side that has its name,
  /// directed as in the file.
  std::vector<ImportedMesh> loose = {};
  std::string no_body = {};         ///< why there is no body, as an error; "" if there is one
  std::vector<std::string> errors;  ///< "FILE:LINE:COL: what is wrong"; if there is one, `bodies` may lack some
  std::vector<std::string> notes;   ///< what the file holds and no body uses, and nodes at one place
};

/// Reads a stream to its end, for a space of two or three dimensions. Never throws on a bad file, however broken;
/// errors say what is wrong with it: an unknown version, binary, truncated, wrong counts, other elements than these,
/// elements of a body that are mixed, degenerate, turned against each other, listed twice or overlap, faces, lines or
/// points of a group that are listed twice, two groups of one name, not plane, a mesh of the other space.
ImportResult read_msh(std::istream&, const std::string& file_name, int dimension = 2);

/// What is wrong with asking for this body: "" if it is there, else which there are and which is nearest.
std::string body_error(const ImportResult&, const std::string& body);

}  // namespace stickslip
