#include "core/contact/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stickslip {
namespace {

/// Share of the last patch's length by which a point may lie past the free end of a curve and still face it. Why: two
/// sides that end together overlap only roughly. Example: two blocks pressed to 0.7 of their height; there the
/// compliance of a penalty, or the first augmentation, moves the last node off its master and back for ever.
constexpr double past_end_of_curve = 0.01;

auto position_in(const Eigen::Matrix2Xd& positions) {
  return [&positions](int vertex) -> Vec<double, 2> { return positions.col(vertex); };
}

}  // namespace

CurveSearch::CurveSearch(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& positions)
    : patches_(patches), positions_(positions) {
  if (!positions.allFinite()) return;  // Newton tried an iterate that overflows
  const int count = static_cast<int>(patches.size());
  facets_ = BoxTree<2>(count, [this](int patch) { return bounds(patch); });
  size_ = (facets_.whole().high - facets_.whole().low).norm();
  double longest = 0;
  for (int p = 0; p < count; ++p) longest = std::max(longest, (vertex(p, 1) - vertex(p, 0)).norm());
  band_ = at_facet_end * longest;
  if (!std::isfinite(size_) || !(longest > 0)) facets_ = {};
}

/// A facet of zero length has any normal.
Bounds<2> CurveSearch::bounds(int patch) const {
  const Vec<double, 2> a = vertex(patch, 0), b = vertex(patch, 1), tau = (b - a).normalized();
  Bounds<2> facet{a.cwiseMin(b), a.cwiseMax(b)};
  if (tau.squaredNorm() > 0) facet.normal_low = facet.normal_high = Vec<double, 2>(tau[1], -tau[0]);
  return facet;
}

/// False if no facet of the box is eligible, apart from those near the last one: its normals do not oppose `outward`,
/// or, in contact of the curve with itself, x is too deep inside of the solid.
bool CurveSearch::may_be_eligible(const Bounds<2>& box, const Query& query) const {
  constexpr double rounding = 1e-12;
  const Vec<double, 2>& outward = query.outward;
  const Vec<double, 2> least =
      (outward.array() * box.normal_low.array()).min(outward.array() * box.normal_high.array());
  if (least.sum() > (rounding - (query.own ? least_against : 0)) * outward.norm()) return false;
  if (!query.own) return true;
  double most = 0;  // upper bound of the gap of x to the facets of the box
  for (int i = 0; i < 2; ++i) {
    const double near = query.x[i] - box.low[i], far = query.x[i] - box.high[i];
    most += std::max(
        {near * box.normal_low[i], near * box.normal_high[i], far * box.normal_low[i], far * box.normal_high[i]});
  }
  return most >= -OwnVertex::share_of_depth * query.own->max_depth - rounding * size_;
}

bool CurveSearch::is_eligible(int patch, const Query& query) const {
  const Vec<double, 2> a = vertex(patch, 0), tau = vertex(patch, 1) - a, &outward = query.outward;
  const double along = outward[0] * tau[1] - outward[1] * tau[0];  // facet length x outward . facet normal
  if (along > 0 || !query.own) return !(along > 0);
  if (along > -least_against * outward.norm() * tau.norm() || !query.own->may_face(patches_, patch)) return false;
  const Vec<double, 2> off = query.x - a;
  const double gap = (off[0] * tau[1] - off[1] * tau[0]) / tau.norm();
  if (gap >= 0) return true;
  return gap >= -query.own->depth_in(patch, query.last) && is_beside_facet(off.dot(tau) / tau.squaredNorm());
}

void CurveSearch::compare_facet(int patch, const Vec<double, 2>& x, Nearest& best) const {
  const Vec<double, 2> a = vertex(patch, 0), b = vertex(patch, 1);
  const auto [xi, distance] = nearest_of_facet(a, b, x);
  const double band = at_facet_end * (b - a).norm();
  if (distance > best.distance + band) return;
  if (distance > best.distance - band) {  // a tie: x projects into it, then least x, then least y
    const bool inside = xi >= 0 && xi <= 1, other = best.xi >= 0 && best.xi <= 1;
    const Vec<double, 2> first = vertex(best.patch, 0);
    if (inside == other ? a[0] > first[0] || (a[0] == first[0] && a[1] >= first[1]) : other) return;
  }
  best = {patch, xi, distance};
}

CurveSearch::Nearest CurveSearch::nearest_facet(const Query& query) const {
  Nearest best;
  if (facets_.empty() || !query.x.allFinite()) return best;
  const auto compare = [&](int patch) {
    if (is_eligible(patch, query)) compare_facet(patch, query.x, best);
  };
  const int count = static_cast<int>(patches_.size());
  for (int k = -OwnVertex::neighbourhood; query.last != Patch::none && k <= OwnVertex::neighbourhood; ++k)
    compare(((query.last + k) % count + count) % count);
  const auto skips = [&](const Bounds<2>& box) {
    return box.distance(query.x) > best.distance + band_ || !may_be_eligible(box, query);
  };
  facets_.visit(query.x, skips, compare);
  return best;
}

Vec<double, 2> CurveSearch::tangent_at_end(int patch, int end) const {
  const auto w = detail::patch_weights<double>(patches_[patch], end);
  return detail::on_patch<double>(patches_[patch], w.slope, position_in(positions_)).normalized();
}

/// The place that x faces if its foot lies past an end of a patch: at a corner, or where the eligible patches end.
Facing CurveSearch::end_facing(Facing at, const Query& query) const {
  const Vec<double, 2>& x = query.x;
  const Patch& patch = patches_[at.patch];
  const int end = at.xi > 1 ? 1 : 0, other = end == 1 ? patch.next : patch.previous;
  if (other == Patch::none || !is_eligible(other, query))
    return (end == 1 ? at.xi - 1 : -at.xi) > past_end_of_curve ? Facing{} : at;
  const Vec<double, 2> along = tangent_at_end(at.patch, end) + tangent_at_end(other, 1 - end);
  const double side = (x - vertex(at.patch, end)).dot(along);
  if (end == 1 ? side <= 0 : side >= 0) return at;
  return {other, foot_on_patch<double>(patches_[other], 1 - end, x, position_in(positions_)).xi()};
}

/// Newton's method for the foot of x, from the start value `at`. It may pass to the next patch, `hops` times at most,
/// where the two patches join without a corner.
Facing CurveSearch::newton_foot(Facing at, const Vec<double, 2>& x, int hops) const {
  constexpr int most = 50;
  constexpr double longest = 0.5;
  const auto place = position_in(positions_);
  const int all = hops;
  for (int step = 0; step < most; ++step) {
    const Patch& patch = patches_[at.patch];
    const auto w = detail::patch_weights<double>(patch, at.xi);
    const Vec<double, 2> slope = detail::on_patch<double>(patch, w.slope, place);
    const Vec<double, 2> bend = detail::on_patch<double>(patch, w.bend, place);
    const auto start = [&](int vertex) { return at_start<double>(place(vertex)); };
    const Vec<double, 2> off = detail::off_place<double, double>(patch, w.value, at_start(x),
                                                                 detail::vertices_of<double, double>(patch, start));
    const double metric = slope.squaredNorm(), falls = metric - off.dot(bend);
    if (!(falls > 1e-8 * metric)) return {};  // x is at or beyond the centre of curvature
    const double whole = off.dot(slope) / falls;
    const double move = patch.smoothing == Smoothing::none ? whole : std::clamp(whole, -longest, longest);
    at.xi += move;
    const bool settled = std::abs(move) <= 1e-9;
    // A converged foot at the vertex of two patches stays, so that it does not alternate between them.
    const bool before = at.xi < 0 && patch.goes_on_before(), after = at.xi > 1 && patch.goes_on_after();
    if ((before || after) && hops > 0 && !(settled && hops < all)) {
      at = before ? Facing{patch.previous, 1 + at.xi} : Facing{patch.next, at.xi - 1};
      --hops;
      continue;
    }
    if (settled) return at;
  }
  return {};
}

Facing CurveSearch::nearest_facing(const Query& query) const {
  const Vec<double, 2>& x = query.x;
  const Nearest nearest = nearest_facet(query);
  if (nearest.patch == Patch::none) return {};
  Facing at{nearest.patch, nearest.xi};
  if (patches_[at.patch].smoothing != Smoothing::none) {
    at.xi = std::clamp(at.xi, 0.0, 1.0);
    at = newton_foot(at, x, 8);
    if (at.patch == Patch::none) return at;
  }
  const Patch& patch = patches_[at.patch];
  const bool ends = (at.xi < 0 && !patch.goes_on_before()) || (at.xi > 1 && !patch.goes_on_after());
  return ends ? end_facing(at, query) : at;
}

Facing CurveSearch::foot_on(int patch, const Vec<double, 2>& x) const { return newton_foot({patch, 0.5}, x, 0); }

Facing CurveSearch::facing(const Vec<double, 2>& x, const Vec<double, 2>& outward) const {
  Facing at = nearest_facing({x, outward});
  const auto is_inside = [&](const Facing& facing) {
    return foot_on_patch<double>(patches_[facing.patch], facing.xi, x, position_in(positions_)).gap < 0;
  };
  if (at.patch != Patch::none && outward != Vec<double, 2>::Zero() && is_inside(at)) {
    // Where x is outside of the solid by the nearest face, it penetrates no face farther away.
    const Facing nearest = nearest_facing({x, Vec<double, 2>::Zero()});
    if (nearest.patch != Patch::none && !is_inside(nearest)) at = {};
  }
  at = second_patch_facing(at, {x, outward});
  if (at.patch == Patch::none) {
    const Nearest nearest = nearest_facet({x, Vec<double, 2>::Zero()});
    at.distance = nearest.distance;
    at.nearest = nearest.patch;
  }
  return at;
}

Facing CurveSearch::facing_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own,
                                  int last) const {
  const Query query{x, outward, &own, last};
  const Facing at = second_patch_facing(nearest_facing(query), query);  // (Newton may have left the eligible patch)
  if (at.patch != Patch::none && is_eligible(at.patch, query)) return at;
  return {Patch::none, 0, size_};
}

int CurveSearch::nearest_of_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own,
                                   int last) const {
  const int eligible = nearest_facet({x, outward, &own, last}).patch;
  return eligible != Patch::none ? eligible : nearest_facet({x, Vec<double, 2>::Zero(), &own, last}).patch;
}

/// If x faces the vertex of two eligible patches, the place on the second. So rounding does not choose between them.
Facing CurveSearch::second_patch_facing(Facing at, const Query& query) const {
  if (at.patch == Patch::none || std::abs(at.xi - 1) >= at_facet_end) return at;
  const int second = patches_[at.patch].next;
  if (second == Patch::none || !is_eligible(second, query)) return at;
  const Facing next = newton_foot({second, 0.0}, query.x, 0);
  return next.patch != Patch::none && std::abs(next.xi) < at_facet_end ? next : at;
}

}  // namespace stickslip
