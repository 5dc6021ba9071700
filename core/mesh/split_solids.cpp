#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/mesh/shapes.hpp"
#include "core/mesh/split.hpp"

namespace stickslip {
namespace {

/// Splits tetrahedra and hexahedra. New nodes lie in the middle of edges, faces and hexahedra.
class SolidSplitting {
 public:
  explicit SolidSplitting(const ImportedMesh& coarse) : coarse_(coarse), fine_(coarse) {
    fine_.mesh.connectivity.clear();
    fine_.mesh.sides.clear();
    fine_.curves.clear();
  }

  ImportedMesh run() {
    const int count = nodes_of(coarse_.mesh.shape);
    for (int e = 0; e < coarse_.mesh.element_count(); ++e) {
      const int* node = coarse_.mesh.connectivity.data() + static_cast<std::size_t>(e) * count;
      if (count == 4)
        split_tetrahedron({node[0], node[1], node[2], node[3]});
      else
        split_hexahedron(node);
    }
    for (const auto& [name, side] : coarse_.mesh.sides) fine_.mesh.sides[name] = split_side(name, side);
    place_new_nodes();
    return std::move(fine_);
  }

 private:
  /// The node in the middle of an edge, a face or a hexahedron with these corners.
  int between(std::vector<int> corners) {
    std::sort(corners.begin(), corners.end());
    const auto [found, is_new] = middles_.try_emplace(std::move(corners), fine_.mesh.node_count);
    if (is_new) ++fine_.mesh.node_count;
    return found->second;
  }

  void append(const std::vector<int>& nodes) {
    fine_.mesh.connectivity.insert(fine_.mesh.connectivity.end(), nodes.begin(), nodes.end());
  }

  /// One tetrahedron at each corner, and four around the shortest diagonal of the octahedron between them: then
  /// splitting again and again makes tetrahedra of a few shapes alone.
  void split_tetrahedron(std::array<int, 4> c) {
    for (int k = 0; k < 4; ++k) {
      std::vector<int> corner;
      for (int a = 0; a < 4; ++a) corner.push_back(a == k ? c[k] : between({c[a], c[k]}));
      append(corner);
    }
    const auto diagonal = [&](const std::array<int, 4>& d) {  // from the middle of edge 0 1 to that of edge 2 3
      const auto at = [&](int node) -> Vec<double, 3> { return coarse_.points.col(node); };
      return ((at(d[0]) - at(d[2])) + (at(d[1]) - at(d[3]))).norm();
    };
    std::array<int, 4> best = c;
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(c.begin() + 1, c.begin() + 2, c.end());  // right-handed as before
      if (diagonal(c) < diagonal(best)) best = c;
    }
    const auto middle = [&](int a, int b) { return between({best[a], best[b]}); };
    const std::array<int, 4> around{middle(0, 2), middle(0, 3), middle(1, 3), middle(1, 2)};
    for (int k = 0; k < 4; ++k) append({middle(0, 1), middle(2, 3), around[k], around[(k + 1) % 4]});
  }

  /// One hexahedron at each corner.
  void split_hexahedron(const int* node) {
    static constexpr int place[8] = {0, 1, 3, 2, 4, 5, 7, 6};  // of a corner: bits 0, 1, 2 along the three directions
    for (const int at : place) {
      std::vector<int> nodes;
      for (const int step : place) {
        std::vector<int> corners;  // those that agree with both wherever these agree
        for (int a = 0; a < 8; ++a)
          if (((place[a] ^ at) & ~(at ^ step)) == 0) corners.push_back(node[a]);
        nodes.push_back(corners.size() == 1 ? corners[0] : between(corners));
      }
      append(nodes);
    }
  }

  /// The side with each of its faces, or edges of a curve, split. A side of nodes alone stays.
  Side split_side(const std::string& name, const Side& coarse) {
    Side side;
    side.nodes = coarse.nodes;
    const auto curve = coarse_.curves.find(name);
    if (curve != coarse_.curves.end())
      for (const auto& [a, b] : curve->second) {
        const int middle = between({a, b});
        side.nodes.push_back(middle);
        fine_.curves[name].push_back({a, middle});
        fine_.curves[name].push_back({middle, b});
      }
    for (const auto& face : coarse.facets) split_face(face, side);
    std::sort(side.nodes.begin(), side.nodes.end());
    side.nodes.erase(std::unique(side.nodes.begin(), side.nodes.end()), side.nodes.end());
    return side;
  }

  void split_face(const std::vector<int>& face, Side& side) {
    const std::size_t count = face.size();
    std::vector<int> middles;
    for (std::size_t k = 0; k < count; ++k) middles.push_back(between({face[k], face[(k + 1) % count]}));
    side.nodes.insert(side.nodes.end(), middles.begin(), middles.end());
    if (count == 3) side.facets.push_back(middles);
    if (count == 4) side.nodes.push_back(between(face));
    for (std::size_t k = 0; k < count; ++k) {
      side.facets.push_back({face[k], middles[k]});
      if (count == 4) side.facets.back().push_back(side.nodes.back());
      side.facets.back().push_back(middles[(k + count - 1) % count]);
    }
  }

  void place_new_nodes() {
    fine_.points.conservativeResize(3, fine_.mesh.node_count);
    for (const auto& [corners, node] : middles_) {
      const Vec<double, 3> origin = coarse_.points.col(corners.front());  // (far from 0 no digits are lost)
      Vec<double, 3> place = origin;
      for (const int corner : corners)
        place += (coarse_.points.col(corner) - origin) / static_cast<double>(corners.size());
      fine_.points.col(node) = place;
    }
  }

  const ImportedMesh& coarse_;
  ImportedMesh fine_;
  std::map<std::vector<int>, int> middles_;  ///< by corners, ascending
};

/// Splits elements with middles. A node is known by the corners around it and their weights in the element without
/// middles, so neighbours find each other's; its place is that of the element's own shape functions.
template <class Shape>
class CurvedSplitting {
 public:
  explicit CurvedSplitting(const ImportedMesh& coarse) : coarse_(coarse), fine_(coarse) {
    fine_.mesh.connectivity.clear();
    fine_.mesh.sides.clear();
    fine_.curves.clear();
  }

  ImportedMesh run() {
    const int elements = coarse_.mesh.element_count();
    for (int e = 0; e < elements; ++e)
      for (int a = 0; a < Shape::nodes; ++a) known_.emplace(key_of(e, natural_node<Shape>(a)), nodes_of_element(e)[a]);
    for (int e = 0; e < elements; ++e)
      for (const auto& child : children(e)) append(e, child);
    for (const auto& [name, side] : coarse_.mesh.sides) fine_.mesh.sides[name] = split_side(name, side);
    const Eigen::Index old = coarse_.points.cols();
    fine_.points.conservativeResize(3, fine_.mesh.node_count);
    for (std::size_t k = 0; k < places_.size(); ++k) fine_.points.col(old + static_cast<Eigen::Index>(k)) = places_[k];
    return std::move(fine_);
  }

 private:
  using Place = Vec<double, 3>;  ///< natural coordinates
  /// Corners, ascending, and their weights, which are multiples of 1/64.
  using Key = std::map<int, double>;
  using Child = std::array<Place, Shape::corners>;
  using Linear = std::conditional_t<Shape::is_simplex, Tet4, Hex8>;

  const int* nodes_of_element(int e) const {
    return coarse_.mesh.connectivity.data() + static_cast<std::size_t>(e) * Shape::nodes;
  }

  Key key_of(int e, const Place& at) const {
    const auto weights = Linear::at(at[0], at[1], at[2], 0).value;
    Key key;
    for (int a = 0; a < Shape::corners; ++a)
      if (weights[a] != 0) key[nodes_of_element(e)[a]] += weights[a];
    return key;
  }

  /// As many as split_in_space makes of the element without middles.
  std::vector<Child> children(int e) const {
    std::vector<Child> all;
    const auto corner = [](int a) { return natural_node<Shape>(a); };
    if constexpr (!Shape::is_simplex) {
      for (int k = 0; k < 8; ++k) {
        Child& child = all.emplace_back();
        for (int a = 0; a < 8; ++a) child[a] = (corner(a) + corner(k)) / 2;
      }
    } else {
      for (int k = 0; k < 4; ++k) {
        Child& child = all.emplace_back();
        for (int a = 0; a < 4; ++a) child[a] = (corner(a) + corner(k)) / 2;
      }
      std::array<int, 4> c{0, 1, 2, 3};
      const auto diagonal = [&](const std::array<int, 4>& d) {
        const auto at = [&](int a) -> Place { return coarse_.points.col(nodes_of_element(e)[a]); };
        return ((at(d[0]) - at(d[2])) + (at(d[1]) - at(d[3]))).norm();
      };
      std::array<int, 4> best = c;
      for (int turn = 0; turn < 2; ++turn) {
        std::rotate(c.begin() + 1, c.begin() + 2, c.end());
        if (diagonal(c) < diagonal(best)) best = c;
      }
      const auto middle = [&](int a, int b) -> Place { return (corner(best[a]) + corner(best[b])) / 2; };
      const std::array<Place, 4> around{middle(0, 2), middle(0, 3), middle(1, 3), middle(1, 2)};
      for (int k = 0; k < 4; ++k) all.push_back({middle(0, 1), middle(2, 3), around[k], around[(k + 1) % 4]});
    }
    return all;
  }

  void append(int e, const Child& child) {
    for (const auto& around : corners_around(coarse_.mesh.shape)) {
      Place at = Place::Zero();
      for (const int corner : around) at += child[corner] / static_cast<double>(around.size());
      const auto [found, is_new] = known_.try_emplace(key_of(e, at), fine_.mesh.node_count);
      if (is_new) {
        ++fine_.mesh.node_count;
        places_.push_back(place_in(e, at));
      }
      fine_.mesh.connectivity.push_back(found->second);
    }
  }

  Vec<double, 3> place_in(int e, const Place& at) const {
    const int* nodes = nodes_of_element(e);
    const auto weights = Shape::at(at[0], at[1], at[2], 0).value;
    const Vec<double, 3> origin = coarse_.points.col(nodes[0]);  // (far from 0 no digits are lost)
    Vec<double, 3> place = origin;
    for (int a = 1; a < Shape::nodes; ++a) place += weights[a] * (coarse_.points.col(nodes[a]) - origin);
    return place;
  }

  /// The mean of some places, as keys.
  static Key mean_of(const std::vector<Key>& keys) {
    Key mean;
    for (const auto& key : keys)
      for (const auto& [corner, weight] : key) mean[corner] += weight / static_cast<double>(keys.size());
    return mean;
  }

  /// The side with each of its faces, or edges of a curve, split. A side of nodes alone stays.
  Side split_side(const std::string& name, const Side& coarse) {
    Side side;
    std::set<int> nodes(coarse.nodes.begin(), coarse.nodes.end());
    const auto curve = coarse_.curves.find(name);
    if (curve != coarse_.curves.end())
      for (const auto& [a, b] : curve->second) {
        const int middle = known_.at({{a, 0.5}, {b, 0.5}});
        for (const auto& half : {std::array{a, middle}, std::array{middle, b}}) fine_.curves[name].push_back(half);
        nodes.insert({middle, known_.at({{a, 0.75}, {b, 0.25}}), known_.at({{a, 0.25}, {b, 0.75}})});
      }
    for (const auto& face : coarse.quadratic)
      for (const auto& part : split_face(face)) {
        for (auto& facet : facets_of_side(part, 3)) side.facets.push_back(std::move(facet));
        nodes.insert(part.begin(), part.end());
        side.quadratic.push_back(part);
      }
    side.nodes.assign(nodes.begin(), nodes.end());
    return side;
  }

  /// Four faces of a face with as many nodes each.
  std::vector<std::vector<int>> split_face(const std::vector<int>& face) const {
    const int count = corners_of_face(face.size());
    const auto corner = [&](int k) { return Key{{face[k % count], 1.0}}; };
    const auto middle = [&](int k) { return mean_of({corner(k), corner(k + 1)}); };
    std::vector<std::vector<Key>> parts;
    for (int k = 0; k < count; ++k) {
      parts.push_back({corner(k), middle(k), middle(k + count - 1)});
      if (count == 4) parts.back().insert(parts.back().begin() + 2, mean_of({middle(0), middle(2)}));
    }
    if (count == 3) parts.push_back({middle(0), middle(1), middle(2)});
    std::vector<std::vector<int>> faces;
    for (const auto& corners : parts) {
      auto& nodes = faces.emplace_back();
      for (const auto& key : corners) nodes.push_back(known_.at(key));
      for (int k = 0; k < count; ++k) nodes.push_back(known_.at(mean_of({corners[k], corners[(k + 1) % count]})));
      if (face.size() == 9) nodes.push_back(known_.at(mean_of(corners)));
    }
    return faces;
  }

  const ImportedMesh& coarse_;
  ImportedMesh fine_;
  std::map<Key, int> known_;
  std::vector<Vec<double, 3>> places_;  ///< of new nodes
};

}  // namespace

ImportedMesh split_in_space(const ImportedMesh& coarse) {
  if (!is_quadratic(coarse.mesh.shape)) return SolidSplitting(coarse).run();
  ImportedMesh fine;
  with_shape(coarse.mesh.shape, [&]<class Shape>(Shape) {
    if constexpr (Shape::dimension == 3 && Shape::nodes > Shape::corners) fine = CurvedSplitting<Shape>(coarse).run();
  });
  return fine;
}

}  // namespace stickslip
