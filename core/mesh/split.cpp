#include "core/mesh/split.hpp"

#include <map>
#include <utility>

namespace stickslip {
namespace {

/// Nodes and their weights: the place of a new node. Weights are values of the shape functions (core/mesh/shapes.hpp)
/// at the natural coordinates of the new node.
using Weights = std::vector<std::pair<int, double>>;

class Splitting {
 public:
  explicit Splitting(const ImportedMesh& coarse) : coarse_(coarse), fine_(coarse) {
    fine_.mesh.connectivity.clear();
    fine_.mesh.sides.clear();
  }

  ImportedMesh run() {
    for (int e = 0; e < coarse_.mesh.element_count(); ++e) split_element(e);
    for (const auto& [name, side] : coarse_.mesh.sides) fine_.mesh.sides[name] = split_side(side);
    place_new_nodes();
    return std::move(fine_);
  }

 private:
  int add(Weights weights) {
    new_nodes_.push_back(std::move(weights));
    return fine_.mesh.node_count++;
  }

  /// The middle of an edge between corners: the node that a quadratic element has there, else a new one.
  int middle(int a, int b) {
    const auto [found, is_new] = middles_.emplace(std::minmax(a, b), -1);
    if (is_new) found->second = add({{a, 0.5}, {b, 0.5}});
    return found->second;
  }

  /// The node at a quarter of a quadratic edge, between its end `near` and its middle `halfway`.
  int quarter(int near, int far, int halfway) {
    const auto [found, is_new] = quarters_.emplace(std::pair{near, halfway}, -1);
    if (is_new) found->second = add({{near, 0.375}, {far, -0.125}, {halfway, 0.75}});  // N_i at t = 1/4
    return found->second;
  }

  void split_element(int e) {
    const int corners = corners_of(coarse_.mesh.shape);
    const int* node = coarse_.mesh.connectivity.data() + e * nodes_of(coarse_.mesh.shape);
    std::vector<int> corner(node, node + corners), middles;
    for (int k = 0; k < corners; ++k) {
      const int a = corner[k], b = corner[(k + 1) % corners];
      if (is_quadratic(coarse_.mesh.shape)) middles_.emplace(std::minmax(a, b), node[corners + k]);
      middles.push_back(middle(a, b));
    }
    if (corners == 3)
      split_triangle(corner, middles);
    else
      split_quadrangle(corner, middles);
  }

  /// Appends an element. `middles`: of its sides; none of linear elements.
  void append(const std::vector<int>& corners, const std::vector<int>& middles) {
    auto& all = fine_.mesh.connectivity;
    all.insert(all.end(), corners.begin(), corners.end());
    all.insert(all.end(), middles.begin(), middles.end());
  }

  /// One triangle at each corner, and one between them.
  void split_triangle(const std::vector<int>& c, const std::vector<int>& m) {
    const bool quadratic = is_quadratic(coarse_.mesh.shape);
    std::vector<int> inner;  // between the middles m[k] and m[k + 1]
    for (int k = 0; quadratic && k < 3; ++k) {
      const int next = (k + 1) % 3, last = (k + 2) % 3;  // L = 1/4, 1/2, 1/4 at the corners k, next, last
      inner.push_back(add({{c[k], -0.125}, {c[last], -0.125}, {m[k], 0.5}, {m[next], 0.5}, {m[last], 0.25}}));
    }
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      std::vector<int> sides;
      if (quadratic) sides = {quarter(c[k], c[next], m[k]), inner[last], quarter(c[k], c[last], m[last])};
      append({c[k], m[k], m[last]}, sides);
    }
    append(m, inner);
  }

  /// One quadrangle at each corner.
  void split_quadrangle(const std::vector<int>& c, const std::vector<int>& m) {
    const bool quadratic = is_quadratic(coarse_.mesh.shape);
    Weights centre;
    for (int k = 0; k < 4; ++k) {
      centre.emplace_back(c[k], quadratic ? -0.25 : 0.25);
      if (quadratic) centre.emplace_back(m[k], 0.5);
    }
    const int inside = add(std::move(centre));
    // Between the middle m[k] and the centre, at (0, -1/2) in the element turned so that its side k is below.
    std::vector<int> inner;
    for (int k = 0; quadratic && k < 4; ++k) {
      Weights weights = {{m[k], 0.75}, {m[(k + 1) % 4], 0.375}, {m[(k + 2) % 4], 0.25}, {m[(k + 3) % 4], 0.375}};
      for (const int corner : c) weights.emplace_back(corner, -0.1875);
      inner.push_back(add(std::move(weights)));
    }
    for (int k = 0; k < 4; ++k) {
      const int last = (k + 3) % 4;
      std::vector<int> sides;
      if (quadratic)
        sides = {quarter(c[k], c[(k + 1) % 4], m[k]), inner[k], inner[last], quarter(c[k], c[last], m[last])};
      append({c[k], m[k], inside, m[last]}, sides);
    }
  }

  /// The side with each of its edges cut in two. A side of nodes alone stays.
  Side split_side(const Side& coarse) {
    if (coarse.facets.empty()) return coarse;
    Side side;
    std::vector<char> listed(fine_.mesh.node_count + 2 * coarse.facets.size(), 0);
    const auto append = [&](int a, int b) {
      side.facets.push_back({a, b});
      for (const int node : {a, b})
        if (!std::exchange(listed[node], 1)) side.nodes.push_back(node);
    };
    for (const auto& edge : coarse.edges()) {
      const int a = edge[0], b = edge[1], between = middle(a, b);
      if (coarse.quadratic.empty()) {
        append(a, between);
        append(between, b);
        continue;
      }
      for (const auto& [first, second] : {std::pair{a, between}, std::pair{between, b}}) {
        const int half = first == a ? quarter(a, b, between) : quarter(b, a, between);
        append(first, half);
        append(half, second);
        side.quadratic.push_back({first, second, half});
      }
    }
    return side;
  }

  void place_new_nodes() {
    const Eigen::Index old = coarse_.points.cols();
    fine_.points.conservativeResize(2, fine_.mesh.node_count);
    for (std::size_t k = 0; k < new_nodes_.size(); ++k) {
      const auto& weights = new_nodes_[k];
      const Vec<double, 2> origin = coarse_.points.col(weights.front().first);  // (far from 0 no digits are lost)
      Vec<double, 2> place = origin;
      for (const auto& [node, weight] : weights) place += weight * (coarse_.points.col(node) - origin);
      fine_.points.col(old + static_cast<Eigen::Index>(k)) = place;
    }
  }

  const ImportedMesh& coarse_;
  ImportedMesh fine_;
  std::vector<Weights> new_nodes_;
  std::map<std::pair<int, int>, int> middles_, quarters_;
};

}  // namespace

ImportedMesh split(const ImportedMesh& coarse) {
  return is_solid(coarse.mesh.shape) ? split_in_space(coarse) : Splitting(coarse).run();
}

}  // namespace stickslip
