/// Segment-wise integrated (mortar) contact in space at small strain: gap and weights of the multiplier of one slave
/// node, as integrals over the overlaps of slave and master facets. The formulas are those of segments.hpp:
///
///   A_j = int psi_j dA      w_j = (1/A_j) int psi_j (u_s - u_m) dA      g_j = n_j . (1/A_j) int psi_j (x_s - y) dA
///   n_j parallel to int psi_j (n_m - n_s) dA
///
///   psi_j   weight of corner j of the slave facet, with an equal share of those of corners that carry no multiplier
///   x_s, y  places of the slave side and of the master that are on one line along the normal of the slave facet
///
/// An overlap is a polygon in the plane across that normal. It is cut into triangles from the mean of its vertices, and
/// each has n x n points of Gauss, collapsed to it: exact to degree 2 n - 2. Linear triangles need degree 2, and have
/// n = 2; parallelograms need 4, and the sides of quadratic elements 6: n = 4. The weights of another quadrilateral are
/// no polynomials in its plane, and n = 4 leaves an error there.
///
/// The polygon's vertices are nodes or crossings of edges, so all is a closed form of the positions of the nodes, in
/// any scalar. A facet of the side of a quadratic element decides what overlaps what; places, normals and weights are
/// those of the side. Source: [PL04] of core/README.md.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "core/contact/contact_integrals.hpp"
#include "core/contact/face.hpp"
#include "core/contact/overlap.hpp"

namespace stickslip {

/// Shape functions of the side of an element in space and their derivatives, at the coordinates (s, t) of a face. Nodes
/// are those of sides_of().
template <class T>
struct SideWeights {
  std::array<T, 9> value{}, along_s{}, along_t{};
};
template <class T>
SideWeights<T> side_weights(int nodes, const T& s, const T& t);

/// Coordinates (s, t) of a node of a side, by its number in it and the number of its corners.
Vec<double, 2> side_node(int corners, int number);

namespace detail {

/// Points of Gauss on [0, 1] and their weights.
struct GaussRule {
  int points;
  std::array<double, 4> at, weight;
};
/// The rule that an overlap needs.
const GaussRule& rule_of(const Overlap& overlap);

/// A place of a facet.
template <class T>
struct SideFacetPlace {
  Vec<T, 3> y;               ///< of the side, from the origin of the facet, length
  Vec<T, 3> across;          ///< y_s x y_t of the side, by the coordinates of the facet
  std::array<T, 9> weights;  ///< of node(0), node(1), ...
};

/// A facet with the positions of its nodes, from an origin.
template <class T>
class PlacedSideFacet {
 public:
  template <class Position>
  PlacedSideFacet(const SideFacet& facet, const Vec<T, 3>& origin, Position&& position) : facet_(facet) {
    const auto place = [&](int node) -> Vec<T, 3> { return position(node) - origin; };
    for (int k = 0; k < 4; ++k) corner_[k] = place(facet.nodes[std::min(k, facet.corners - 1)]);
    for (std::size_t a = 0; a < facet.side.size(); ++a) side_[a] = place(facet.side[a]);
  }

  /// The nodes of a place's weights.
  int node_count() const { return is_whole() ? facet_.corners : static_cast<int>(facet_.side.size()); }
  int node(int number) const { return is_whole() ? facet_.nodes[number] : facet_.side[number]; }

  Vec<T, 3> normal() const {
    const Vec<T, 3> across = area_vector<T>(facet_.corners, [this](int k) { return corner_[k]; });
    return across / norm(across);
  }

  /// Coordinates at which the line through p along n meets the facet.
  Vec<T, 2> met(const Vec<T, 3>& p, const Vec<T, 3>& n) const {
    constexpr int most = 30, layers = 2;  // (one step in T gives first derivatives, and another those of two layers)
    constexpr double done = 1e-12;
    std::array<Vec<double, 3>, 4> corner;
    for (int k = 0; k < 4; ++k) corner[k] = values(corner_[k]);
    const Vec<double, 3> p_value = values(p), n_value = values(n);
    Vec<double, 2> at = facet_.corners == 3 ? Vec<double, 2>(1.0 / 3, 1.0 / 3) : Vec<double, 2>(0.5, 0.5);
    for (int i = 0; i < most; ++i) {
      const Vec<double, 2> step = step_to<double>(corner, at, p_value, n_value);
      if (!step.allFinite()) break;
      at += step;
      if (step.norm() <= done) break;
    }
    Vec<T, 2> exact{T(at[0]), T(at[1])};
    for (int layer = 0; layer < layers; ++layer) exact += step_to<T>(corner_, exact, p, n);
    return exact;
  }

  /// (y_s x y_t) . n of the flat facet.
  T area_seen(const Vec<T, 2>& at, const Vec<T, 3>& n) const {
    const auto place = face_position(corner_, face_weights<T>(facet_.corners, at[0], at[1]));
    return dot(cross<T>(place.along_s, place.along_t), n);
  }

  /// The sum of psi[k] times the weight of corner k.
  T weigh(const Vec<T, 2>& at, const std::array<double, 4>& psi) const {
    const auto own = face_weights<T>(facet_.corners, at[0], at[1]);
    T sum(0);
    for (int k = 0; k < facet_.corners; ++k) sum += T(psi[k]) * own.value[k];
    return sum;
  }

  SideFacetPlace<T> at(const Vec<T, 2>& at) const {
    const auto own = face_weights<T>(facet_.corners, at[0], at[1]);
    SideFacetPlace<T> place;
    if (is_whole()) {
      const auto position = face_position(corner_, own);
      std::copy(own.value.begin(), own.value.end(), place.weights.begin());
      place.y = position.y;
      place.across = cross<T>(position.along_s, position.along_t);
      return place;
    }
    // the facet's coordinates in those of the side, and their derivatives
    T s(0), t(0), s_s(0), s_t(0), t_s(0), t_t(0);
    const int corners = corners_of_face(facet_.side.size());
    for (int k = 0; k < facet_.corners; ++k) {
      const auto number = std::find(facet_.side.begin(), facet_.side.end(), facet_.nodes[k]) - facet_.side.begin();
      const Vec<double, 2> of = side_node(corners, static_cast<int>(number));
      s += own.value[k] * T(of[0]);
      t += own.value[k] * T(of[1]);
      s_s += own.along_s[k] * T(of[0]);
      s_t += own.along_t[k] * T(of[0]);
      t_s += own.along_s[k] * T(of[1]);
      t_t += own.along_t[k] * T(of[1]);
    }
    const auto weights = side_weights<T>(static_cast<int>(facet_.side.size()), s, t);
    place.weights = weights.value;
    Vec<T, 3> along_s = Vec<T, 3>::Constant(T(0)), along_t = along_s;
    place.y = along_s;
    for (std::size_t a = 0; a < facet_.side.size(); ++a)
      for (int i = 0; i < 3; ++i) {
        place.y[i] += weights.value[a] * side_[a][i];
        along_s[i] += weights.along_s[a] * side_[a][i];
        along_t[i] += weights.along_t[a] * side_[a][i];
      }
    place.across = cross<T>(along_s, along_t) * (s_s * t_t - s_t * t_s);
    return place;
  }

 private:
  bool is_whole() const { return facet_.side.empty(); }

  template <class U>
  Vec<U, 2> step_to(const std::array<Vec<U, 3>, 4>& corner, const Vec<U, 2>& at, const Vec<U, 3>& p,
                    const Vec<U, 3>& n) const {
    const auto place = face_position(corner, face_weights<U>(facet_.corners, at[0], at[1]));
    const Vec<U, 3> rest = p - place.y;
    const U area = dot(cross<U>(place.along_s, place.along_t), n);
    return {dot(cross<U>(rest, place.along_t), n) / area, dot(cross<U>(place.along_s, rest), n) / area};
  }

  const SideFacet& facet_;
  std::array<Vec<T, 3>, 4> corner_;
  std::array<Vec<T, 3>, 9> side_;
};

/// The polygon's vertices, somewhere on the lines along n that they stand for. `place(node)`: its position.
template <class T, class Place>
std::vector<Vec<T, 3>> vertices_of_overlap(const Overlap& overlap, const Vec<T, 3>& n, Place&& place) {
  std::vector<Vec<T, 3>> vertices;
  for (const auto& vertex : overlap.vertices) {
    const Vec<T, 3> a = place(vertex.first[0]);
    if (vertex.is_node()) {
      vertices.push_back(a);
      continue;
    }
    const Vec<T, 3> along = place(vertex.first[1]) - a, c = place(vertex.second[0]),
                    other = place(vertex.second[1]) - c;
    const T share = dot(cross<T>(Vec<T, 3>(c - a), other), n) / dot(cross<T>(along, other), n);
    vertices.push_back(a + along * share);
  }
  return vertices;
}

/// Calls f(p, dA) at the points of an overlap: p in the plane across n, dA its share of the area there. `place(node)`:
/// its position.
template <class T, class Place, class F>
void for_each_point_of_overlap(const Overlap& overlap, const Vec<T, 3>& n, Place&& place, F&& f) {
  const auto vertices = vertices_of_overlap<T>(overlap, n, place);
  const auto& rule = rule_of(overlap);
  Vec<T, 3> middle = Vec<T, 3>::Constant(T(0));
  for (const auto& vertex : vertices) middle += vertex / T(static_cast<double>(vertices.size()));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec<T, 3> a = vertices[v] - middle, b = vertices[(v + 1) % vertices.size()] - vertices[v];
    const T twice = dot(cross<T>(a, b), n);
    for (int i = 0; i < rule.points; ++i)
      for (int j = 0; j < rule.points; ++j)
        f(Vec<T, 3>(middle + (a + b * T(rule.at[j])) * T(rule.at[i])),
          T(twice * T(rule.at[i] * rule.weight[i] * rule.weight[j])));
  }
}

}  // namespace detail

/// Integrals over the overlaps of one contact point.
///
///   nodes           nodes of the contact point, in the order of the weights that are returned
///   position(node)  Vec<T, 3>
///   foot(X)         PointGeometry of the place X against the obstacle; called if an overlap has no master facet
///
/// A master whose nodes are not among `nodes` is rigid: it has no weights, and the normal is its own.
template <class T, class Position, class FootOf>
ContactIntegrals<T, 3> integrate_overlaps(const std::vector<Overlap>& overlaps, const std::vector<int>& nodes,
                                          Position&& position, FootOf&& foot) {
  ContactIntegrals<T, 3> sums;
  sums.weights = decltype(sums.weights)::Constant(static_cast<Eigen::Index>(nodes.size()), T(0));
  const auto share = [&](const detail::PlacedSideFacet<T>& facet, const detail::SideFacetPlace<T>& at, const T& w) {
    for (int k = 0; k < facet.node_count(); ++k)
      sums.weights[std::find(nodes.begin(), nodes.end(), facet.node(k)) - nodes.begin()] += w * at.weights[k];
  };
  for (const auto& overlap : overlaps) {
    const Vec<T, 3> origin = position(overlap.slave.nodes[0]);
    const detail::PlacedSideFacet<T> slave(overlap.slave, origin, position);
    std::optional<detail::PlacedSideFacet<T>> master;
    if (overlap.master.corners > 0) master.emplace(overlap.master, origin, position);
    const bool deforms = master && std::find(nodes.begin(), nodes.end(), overlap.master.nodes[0]) != nodes.end();
    const Vec<T, 3> n = slave.normal();
    const auto place = [&](int node) -> Vec<T, 3> { return position(node) - origin; };
    detail::for_each_point_of_overlap<T>(overlap, n, place, [&](const Vec<T, 3>& p, const T& dA_seen) {
      const Vec<T, 2> at = slave.met(p, n);
      const auto x = slave.at(at);
      const T stretch = norm(x.across);
      const Vec<T, 3> slave_normal = x.across / stretch;
      T dA = dA_seen * stretch / slave.area_seen(at, n) * slave.weigh(at, overlap.psi);
      Vec<T, 3> off, normal;
      if (master) {
        const auto y = master->at(master->met(p, n));
        off = x.y - y.y;
        normal = y.across / norm(y.across);
        dA *= weight_of_angle<3, T>(slave_normal, normal);
        if (deforms) share(*master, y, -dA);
      } else {
        const PointGeometry<T> g = foot(Vec<T, 3>(origin + x.y));
        for (int k = 0; k < 3; ++k) normal[k] = g.normal[k];
        off = normal * g.gap;
      }
      share(slave, x, dA);
      sums.area += dA;
      sums.gap += off * dA;
      sums.normal += (deforms ? Vec<T, 3>(normal - slave_normal) : normal) * dA;
    });
  }
  return sums;
}

/// The nodes of a contact point, each once, in this order: `own`, the other nodes of the slave facets, those of the
/// master facets; of all only those below `node_count`, which are no vertices of an obstacle. `slave_nodes`: result,
/// how many of them are of the slave.
std::vector<int> nodes_of_overlaps(int own, const std::vector<Overlap>& overlaps, int node_count, int& slave_nodes);

template <class T>
SideWeights<T> side_weights(int nodes, const T& s, const T& t) {
  SideWeights<T> out;
  if (nodes <= 4) {
    const auto weights = face_weights<T>(nodes, s, t);
    std::copy(weights.value.begin(), weights.value.end(), out.value.begin());
    std::copy(weights.along_s.begin(), weights.along_s.end(), out.along_s.begin());
    std::copy(weights.along_t.begin(), weights.along_t.end(), out.along_t.begin());
    return out;
  }
  const T one(1), two(2), four(4);
  if (nodes == 6) {
    const std::array<T, 3> of{one - s - t, s, t};
    constexpr double by_s[3] = {-1, 1, 0}, by_t[3] = {-1, 0, 1};
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      out.value[k] = of[k] * (two * of[k] - one);
      out.along_s[k] = (four * of[k] - one) * T(by_s[k]);
      out.along_t[k] = (four * of[k] - one) * T(by_t[k]);
      out.value[3 + k] = four * of[k] * of[next];
      out.along_s[3 + k] = four * (T(by_s[k]) * of[next] + of[k] * T(by_s[next]));
      out.along_t[3 + k] = four * (T(by_t[k]) * of[next] + of[k] * T(by_t[next]));
    }
    return out;
  }
  // nine nodes: products of parabolas, 1 at 0, 1/2 or 1
  const auto parabolas = [&](const T& x) {
    return std::array<T, 3>{(one - x) * (one - two * x), four * x * (one - x), x * (two * x - one)};
  };
  const auto slopes = [&](const T& x) { return std::array<T, 3>{four * x - T(3), four - T(8) * x, four * x - one}; };
  const auto P = parabolas(s), Q = parabolas(t), p = slopes(s), q = slopes(t);
  for (int k = 0; k < 9; ++k) {
    const Vec<double, 2> at = side_node(4, k);
    const int i = static_cast<int>(2 * at[0]), j = static_cast<int>(2 * at[1]);
    out.value[k] = P[i] * Q[j];
    out.along_s[k] = p[i] * Q[j];
    out.along_t[k] = P[i] * q[j];
  }
  if (nodes == 9) return out;
  for (auto* of : {&out.value, &out.along_s, &out.along_t}) {  // the middle follows the eight others
    for (int k = 0; k < 8; ++k) (*of)[k] += T(k < 4 ? -0.25 : 0.5) * (*of)[8];
    (*of)[8] = T(0);
  }
  return out;
}

}  // namespace stickslip
