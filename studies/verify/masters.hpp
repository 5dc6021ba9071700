/// Masters, and the foot of a point on them, by the plainest search there is: every point against every facet
/// (core/README.md, Along a curve, A side that touches itself). All in the frame of the master: of an obstacle the one
/// that moves with it, in which its points stay where they are at the start.
///
///   y(xi) = sum N_i(xi) y_i,   (x - y) . y' = 0,   n across y',   g = n . (x - y)          on facets and smooth
///   patches g = n . (x - p);   g = +- (|x - c| - r)                                                 on a plane; a
///   circle
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

/// A vector to the right of a line with the solid on its left.
inline Vec2 right_of(const Vec2& tau) { return {tau[1], -tau[0]}; }
inline Vec3 in_space(const Vec2& v) { return {v[0], v[1], 0}; }
inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

constexpr double at_end = 1e-9;  ///< share of a facet within which a foot is at its end: rounding of coordinates

/// From vertex 1 to vertex 2; 0 and 3 are the neighbours across no corner of a smooth master, -1: none.
struct Patch {
  std::array<int, 4> vertex{-1, -1, -1, -1};
  int previous = -1, next = -1;  ///< patches
  double length = 0, arc = -1;   ///< of the start; along the master to its beginning
};

struct Place {
  int patch = -1;  ///< -1: nothing is faced, or the master has no patches
  double xi = 0;
};

struct Foot {
  bool faces = false;
  Vec3 y = Vec3::Zero(), normal = Vec3::UnitY();
  double gap = 0;
  Place place;
  std::vector<std::pair<int, double>> weights;  ///< -N_i of the nodes of a master that deforms
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
  Eigen::Matrix2Xd vertices(const Field& u) const;  ///< where they are
  Vec2 position(const Eigen::Matrix2Xd& at, const Place& place, int derivative = 0) const;
  Foot foot(const Seeker& seeker, const Eigen::Matrix2Xd& at) const;
  /// What a side that touches itself does not face: its own wall. `seekers`: its points at the start.
  void set_walls(const std::vector<Seeker>& seekers);

  std::vector<int> nodes;  ///< of the vertices of a master that deforms
  std::vector<Patch> patches;
  double loop = 0;  ///< length of a closed master; 0: it is open
  Motion motion;    ///< of an obstacle

 private:
  std::array<double, 4> weights(const Patch& patch, double xi, int derivative) const;
  bool may_face(const Seeker& seeker, int patch, const Eigen::Matrix2Xd& at) const;
  Place closest(const Seeker& seeker, const Eigen::Matrix2Xd& at) const;
  Place along_patches(const Seeker& seeker, const Eigen::Matrix2Xd& at, Place from) const;
  Place past_end(const Seeker& seeker, const Eigen::Matrix2Xd& at, const Place& place) const;
  Place find(const Seeker& seeker, const Eigen::Matrix2Xd& at) const;
  void share_vertex(const Seeker& seeker, const Eigen::Matrix2Xd& at, Foot& foot) const;
  void link(double corner);

  const Scene& scene_;
  Json obstacle_;              ///< empty: the master deforms
  Eigen::Matrix2Xd polyline_;  ///< points of an obstacle
  enum class Smooth { no, catmull_rom, b_spline } smooth_ = Smooth::no;
  bool itself_ = false, frozen_ = false;    ///< frozen: facets of the start, at small strain
  std::map<int, std::vector<char>> walls_;  ///< of each node, the patches of its own wall
};

}  // namespace stickslip::verify
