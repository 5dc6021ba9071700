/// The content of a Gmsh mesh file, formats MSH 2.2 and 4.1 ASCII [Gmsh reference manual, "MSH file format"], checked
/// for form only: what the elements mean for bodies and sides is msh_reader's.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Tag of a physical group: dimension (0 points, 1 curves, 2 surfaces, 3 volumes) and number.
using MshGroup = std::pair<int, long long>;

struct MshNode {
  long long tag = 0;
  std::array<double, 3> place{};
};

/// An element of one physical group; an element of several groups is listed once for each.
struct MshElement {
  long long tag = 0;
  ElementShape shape = ElementShape::point;  ///< of a line: bar2, whether or not it has a middle
  int node_count = 0;           ///< of the file: a face of nine nodes counts as one of eight, with one more
  std::array<int, 27> nodes{};  ///< positions in MshFile::nodes, `node_count` of them, in the order of ElementShape
  MshGroup group;               ///< number 0: in no group
  std::size_t offset = 0;       ///< of its first character in the text
};

struct MshFile {
  std::map<MshGroup, std::string> names;
  std::vector<MshNode> nodes;
  std::vector<MshElement> elements;
  std::string error;  ///< "LINE:COL: what is wrong" of the first fault of form; empty: none, and the rest is valid
};

/// "LINE:COL" of an offset in a text, both counted from 1.
std::string msh_location(const std::string& text, std::size_t offset);

/// The content of a file's text. Never throws on bad text, however broken.
MshFile parse_msh(const std::string& text, const std::string& file_name);

}  // namespace stickslip
