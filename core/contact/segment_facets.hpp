/// The facets of a segment of segments.hpp: its slave facet with the points on it, and what they face of its master
/// facet.
#pragma once

#include <array>
#include <cmath>

#include "core/contact/placed.hpp"
#include "core/contact/segment.hpp"

namespace stickslip {

namespace detail {

/// Bulge of a facet that is half of the side of a quadratic element: d. Zero, and not curved, on a linear one.
template <class T, class S>
struct Bulge {
  bool is_curved = false;
  Vec<S, 2> start = Vec<S, 2>::Constant(S(0));
  Vec<T, 2> moved = Vec<T, 2>::Constant(T(0));
  Vec<T, 2> now() const { return {T(start[0]) + moved[0], T(start[1]) + moved[1]}; }
};

template <class T, class S, class Position>
Bulge<T, S> bulge_of(const std::array<int, 3>& edge, Position&& position) {
  Bulge<T, S> bulge;
  if (edge[2] == Segment::none) return bulge;
  const Placed<T, S> a = position(edge[0]), b = position(edge[1]), middle = position(edge[2]);
  bulge.is_curved = true;
  bulge.start = S(0.5) * ((middle.start - a.start) + (middle.start - b.start));
  bulge.moved = T(0.5) * ((middle.moved - a.moved) + (middle.moved - b.moved));
  return bulge;
}

/// The way from the coordinate `from` along a curve, in that coordinate, to where it has gone by `way`: solves
///
///   way = shift straight + s (1 - s) bent,   s = from + shift
///
/// for shift, which keeps the digits of a small way. Of the two solutions it is that at which way grows as it does
/// without `bent`. Two Newton steps in T from it, in numbers, carry its derivatives. Where the curve turns back before
/// it goes so far, nothing is there; then the place on the straight facet.
template <class T>
T along_bulge(const T& from, const T& way, const T& straight, const T& bent) {
  const T rest = way - from * (T(1) - from) * bent, slope = straight + (T(1) - T(2) * from) * bent;
  const double square = value(slope) * value(slope) - 4 * value(bent) * value(rest);
  if (square <= 0) return way / straight;
  const double root = std::copysign(std::sqrt(square), value(straight));     // the slope there
  const bool alike = value(slope) == 0 || (value(slope) > 0) == (root > 0);  // (else it would cancel)
  auto shift = T(alike ? 2 * value(rest) / (value(slope) + root) : (value(slope) - root) / (2 * value(bent)));
  for (int k = 0; k < 2; ++k) shift += (rest - shift * (slope - shift * bent)) / (slope - T(2) * shift * bent);
  return shift;
}

/// Coordinate of a segment's end along the slave facet: 0 at its first node a, 1 at its second. `tau`: vector from a to
/// the second node. `position(node)`: Placed.
template <class T, class S, class Position, class Place>
T end_coordinate(int segment_end, Position&& position, const Place& a, const Vec<T, 2>& tau, const Bulge<T, S>& bulge) {
  if (segment_end == Segment::start) return T(0);
  if (segment_end == Segment::end) return T(1);
  const T way = dot(Vec<T, 2>(position(segment_end) - a), tau), straight = dot(tau, tau);
  return bulge.is_curved ? along_bulge<T>(T(0), way, straight, dot(bulge.now(), tau)) : T(way / straight);
}

/// A point of a slave facet.
template <class T>
struct SlavePoint {
  Vec<T, 2> start, moved;  ///< initial place; displacement, less that of the facet's first node
  Vec<T, 2> normal;        ///< unit, outward, as it is now
  T stretch{};             ///< initial length per coordinate
};

/// Slave facet a -> b.
template <class T, class S>
class SlaveFacet {
 public:
  template <class Position>
  SlaveFacet(const Segment& segment, Position&& position)
      : a(position(segment.slave[0])),
        b(position(segment.slave[1])),
        bulge(bulge_of<T, S>(segment.slave_edge, position)),
        along_start_(b.start - a.start),
        along_(b - a),
        stretched_(b.moved - a.moved),
        length_(norm(along_start_)) {}
  /// The point at the coordinate s.
  SlavePoint<T> at(const T& s) const {
    SlavePoint<T> point;
    Vec<T, 2> along = along_, slope;
    for (int i = 0; i < 2; ++i) point.start[i] = T(a.start[i]) + s * along_start_[i];
    point.moved = s * stretched_;
    point.stretch = T(length_);
    if (bulge.is_curved) {
      const T bend = s * (T(1) - s), turn = T(1) - T(2) * s;
      for (int i = 0; i < 2; ++i) {
        point.start[i] += bend * bulge.start[i];
        slope[i] = T(along_start_[i]) + turn * bulge.start[i];
      }
      point.moved += bend * bulge.moved;
      point.stretch = norm(slope);
      along += turn * bulge.now();
    }
    const T length = norm(along);
    point.normal = Vec<T, 2>(along[1] / length, -along[0] / length);
    return point;
  }
  const Vec<T, 2>& along() const { return along_; }
  const S& length() const { return length_; }  ///< initial, of the straight facet

  Placed<T, S> a, b;
  Bulge<T, S> bulge;

 private:
  Vec<S, 2> along_start_;
  Vec<T, 2> along_, stretched_;
  S length_;
};

/// Slave facet a -> b over the line of its master facet c -> d, as they were at the start, in S, and as they are now.
template <class T, class S>
struct FacingFacets {
  S length{};                              ///< of the master facet, initial
  S first{}, along{};                      ///< E at a; what it grows by from a to b
  S distance{}, apart{};                   ///< G likewise
  Vec<S, 2> normal;                        ///< N
  Vec<T, 2> tau, facet, shift, stretched;  ///< tau, tau_m; u_a - u_c, u_d - u_c
  Bulge<T, S> bulge;                       ///< of the master
  S bulge_along{}, bulge_apart{};          ///< what E and G grow by with the slave's bulge

  FacingFacets(const SlaveFacet<T, S>& slave, const Placed<T, S>& c, const Placed<T, S>& d,
               const Bulge<T, S>& of_master)
      : tau(slave.along()),
        facet(d - c),
        shift(slave.a.moved - c.moved),
        stretched(d.moved - c.moved),
        bulge(of_master) {
    const Vec<S, 2> line = d.start - c.start, from = slave.a.start - c.start, to = slave.b.start - c.start;
    const S square = dot(line, line);
    length = norm(line);
    normal << line[1] / length, -line[0] / length;
    first = dot(from, line) / square;
    along = dot(to, line) / square - first;
    distance = dot(from, normal);
    apart = dot(to, normal) - distance;
    if (!slave.bulge.is_curved) return;
    bulge_along = dot(slave.bulge.start, line) / square;
    bulge_apart = dot(slave.bulge.start, normal);
  }
};

/// Foot of a slave point on its master.
template <class T>
struct Foot {
  Vec<T, 2> off;           ///< x - y
  Vec<T, 2> normal;        ///< unit, out of the master
  T eta{}, E{}, shift{};   ///< on a facet; shift = eta - E
  Vec<T, 2> tangent = {};  ///< on a facet: dy/deta
  Vec<T, 2> moved = {};    ///< on an obstacle: y, from the initial place of the slave point
};

/// Foot on a master facet of the slave point at the coordinate s, which moves by `moved` more than the facet's node a.
/// `is_curved`: the slave facet is.
template <class T, class S>
Foot<T> foot_on_facet(const FacingFacets<T, S>& facets, const T& s, const Vec<T, 2>& moved, bool is_curved) {
  Foot<T> foot;
  foot.E = T(facets.first) + s * facets.along;
  T G = T(facets.distance) + s * facets.apart;
  if (is_curved) {
    foot.E += s * (T(1) - s) * facets.bulge_along;
    G += s * (T(1) - s) * facets.bulge_apart;
  }
  for (int i = 0; i < 2; ++i)
    foot.off[i] = G * facets.normal[i] + (facets.shift[i] + moved[i] - foot.E * facets.stretched[i]);
  const T way = dot(foot.off, facets.tau), straight = dot(facets.facet, facets.tau);
  foot.tangent = facets.facet;
  if (facets.bulge.is_curved) {
    const Vec<T, 2> d = facets.bulge.now();
    foot.shift = along_bulge<T>(foot.E, way, straight, dot(d, facets.tau));
    foot.eta = foot.E + foot.shift;
    foot.off -= foot.shift * facets.facet + foot.eta * (T(1) - foot.eta) * d;
    foot.tangent += (T(1) - T(2) * foot.eta) * d;
  } else {
    foot.shift = way / straight;
    foot.off -= foot.shift * facets.facet;
    foot.eta = foot.E + foot.shift;
  }
  const T length = norm(foot.tangent);
  foot.normal = Vec<T, 2>(foot.tangent[1] / length, -foot.tangent[0] / length);
  return foot;
}

}  // namespace detail

}  // namespace stickslip
