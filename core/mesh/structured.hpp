/// What the structured generators share: geometric grading, a cell that is one quadrilateral or two triangles, and
/// grids of cells.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/algebra/number.hpp"
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

/// Number of cells along two or three directions. (A double: an int may not hold what a file asks for.)
template <class Cells>
double product(const Cells& cells) {
  double all = 1;
  for (const int along : cells) all *= along;
  return all;
}

/// Shape of the corners of an element in a generated mesh. In the plane: a triangle for "T3" and "T6", else a
/// quadrilateral; "" means "Q4". In space: a tetrahedron for "T4" and "T10", else a hexahedron; "" means "H8". Middles
/// come later (core/mesh/middles.hpp).
inline ElementShape structured_shape(const std::string& element, int dimension = 2) {
  if (dimension == 3) return element == "T4" || element == "T10" ? ElementShape::tet4 : ElementShape::hex8;
  return element == "T3" || element == "T6" ? ElementShape::tri3 : ElementShape::quad4;
}

/// Shape of an element with middles; nothing of one without.
inline std::optional<ElementShape> quadratic_shape(const std::string& element) {
  if (element == "T6") return ElementShape::tri6;
  if (element == "Q8") return ElementShape::quad8;
  if (element == "T10") return ElementShape::tet10;
  if (element == "H20") return ElementShape::hex20;
  if (element == "H27") return ElementShape::hex27;
  return std::nullopt;
}

/// Whether the element's dilatation is its mean.
inline bool has_mean_dilatation(const std::string& element) {
  return element == "Q4_mean_dilatation" || element == "H8_mean_dilatation";
}

/// What is wrong with an element of a generated mesh, or "". `what`: "a box".
inline std::string element_fault(const std::string& what, const std::string& element, int dimension = 2) {
  if (dimension == 3) {
    for (const char* name : {"", "H8", "H8_mean_dilatation", "H20", "H27", "T4", "T10"})
      if (element == name) return "";
    return what + " in space has elements H8, H8_mean_dilatation, H20, H27, T4 or T10, not " + element;
  }
  for (const char* name : {"", "Q4", "Q4_mean_dilatation", "Q8", "T3", "T6"})
    if (element == name) return "";
  return what + " has elements Q4, Q4_mean_dilatation, Q8, T3 or T6, not " + element;
}

/// Ratio of the largest to the smallest of the cells along one direction, and the side that the smallest is at.
struct Grading {
  std::string towards;
  Number ratio;
};

/// What is wrong with the grading of cells, or "". `directions`: of each direction the sides at its two ends.
std::string grade_fault(const std::vector<Grading>& grade, const std::vector<std::array<const char*, 2>>& directions);

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
  Side side{std::move(nodes), {}, {}};
  for (std::size_t i = 1; i < side.nodes.size(); ++i) side.facets.push_back({side.nodes[i - 1], side.nodes[i]});
  return side;
}

/// The same, and the segment from the last node to the first.
inline Side closed_side(std::vector<int> nodes) {
  Side side = side_along(std::move(nodes));
  side.facets.push_back({side.nodes.back(), side.nodes.front()});
  return side;
}

/// The sides of a grid that cells may be graded towards.
inline constexpr std::array grid_sides{"left", "right", "bottom", "top"};

/// A rectangle of cells[0] x cells[1] cells (box, quad, ring). Node (i, j) has number j (cells[0] + 1) + i. Sides
/// `bottom right top left`, each from its start to its end counter-clockwise.
Mesh grid(const std::array<int, 2>& cells, const std::string& element);

/// A block of cells in space. Node (i, j, k) has number (k (cells[1] + 1) + j) (cells[0] + 1) + i. Sides: left right
/// along the first direction, front back along the second, bottom top along the third.
Mesh grid(const std::array<int, 3>& cells, const std::string& element);

/// Whether a cell of a row is turned over, if its neighbours are turned over in turn.
inline bool is_odd(int k) { return k % 2 != 0; }

/// Appends a cell of space, as one hexahedron, or as six tetrahedra around its diagonal from corner 0 to corner 6.
/// `mirrored`: along which directions the cell is turned over before. Neighbours are turned over in turn, so the
/// diagonals of a face that they share agree, and no direction is preferred.
void append_block(Mesh&, const std::array<int, 8>& nodes, const std::array<bool, 3>& mirrored);

/// The nodes of the boundary of a mesh in space that hold, and its faces all of whose nodes do.
template <class Holds>
Side part_of(const Side& boundary, const Holds& holds) {
  Side part;
  for (const int node : boundary.nodes)
    if (holds(node)) part.nodes.push_back(node);
  for (const auto& facet : boundary.facets)
    if (std::all_of(facet.begin(), facet.end(), holds)) part.facets.push_back(facet);
  return part;
}

/// Fractions along one direction; cells grow away from the side `low` or `high` if they are graded towards it.
template <class T>
std::vector<T> grid_fractions(int cells, const std::vector<Grading>& grade, const Numbers<T>& numbers, const char* low,
                              const char* high) {
  const auto found =
      std::find_if(grade.begin(), grade.end(), [&](const Grading& g) { return g.towards == low || g.towards == high; });
  const std::vector<T> f = graded_fractions(found == grade.end() ? T(1.0) : numbers(found->ratio), cells);
  if (found == grade.end() || found->towards != high) return f;
  std::vector<T> mirrored;
  for (auto it = f.rbegin(); it != f.rend(); ++it) mirrored.push_back(T(1.0) - *it);
  return mirrored;
}

}  // namespace stickslip
