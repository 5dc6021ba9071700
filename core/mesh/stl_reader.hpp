/// Triangulated surfaces from STL files, ASCII and binary.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

namespace stickslip {

/// A surface of an STL file. Triangles of a file repeat the places of their corners; here equal places are one vertex.
struct StlSurface {
  Eigen::Matrix3Xd vertices;  ///< length, as in the file
  std::vector<std::array<int, 3>>
      facets;                       ///< counter-clockwise seen from outside; those with two equal corners left out
  std::vector<std::string> errors;  ///< "FILE:LINE:COL: what is wrong", of a binary file "FILE: ..."
};

/// Reads the content of a file with one or more solids. The order of a triangle's corners says which side is outside;
/// normals in the file are not read. Never throws on a bad file: errors say what is wrong with it, a word that is no
/// number, a number that is not finite, a truncated file, a triangle without area, no triangle at all.
StlSurface read_stl(const std::string& content, const std::string& file_name);

}  // namespace stickslip
