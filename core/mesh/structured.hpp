/// What the structured generators share: geometric grading, and a cell that is one quadrilateral or two triangles.
#pragma once

#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// Fractions 0 = f_0 < ... < f_cells = 1 whose steps grow by one constant factor; ratio is last step / first step.
/// Written as a sum of powers, so that ratio = 1 is no special case and can be differentiated at.
/// pre: value(ratio) > 0, cells >= 1.
template <class T>
std::vector<T> graded_fractions(const T& ratio, int cells) {
  using std::pow;
  std::vector<T> fractions{T(0.0)};
  T total(0.0);
  for (int i = 0; i < cells; ++i) {
    total += i == 0 ? T(1.0) : T(pow(ratio, static_cast<double>(i) / (cells - 1)));
    fractions.push_back(total);
  }
  for (T& f : fractions) f /= total;
  fractions.back() = T(1.0);  // the end of a side lies where the scene says, without rounding
  return fractions;
}

/// Shape an element name stands for in a structured 2D mesh: "T3", or "Q4", also meant by "".
inline ElementShape structured_shape(const std::string& element) {
  return element == "T3" ? ElementShape::tri3 : ElementShape::quad4;
}

/// Diagonal that splits a cell into triangles: from its first node to its third, or from its second to its fourth.
enum class Diagonal { first, second };

/// Appends a cell, corners counter-clockwise, as the mesh's shape asks. Which diagonal splits it is a matter of
/// topology alone, so a triangle mesh does not change when a dimension does.
inline void append_cell(Mesh& mesh, const std::array<int, 4>& n, Diagonal diagonal) {
  auto append = [&](std::initializer_list<int> nodes) {
    mesh.connectivity.insert(mesh.connectivity.end(), nodes.begin(), nodes.end());
  };
  if (mesh.shape == ElementShape::quad4) {
    append({n[0], n[1], n[2], n[3]});
  } else if (diagonal == Diagonal::first) {
    append({n[0], n[1], n[2]});
    append({n[0], n[2], n[3]});
  } else {
    append({n[0], n[1], n[3]});
    append({n[1], n[2], n[3]});
  }
}

/// Side made of the segments between consecutive nodes.
inline Side side_along(std::vector<int> nodes) {
  Side side{std::move(nodes), {}};
  for (std::size_t i = 1; i < side.nodes.size(); ++i) side.facets.push_back({side.nodes[i - 1], side.nodes[i]});
  return side;
}

}  // namespace stickslip
