#include "core/mesh/msh_elements.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace stickslip {
namespace {

/// Appends an edge to a curve, whose nodes `listed` holds.
void append_edge(const ElementFacet& edge, Side& side, std::set<int>& listed) {
  const auto list = [&](int node) {
    if (listed.insert(node).second) side.nodes.push_back(node);
  };
  const int a = edge[0], b = edge[1], middle = edge[2];
  list(a);
  if (middle >= 0) {
    list(middle);
    side.facets.push_back({a, middle});
    side.facets.push_back({middle, b});
    side.quadratic.push_back({a, b, middle});
  } else {
    side.facets.push_back({a, b});
  }
  list(b);
}

Side side_of_edges(const std::vector<ElementFacet>& edges) {
  std::multimap<int, std::size_t> from;
  std::set<int> ends, listed;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    from.emplace(edges[i][0], i);
    ends.insert(edges[i][1]);
  }
  Side side;
  std::vector<bool> used(edges.size(), false);
  auto follow = [&](std::size_t i) {
    for (std::optional<std::size_t> next = i; next && !used[*next];) {
      used[*next] = true;
      const ElementFacet& edge = edges[*next];
      append_edge(edge, side, listed);
      next.reset();
      for (auto [it, last] = from.equal_range(edge[1]); it != last && !next; ++it)
        if (!used[it->second]) next = it->second;
    }
  };
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (!ends.count(edges[i][0])) follow(i);
  for (std::size_t i = 0; i < edges.size(); ++i) follow(i);
  return side;
}

Side side_of_faces(const std::vector<ElementFacet>& faces) {
  Side side;
  std::set<int> ascending;
  for (const ElementFacet& face : faces) {
    const auto nodes = nodes_of(face);
    for (auto& facet : facets_of_side(nodes, 3)) side.facets.push_back(std::move(facet));
    if (nodes.size() > 4) side.quadratic.push_back(nodes);
    ascending.insert(nodes.begin(), nodes.end());
  }
  side.nodes.assign(ascending.begin(), ascending.end());
  return side;
}

}  // namespace

double orientation(const Mesh& mesh, const Points<double>& points, int element) {
  const int* nodes = mesh.connectivity.data() + static_cast<std::size_t>(element) * nodes_of(mesh.shape);
  // from the first node, so that a body far from the origin loses no digits
  const auto at = [&](int k) -> Vec<double, 3> {
    Vec<double, 3> place = Vec<double, 3>::Zero();
    place.head(mesh.dimension) = points.col(nodes[k]) - points.col(nodes[0]);
    return place;
  };
  const ElementShape linear = linear_shape(mesh.shape);
  if (linear == ElementShape::tet4) return at(1).cross(at(2)).dot(at(3));
  if (linear == ElementShape::hex8) {
    const Vec<double, 3> x = at(1) + at(2) + at(5) + at(6) - at(3) - at(4) - at(7),
                         y = at(2) + at(3) + at(6) + at(7) - at(1) - at(4) - at(5),
                         z = at(4) + at(5) + at(6) + at(7) - at(1) - at(2) - at(3);
    return x.cross(y).dot(z);
  }
  const int count = corners_of(mesh.shape);
  double sum = 0;
  for (int k = 0; k < count; ++k) sum += at(k).cross(at((k + 1) % count))[2];
  return sum;
}

void turn_over(Mesh& mesh, int element) {
  const int count = nodes_of(mesh.shape), corners = corners_of(mesh.shape);
  const auto first = mesh.connectivity.begin() + static_cast<std::ptrdiff_t>(element) * count;
  if (!is_solid(mesh.shape)) {
    std::reverse(first + 1, first + corners);
    std::reverse(first + corners, first + count);  // the last side is now the first
    return;
  }
  // of a tetrahedron corners 0 and 1 change places, of a hexahedron bottom and top; the others go with their corners
  const auto turned_corner = [&](int a) { return corners == 8 ? (a + 4) % 8 : a < 2 ? 1 - a : a; };
  const auto& around = corners_around(mesh.shape);
  const std::vector<int> nodes(first, first + count);
  for (int a = 0; a < count; ++a) {
    std::vector<int> of = around[a];
    for (int& corner : of) corner = turned_corner(corner);
    const auto found = std::find_if(around.begin(), around.end(), [&](const std::vector<int>& other) {
      return std::is_permutation(other.begin(), other.end(), of.begin(), of.end());
    });
    first[a] = nodes[found - around.begin()];
  }
}

ElementFacet element_facet(const std::vector<int>& nodes, int of) {
  ElementFacet facet;
  facet.fill(-1);
  std::copy(nodes.begin(), nodes.end(), facet.begin());
  if (of != 3) return facet;
  const int corners = corners_of_face(nodes.size());
  const auto least = std::min_element(facet.begin(), facet.begin() + corners) - facet.begin();
  std::rotate(facet.begin(), facet.begin() + least, facet.begin() + corners);
  if (nodes.size() > 4)
    std::rotate(facet.begin() + corners, facet.begin() + corners + least, facet.begin() + 2 * corners);
  return facet;
}

std::vector<int> nodes_of(const ElementFacet& facet) {
  return {facet.begin(), std::find(facet.begin(), facet.end(), -1)};
}

ElementFacet without_middles(const ElementFacet& facet, int of) {
  ElementFacet bare = facet;
  std::fill(bare.begin() + (of == 3 ? corners_of_face(nodes_of(facet).size()) : of), bare.end(), -1);
  return bare;
}

ElementFacet turned(const ElementFacet& facet, int of) {
  ElementFacet back = facet;
  if (of == 2) std::swap(back[0], back[1]);
  if (of != 3) return back;
  const auto count = nodes_of(facet).size();
  const int corners = corners_of_face(count);
  std::reverse(back.begin() + 1, back.begin() + corners);
  if (count > 4) std::reverse(back.begin() + corners, back.begin() + 2 * corners);  // the last edge is now the first
  return back;
}

std::vector<ElementFacet> facets_of_element(const Mesh& mesh, int element) {
  const int* nodes = mesh.connectivity.data() + static_cast<std::size_t>(element) * nodes_of(mesh.shape);
  std::vector<ElementFacet> facets;
  for (std::vector<int> side : sides_of(mesh.shape)) {
    for (int& node : side) node = nodes[node];
    facets.push_back(element_facet(side, mesh.dimension));
  }
  return facets;
}

Side side_of_facets(const std::vector<ElementFacet>& facets, int of) {
  if (of == 2) return side_of_edges(facets);
  if (of == 3) return side_of_faces(facets);
  Side side;
  for (const ElementFacet& facet : facets) side.nodes.push_back(facet[0]);
  return side;
}

}  // namespace stickslip
