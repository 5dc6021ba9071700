/// Masters, and the foot of a point on them, by the plainest search there is: every point against every facet
/// (core/README.md, Along a curve, A side that touches itself). All in the frame of the master: of an obstacle the one
/// that moves with it, in which its points stay where they are at the start.
///
///   y(xi) = sum N_i(xi) y_i,   (x - y) . y' = 0,   n across y',   g = n . (x - y)          on facets and smooth
///   patches g = n . (x - p);   g = +- (|x - c| - r)                                                 on a plane; a
///   circle
#pragma once

#include <vector>

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

inline Vec2 right_of(const Vec2& tau) { return {tau[1], -tau[0]}; }  ///< out of a solid on the left
inline Vec3 in_space(const Vec2& v) { return {v[0], v[1], 0}; }
inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

constexpr double at_end = 1e-9;  ///< share of a facet within which a foot is at its end: rounding of coordinates

/// From vertex 1 to vertex 2; 0 and 3 are their neighbours, where the master is smooth there.
struct Patch {
  Nodes vertex;
  int previous = -1, next = -1;                     ///< patches; -1: a free end
  std::array<bool, 2> goes_on = {false, false};     ///< smoothly, into the previous and the next patch
  Eigen::Matrix4d shape = Eigen::Matrix4d::Zero();  ///< N_i = column i times (1, xi, xi^2, xi^3)
  double length = 0, arc = -1;                      ///< of the start; along the master to its beginning
};

struct Place {
  int patch = -1;  ///< -1: none
  double xi = 0;
};

struct Foot {
  bool faces = false;
  Vec3 y = Vec3::Zero(), normal = Vec3::UnitY();
  double gap = 0;                                    ///< of what faces nothing the distance
  Place place;                                       ///< of what faces nothing the nearest
  std::vector<std::pair<int, double>> weights = {};  ///< -N_i of the nodes of a master that deforms
};

/// A slave point that looks for its foot.
struct Seeker {
  int node = -1;
  Vec3 x = Vec3::Zero();
  Vec2 outward = Vec2::Zero();  ///< sum of the normals of its facets, times their lengths; zero: it has none
};

class Master {
 public:
  /// `slave`: side expression; the same as `master` where a side touches itself.
  Master(const Scene& scene, const Json& contact, const std::string& slave, const std::string& master);
  bool rigid() const { return nodes.empty(); }
  Places vertices(const Field& u) const;  ///< where they are
  Vec2 position(const Places& at, const Place& place, int derivative = 0) const;
  Foot foot(const Seeker& seeker, const Places& at) const;
  /// What a side that touches itself does not face: its own wall. `seekers`: its points at the start.
  void set_walls(const std::vector<Seeker>& seekers);

  Nodes nodes;  ///< of the vertices of a master that deforms
  std::vector<Patch> patches;
  double loop = 0;  ///< length of a closed master; 0: it is open
  Motion motion;    ///< of an obstacle

 private:
  void link(double corner);
  bool may_face(const Seeker& seeker, int patch, const Places& at) const;
  Place closest(const Seeker& seeker, const Places& at) const;
  Place find(const Seeker& seeker, const Places& at) const;
  void share_vertex(const Seeker& seeker, const Places& at, Foot& foot) const;

  const Scene& scene_;
  Json obstacle_;                           ///< empty: the master deforms
  Places polyline_;                         ///< points of an obstacle
  int smooth_ = 0;                          ///< 0: facets, 1: Catmull-Rom, 2: B-spline
  bool itself_ = false, frozen_ = false;    ///< frozen: facets of the start, at small strain
  std::map<int, std::vector<char>> walls_;  ///< of each node, the patches of its own wall
};

}  // namespace stickslip::verify
