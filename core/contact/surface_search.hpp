/// Search for the place of a master surface that a point faces, where its vertices are now.
///
/// The patch that is nearest to the point is found by its facet, in a tree of boxes. From there Newton's method finds
/// the foot in double. It passes to the next patch where two patches join smoothly. What corners and creases are, and
/// where a surface ends, differs between the dimensions.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "core/contact/box_tree.hpp"
#include "core/contact/face_search.hpp"
#include "core/contact/own_vertex.hpp"
#include "core/contact/past_end.hpp"
#include "core/contact/surfaces.hpp"

namespace stickslip {

/// The question of the search: which place is nearest to x among the patches that may be faced?
template <int D>
struct SurfaceQuery {
  Vec<double, D> x;
  /// Outward normal of the slave side at x, any length. Only patches whose normal opposes it are eligible
  /// (surfaces.hpp, opposes()); if it is zero, all patches are.
  Vec<double, D> outward;
  /// In space: size of the slave facets at x, by which ends are rounded off (past_end.hpp); 0: they are not.
  double size = 0;
  /// Of a vertex of a surface in contact with itself: what it may face; the patch that it faced in the last state; in
  /// space the initial positions of the vertices.
  const OwnVertex* own = nullptr;
  int last = no_patch;
  const Places<D>* start = nullptr;
  /// Cosine by which a patch must oppose `outward`.
  double least_against() const { return own ? stickslip::least_against : least_against_a_side; }
};

template <int D>
class PatchSearch;

/// Search for what points face of a curve of the plane. It skips each box of facets that is too far away or whose
/// normals do not oppose the slave side. So it visits few facets, also on a side in contact with itself, where the
/// nearest facets belong to the point's own neighbourhood.
///
/// At a corner the curve continues as two straight lines that end in their bisector. So the gap is continuous there,
/// and a corner has no contact state of its own: beyond a convex corner a point has the gap to the line on its side of
/// the bisector.
template <>
class PatchSearch<2> {
 public:
  using Query = SurfaceQuery<2>;
  /// What a vertex of this curve faces, which is in contact with itself. A patch is eligible if its normal makes more
  /// than 120 degrees with `outward`, and if `own` allows it. The vertex may penetrate a patch up to own.max_depth if
  /// the patch is within 8 patches of `last`, the patch that it faced in the last state; otherwise up to a quarter of
  /// that. If it faces nothing, the distance is the size of the curve, and the nearest patch is not looked for.
  Facing facing_itself(const Query& query) const;
  /// The patch nearest to such a vertex: the nearest eligible one; if there is none, the nearest that `own` allows.
  int nearest_of_itself(const Query& query) const;

 protected:
  PatchSearch(const Surface<2>& patches, const Places<2>& positions);

  Facing nearest_facing(const Query& query) const;
  Facing newton_foot(Facing from, const Vec<double, 2>& x, int hops) const;
  double gap(const Facing& foot, const Vec<double, 2>& x) const;
  double size(int patch) const { return (vertex(patch, 1) - vertex(patch, 0)).norm(); }  ///< length
  bool is_outside_of_facets(const Vec<double, 2>& x) const;
  Vec<double, 2> normal(const Facing& foot) const;
  Facing settled(const Facing& foot, const Query& query) const;
  Facing facing_nothing(const Vec<double, 2>& x) const;
  Vec<double, 2> middle_of(int) const { return {0.5, 0}; }

 private:
  struct Nearest {
    int patch = no_patch;
    double xi = 0, distance = std::numeric_limits<double>::infinity();
  };
  Vec<double, 2> vertex(int patch, int end) const { return positions_.col(patches_[patch].corner(end)); }
  bool may_be_eligible(const Bounds<2>& box, const Query& query) const;
  Nearest nearest_facet(const Query& query) const;
  bool is_eligible(int patch, const Query& query) const;
  void compare_facet(int patch, const Vec<double, 2>& x, Nearest& best) const;
  Vec<double, 2> tangent_at_end(int patch, int end) const;
  Facing past_end(const Facing& foot, const Query& query) const;

  const Surface<2>& patches_;
  const Places<2>& positions_;
  BoxTree<2> facets_;  ///< from the start to the end of each patch; empty if a position is not finite
  double band_ = 0;    ///< length within which two distances are equal
  double size_ = std::numeric_limits<double>::infinity();  ///< diagonal of the box of the whole curve, length
};

/// Search for what points face of a surface in space.
///
/// Beyond an edge at which the normal jumps its two patches go on, each along itself, and a point that projects into
/// neither of them has the larger of the two gaps. So the gap is continuous there, and an edge has no contact state of
/// its own. At a corner the same holds of all patches there. A patch that does not oppose the slave side is passed
/// over: where it joins, the surface ends as at a border.
template <>
class PatchSearch<3> {
 public:
  using Query = SurfaceQuery<3>;
  /// What a vertex of this surface faces, which is in contact with itself, as on a curve of the plane. It may be inside
  /// by all of own.max_depth within 8 widths of patch `last` from its own middle. The place that it faces comes after
  /// it (OwnVertex).
  Facing facing_itself(const Query& query) const;
  int nearest_of_itself(const Query& query) const;

 protected:
  PatchSearch(const Surface<3>& patches, const Places<3>& positions);

  Facing nearest_facing(const Query& query) const;
  Facing newton_foot(Facing at, const Vec<double, 3>& x, int hops) const;
  double gap(const Facing& at, const Vec<double, 3>& x) const;
  double size(int patch) const { return std::sqrt(across(patch).norm()); }  ///< length
  bool is_outside_of_facets(const Vec<double, 3>& x) const;
  Vec<double, 3> normal(const Facing& at) const;
  Facing facing_nothing(const Vec<double, 3>& x) const;
  Facing at_ends(Facing at, const Query& query) const;
  Vec<double, 2> middle_of(int patch) const {
    return Vec<double, 2>::Constant(patches_[patch].corners == 3 ? 1.0 / 3 : 0.5);
  }

 private:
  using Near = FaceSearch::Near;
  Vec<double, 3> across(int patch) const;
  std::vector<Near> nearest_faces(const Query& query) const;
  bool may_be_touched(int patch, const Query& query) const;
  bool is_eligible(int patch, const Query& query) const;
  bool comes_after(const Facing& at, const OwnVertex& own) const;
  bool ends(int patch, int edge, const Query& query) const;
  bool is_past_end(const Facing& at, const Query& query) const;
  Facing beyond_edges(const Facing& at, const Query& query) const;
  Facing larger_gap(const std::vector<Facing>& feet, const Vec<double, 3>& x) const;
  Eigen::Matrix3Xd arms(int patch, const Vec<double, 3>& x) const;

  const Surface<3>& patches_;
  const Places<3>& positions_;
  FaceSearch faces_;
};

/// The place of a facing on every patch that has it, first its own. It is exactly on an edge or a corner that it is
/// nearer to than `within`, in coordinates of its patch.
std::vector<Facing> patches_at(const Surface<3>& patches, Facing facing, double within = at_face_edge);
/// The place of an edge of its patch that is near a facing, on this patch and on the one behind the edge. pre: there is
/// one.
std::array<Facing, 2> places_on_edge(const Surface<3>& patches, const Facing& facing, int edge);

template <int D>
class SurfaceSearch : public PatchSearch<D> {
 public:
  /// `patches` and `positions` must outlive the search.
  SurfaceSearch(const Surface<D>& patches, const Places<D>& positions) : PatchSearch<D>(patches, positions) {}

  using Query = SurfaceQuery<D>;
  /// The place of the surface that x faces; patch = no_patch where x lies past an end, or beyond a centre of curvature.
  /// Then the distance to the nearest facet is set, and its patch; if x or what is near it is not finite, as in an
  /// iterate that Newton rejects, the distance is infinite. `comes_on`: it faced nothing in the last increment.
  ///
  /// If the nearest of all patches has x outside of the solid, x is not inside of it by a farther patch. But outside of
  /// the wall of a block by no more than what is still faced past the end of its sole, x is inside by the sole. This
  /// does not hold for what comes on, as what a block that slides has before it, nor far inside, as beside a wall.
  Facing facing(const Query& query, bool comes_on = false) const {
    const Vec<double, D>& x = query.x;
    Facing found = this->nearest_facing(query);
    const double size = found.patch != no_patch ? this->size(found.patch) : 0, rounded = 0.5 * query.size;
    if (found.patch != no_patch && query.outward != Vec<double, D>::Zero() &&
        this->gap(found, x) < -mesh_file_rounding * size) {
      const Facing nearest = this->nearest_facing({x, Vec<double, D>::Zero(), query.size});
      const double beside = std::max(past_end_of_surface * size, rounded);
      const bool may_be_past = !comes_on && this->gap(found, x) > -std::max(deepest_past_end * size, rounded);
      const bool is_beside =
          may_be_past && nearest.patch != no_patch && !opposes<D>(this->normal(nearest), this->normal(found));
      const bool is_outside =
          nearest.patch == no_patch ? this->is_outside_of_facets(x) : this->gap(nearest, x) >= (is_beside ? beside : 0);
      if (is_outside) found = {};
    }
    if constexpr (D == 2) found = this->settled(found, query);
    if constexpr (D == 3) found = this->at_ends(found, query);
    return found.patch != no_patch ? found : this->facing_nothing(x);
  }
  /// The foot of x on one patch, which is extended past its edges.
  Facing foot_on(int patch, const Query& query) const {
    const Facing foot = this->newton_foot({patch, this->middle_of(patch)}, query.x, 0);
    if constexpr (D == 3) return this->at_ends(foot, query);
    return foot;
  }
};

/// A surface that keeps its shape, and the search along it. Its places are from its first vertex. Not to be copied.
template <int D>
struct StillSurface {
  std::shared_ptr<const Surface<D>> patches;
  Places<D> places;  ///< of the vertices
  SurfaceSearch<D> search;

  /// `positions`: of the vertices. pre: there is one.
  StillSurface(std::shared_ptr<const Surface<D>> of, const Places<D>& positions)
      : patches(std::move(of)), places(positions.colwise() - positions.col(0)), search(*patches, places) {}
  StillSurface(const StillSurface&) = delete;
};

}  // namespace stickslip
