#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/facet_search.hpp"
#include "core/contact/foot_in_plane.hpp"
#include "core/contact/surface_search.hpp"

namespace stickslip {
namespace {

auto position_in(const Places<2>& positions) {
  return [&positions](int vertex) -> Vec<double, 2> { return positions.col(vertex); };
}

}  // namespace

PatchSearch<2>::PatchSearch(const Surface<2>& patches, const Places<2>& positions)
    : patches_(patches), positions_(positions) {
  if (!positions.allFinite()) return;  // Newton tried an iterate that overflows
  const int count = static_cast<int>(patches.size());
  facets_ = BoxTree<2>(count, [this](int patch) {  // a facet of zero length has any normal
    const Vec<double, 2> a = vertex(patch, 0), b = vertex(patch, 1), tau = (b - a).normalized();
    Bounds<2> facet{a.cwiseMin(b), a.cwiseMax(b)};
    if (tau.squaredNorm() > 0) facet.normal_low = facet.normal_high = Vec<double, 2>(tau[1], -tau[0]);
    return facet;
  });
  size_ = (facets_.whole().high - facets_.whole().low).norm();
  double longest = 0;
  for (int p = 0; p < count; ++p) longest = std::max(longest, (vertex(p, 1) - vertex(p, 0)).norm());
  band_ = at_facet_end * longest;
  if (!std::isfinite(size_) || !(longest > 0)) facets_ = {};
}

/// False if no facet of the box is eligible, apart from those near the last one: its normals do not oppose `outward`,
/// or, in contact of the curve with itself, x is too deep inside of the solid.
bool PatchSearch<2>::may_be_eligible(const Bounds<2>& box, const Query& query) const {
  constexpr double rounding = 1e-12;
  const Vec<double, 2>& outward = query.outward;
  const Vec<double, 2> least =
      (outward.array() * box.normal_low.array()).min(outward.array() * box.normal_high.array());
  if (least.sum() > (rounding - query.least_against()) * outward.norm()) return false;
  if (!query.own) return true;
  double most = 0;  // upper bound of the gap of x to the facets of the box
  for (int i = 0; i < 2; ++i) {
    const double near = query.x[i] - box.low[i], far = query.x[i] - box.high[i];
    most += std::max(
        {near * box.normal_low[i], near * box.normal_high[i], far * box.normal_low[i], far * box.normal_high[i]});
  }
  return most >= -OwnVertex::share_of_depth * query.own->max_depth - rounding * size_;
}

bool PatchSearch<2>::is_eligible(int patch, const Query& query) const {
  const Vec<double, 2> a = vertex(patch, 0), tau = vertex(patch, 1) - a, &outward = query.outward;
  const double along = outward[0] * tau[1] - outward[1] * tau[0];  // facet length x outward . facet normal
  if (along > -query.least_against() * outward.norm() * tau.norm()) return false;
  if (!query.own) return true;
  if (!query.own->may_face(patches_, patch)) return false;
  const Vec<double, 2> off = query.x - a;
  const double gap = (off[0] * tau[1] - off[1] * tau[0]) / tau.norm();
  if (gap >= 0) return true;
  return gap >= -query.own->depth_in(patch, query.last) && is_beside_facet(off.dot(tau) / tau.squaredNorm());
}

void PatchSearch<2>::compare_facet(int patch, const Vec<double, 2>& x, Nearest& best) const {
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

PatchSearch<2>::Nearest PatchSearch<2>::nearest_facet(const Query& query) const {
  Nearest best;
  if (facets_.empty() || !query.x.allFinite()) return best;
  const auto compare = [&](int patch) {
    if (is_eligible(patch, query)) compare_facet(patch, query.x, best);
  };
  const int count = static_cast<int>(patches_.size());
  for (int k = -OwnVertex::neighbourhood; query.last != no_patch && k <= OwnVertex::neighbourhood; ++k)
    compare(((query.last + k) % count + count) % count);
  const auto skips = [&](const Bounds<2>& box) {
    return box.distance(query.x) > best.distance + band_ || !may_be_eligible(box, query);
  };
  facets_.visit(query.x, skips, compare);
  return best;
}

Vec<double, 2> PatchSearch<2>::tangent_at_end(int patch, int end) const {
  const auto w = detail::patch_weights<double>(patches_[patch], end);
  return detail::on_patch<double>(patches_[patch], w.slope, position_in(positions_)).normalized();
}

/// The place that x faces if its foot lies past an end of a patch: at a corner, or where the eligible patches end.
Facing PatchSearch<2>::past_end(const Facing& foot, const Query& query) const {
  const Vec<double, 2>& x = query.x;
  const Patch<2>& patch = patches_[foot.patch];
  const int end = foot.at[0] > 1 ? 1 : 0, other = patch.across[end];
  if (other == no_patch || !is_eligible(other, query))
    return beyond_edge(patch, end, foot.at) > past_end_of_surface ? Facing{} : foot;
  const Vec<double, 2> along = tangent_at_end(foot.patch, end) + tangent_at_end(other, 1 - end);
  const double side = (x - vertex(foot.patch, end)).dot(along);
  if (end == 1 ? side <= 0 : side >= 0) return foot;
  const Vec<double, 2> joint(1 - end, 0);
  return {other, {foot_on_patch<double>(patches_[other], joint, x, position_in(positions_)).place.coordinate(), 0}};
}

/// Newton's method for the foot of x, from the start value `from`. It may pass to the next patch, `hops` times at most,
/// where the two patches join without a corner. patch = none if it does not end, or ends past the patch where it has no
/// hop left; or if x is beyond a centre of curvature.
Facing PatchSearch<2>::newton_foot(Facing from, const Vec<double, 2>& x, int hops) const {
  constexpr int most = 50;
  constexpr double longest = 0.5;
  const auto place = position_in(positions_);
  const int all = hops;
  int at = from.patch;
  double xi = from.at[0];
  for (int step = 0; step < most; ++step) {
    const Patch<2>& patch = patches_[at];
    const auto w = detail::patch_weights<double>(patch, xi);
    const Vec<double, 2> slope = detail::on_patch<double>(patch, w.slope, place);
    const Vec<double, 2> bend = detail::on_patch<double>(patch, w.bend, place);
    const auto start = [&](int vertex) { return at_start<double>(place(vertex)); };
    const Vec<double, 2> off = detail::off_place<double, double>(patch, w.value, at_start(x),
                                                                 detail::vertices_of<double, double>(patch, start));
    const double metric = slope.squaredNorm(), falls = metric - off.dot(bend);
    // At the foot: x is nearer than the centre of curvature. Before it, `off` has a part along the curve, and where the
    // slope grows fast along it, as behind a short facet, `falls` says nothing. Then the step leaves `bend` out.
    const bool is_minimum = falls > 1e-8 * metric;
    const double whole = off.dot(slope) / (is_minimum ? falls : metric);
    const double move = patch.is_smooth() ? std::clamp(whole, -longest, longest) : whole;
    xi += move;
    const bool settled = std::abs(move) <= 1e-9;
    // A converged foot at the vertex of two patches stays, so that it does not alternate between them.
    const bool before = xi < 0 && patch.goes_on(0), after = xi > 1 && patch.goes_on(1);
    if ((before || after) && hops > 0 && !(settled && hops < all)) {
      at = patch.across[after];
      xi = before ? 1 + xi : xi - 1;
      --hops;
      continue;
    }
    if (!settled) continue;
    if (!is_minimum) return {};
    const Facing foot{at, {xi, 0}};
    return all > 0 && is_past_joint<2>(patch, foot.at, past_end_of_surface) ? Facing{} : foot;
  }
  return {};
}

Facing PatchSearch<2>::nearest_facing(const Query& query) const {
  const Vec<double, 2>& x = query.x;
  const Nearest nearest = nearest_facet(query);
  if (nearest.patch == no_patch) return {};
  Facing foot{nearest.patch, {nearest.xi, 0}};
  if (patches_[foot.patch].is_smooth()) {
    foot.at[0] = std::clamp(nearest.xi, 0.0, 1.0);
    foot = newton_foot(foot, x, 8);
    if (foot.patch == no_patch) return foot;
  }
  const Patch<2>& patch = patches_[foot.patch];
  const bool ends = (foot.at[0] < 0 && !patch.goes_on(0)) || (foot.at[0] > 1 && !patch.goes_on(1));
  return ends ? past_end(foot, query) : foot;
}

double PatchSearch<2>::gap(const Facing& foot, const Vec<double, 2>& x) const {
  return foot_on_patch<double>(patches_[foot.patch], foot.at, x, position_in(positions_)).gap;
}

/// Whether x is outside of the facet that it is nearest to; past a free end it is not. Beyond a centre of curvature a
/// patch has no foot.
bool PatchSearch<2>::is_outside_of_facets(const Vec<double, 2>& x) const {
  const Nearest near = nearest_facet({x, Vec<double, 2>::Zero()});
  if (near.patch == no_patch) return false;
  const auto& across = patches_[near.patch].across;
  if ((near.xi < 0 && across[0] == no_patch) || (near.xi > 1 && across[1] == no_patch)) return false;
  const Vec<double, 2> off = x - vertex(near.patch, 0), tau = vertex(near.patch, 1) - vertex(near.patch, 0);
  return off[0] * tau[1] > off[1] * tau[0];
}

/// Normal of a patch at a foot, of any length.
Vec<double, 2> PatchSearch<2>::normal(const Facing& foot) const {
  const auto w = detail::patch_weights<double>(patches_[foot.patch], foot.at[0]);
  const Vec<double, 2> slope = detail::on_patch<double>(patches_[foot.patch], w.slope, position_in(positions_));
  return {slope[1], -slope[0]};
}

Facing PatchSearch<2>::facing_nothing(const Vec<double, 2>& x) const {
  const Nearest nearest = nearest_facet({x, Vec<double, 2>::Zero()});
  return {.distance = nearest.distance, .nearest = nearest.patch};
}

Facing PatchSearch<2>::facing_itself(const Query& query) const {
  const Facing foot = settled(nearest_facing(query), query);
  // Newton's method may have left the eligible patches.
  if (foot.patch != no_patch && is_eligible(foot.patch, query)) return foot;
  return {.distance = size_};
}

int PatchSearch<2>::nearest_of_itself(const Query& query) const {
  const int eligible = nearest_facet(query).patch;
  if (eligible != no_patch) return eligible;
  Query any = query;
  any.outward.setZero();
  return nearest_facet(any).patch;
}

/// If x faces the vertex of two eligible patches, the place on the second. So rounding does not choose between them.
Facing PatchSearch<2>::settled(const Facing& foot, const Query& query) const {
  if (foot.patch == no_patch || std::abs(foot.at[0] - 1) >= at_facet_end) return foot;
  const int second = patches_[foot.patch].across[1];
  if (second == no_patch || !is_eligible(second, query)) return foot;
  const Facing next = newton_foot({second}, query.x, 0);
  return next.patch != no_patch && std::abs(next.at[0]) < at_facet_end ? next : foot;
}

}  // namespace stickslip
