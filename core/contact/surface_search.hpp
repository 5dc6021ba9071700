/// Search for the closest place of a master surface in space, where its vertices are now.
///
/// Beyond an edge at which the normal jumps its two patches go on, each along itself, and a point that projects into
/// neither of them has the larger of the two gaps. So the gap is continuous there, and an edge has no contact state of
/// its own. At a corner the same holds of all patches there. A patch that does not oppose the slave side is passed
/// over: where it joins, the surface ends as at a border.
#pragma once

#include "core/contact/face_search.hpp"
#include "core/contact/surface.hpp"

namespace stickslip {

/// The place of a facing on every patch that has it, first its own. It is exactly on an edge or a corner that it is
/// nearer to than `within`, in coordinates of its patch.
std::vector<Facing> patches_at(const std::vector<SurfacePatch>& patches, Facing facing, double within = at_face_edge);
/// The place of an edge of its patch that is near a facing, on this patch and on the one behind the edge. pre: there is
/// one.
std::array<Facing, 2> places_on_edge(const std::vector<SurfacePatch>& patches, const Facing& facing, int edge);

class SurfaceSearch {
 public:
  /// `positions`: of the vertices, 3 x vertices, length. Both arguments must outlive the search.
  SurfaceSearch(const std::vector<SurfacePatch>& patches, const Points<double>& positions);

  /// The place of the surface that x faces; patch = none where x lies past a border, or beyond a centre of curvature.
  ///
  ///   outward  outward normal of the slave side at x, any length. Only patches whose normal opposes it are eligible;
  ///            if it is zero, all patches are
  ///
  /// If the nearest of all patches has x outside of the solid, x is not inside of the solid by a farther patch.
  Facing facing(const Vec<double, 3>& x, const Vec<double, 3>& outward) const;
  /// The foot of x on one patch, which is extended past its edges.
  Facing foot_on(int patch, const Vec<double, 3>& x) const;

 private:
  using Near = FaceSearch::Near;
  /// The search's question: which place is nearest to x among the patches that oppose `outward`, if that is not zero?
  struct Query {
    Vec<double, 3> x, outward;
  };
  bool is_eligible(int patch, const Query& query) const;
  bool is_past_end(const Facing& at, const Query& query) const;
  Facing nearest_facing(const Query& query) const;
  Facing newton_foot(Facing at, const Vec<double, 3>& x, int hops) const;
  Facing beyond_edges(const Facing& at, const Query& query) const;
  Facing larger_gap(const std::vector<Facing>& feet, const Vec<double, 3>& x) const;
  double gap(const Facing& at, const Vec<double, 3>& x) const;
  Eigen::Matrix3Xd arms(int patch, const Vec<double, 3>& x) const;

  const std::vector<SurfacePatch>& patches_;
  const Points<double>& positions_;
  FaceSearch faces_;
};

}  // namespace stickslip
