#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

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

}  // namespace

ImportedMesh split_in_space(const ImportedMesh& coarse) { return SolidSplitting(coarse).run(); }

}  // namespace stickslip
