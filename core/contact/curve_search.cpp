#include "core/contact/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/search.hpp"

namespace stickslip {
namespace {

/// How far past the free end of a curve a point still faces it, of the length of the last patch. Two sides that end
/// together do so only as well as their overlap lets them: of two blocks pressed to 0.7 of their height, the stiffness
/// of a penalty, or the first augmentation, moves the last node off its master and back for ever. Here it may.
constexpr double past_end_of_curve = 0.01;

auto place_in(const Eigen::Matrix2Xd& places) {
  return [&places](int vertex) -> Vec<double, 2> { return places.col(vertex); };
}

}  // namespace

CurveSearch::CurveSearch(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& places)
    : patches_(patches), places_(places) {
  const int count = static_cast<int>(patches.size());
  Vec<double, 2> low = vertex(0, 0), high = low;
  double length = 0;
  for (int p = 0; p < count; ++p) {
    for (int end : {0, 1}) {
      low = low.cwiseMin(vertex(p, end));
      high = high.cwiseMax(vertex(p, end));
    }
    length += (vertex(p, 1) - vertex(p, 0)).norm() / count;
  }
  const Vec<double, 2> size = high - low;
  if (!places.allFinite() || !size.allFinite() || !(length > 0)) return;  // of a trial out of bounds: no cells
  size_ = size.norm();
  // cells about as large as the facets, and no more than four times as many
  corner_ = low;
  cell_ = std::max({length, std::sqrt(size[0] * size[1] / (4.0 * count)), size.maxCoeff() / (4.0 * count)});
  for (int i = 0; i < 2; ++i) cells_[i] = 1 + static_cast<int>(size[i] / cell_);
  const auto cell_of = [&](double x, int i) {
    return std::clamp(static_cast<int>((x - corner_[i]) / cell_), 0, cells_[i] - 1);
  };
  const auto for_each_cell = [&](int p, auto&& f) {
    const Vec<double, 2> a = vertex(p, 0), b = vertex(p, 1);
    for (int j = cell_of(std::min(a[1], b[1]), 1); j <= cell_of(std::max(a[1], b[1]), 1); ++j)
      for (int i = cell_of(std::min(a[0], b[0]), 0); i <= cell_of(std::max(a[0], b[0]), 0); ++i) f(j * cells_[0] + i);
  };
  start_.assign(static_cast<std::size_t>(cells_[0]) * cells_[1] + 1, 0);
  for (int p = 0; p < count; ++p) for_each_cell(p, [&](int cell) { ++start_[cell + 1]; });
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  in_cell_.resize(start_.back());
  auto next = start_;
  for (int p = 0; p < count; ++p) for_each_cell(p, [&](int cell) { in_cell_[next[cell]++] = p; });
}

bool CurveSearch::counts(int patch, const Sought& sought) const {
  const Vec<double, 2> a = vertex(patch, 0), tau = vertex(patch, 1) - a, &outward = sought.outward;
  const double along = outward[0] * tau[1] - outward[1] * tau[0];  // of the normals, times the facet's length
  if (along > 0 || !sought.own) return !(along > 0);
  constexpr double least_against = 0.5;  // cosine: the sides of a corner never touch each other
  if (along > -least_against * outward.norm() * tau.norm() || !sought.own->may_face(patches_, patch)) return false;
  const Vec<double, 2> off = sought.x - a;
  const double gap = (off[0] * tau[1] - off[1] * tau[0]) / tau.norm();
  constexpr double beside = 0.5;  // facets: what it is inside of is where it is
  const double xi = off.dot(tau) / tau.squaredNorm();
  if (gap >= 0) return true;
  constexpr int next_to = 8;
  const int count = static_cast<int>(patches_.size()), apart = std::abs(patch - sought.last);
  const bool was_in_front = sought.last != Patch::none && std::min(apart, count - apart) <= next_to;
  const double reach = (was_in_front ? 1 : 0.25) * sought.own->reach;
  return gap >= -reach && xi >= -beside && xi <= 1 + beside;
}

void CurveSearch::try_facet(int patch, const Vec<double, 2>& x, Nearest& best) const {
  const Vec<double, 2> a = vertex(patch, 0), tau = vertex(patch, 1) - a;
  const double xi = (x - a).dot(tau) / tau.squaredNorm();
  const double distance = (x - a - std::clamp(xi, 0.0, 1.0) * tau).norm();
  const double band = at_facet_end * tau.norm();
  if (distance > best.distance + band) return;
  if (distance > best.distance - band) {  // as near as the other: the one that x projects into, then by place
    const bool inside = xi >= 0 && xi <= 1, other = best.xi >= 0 && best.xi <= 1;
    const Vec<double, 2> b = vertex(best.patch, 0);
    if (inside == other ? a[0] > b[0] || (a[0] == b[0] && a[1] >= b[1]) : other) return;
  }
  best = {patch, xi, distance};
}

CurveSearch::Nearest CurveSearch::nearest_facet(const Sought& sought) const {
  const Vec<double, 2>& x = sought.x;
  Nearest best;
  if (start_.empty() || !x.allFinite()) return best;
  std::array<int, 2> at;
  for (int i = 0; i < 2; ++i)
    at[i] = static_cast<int>(std::clamp((x[i] - corner_[i]) / cell_, 0.0, static_cast<double>(cells_[i] - 1)));
  const auto try_cell = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= cells_[0] || j >= cells_[1]) return;
    const int cell = j * cells_[0] + i;
    for (int k = start_[cell]; k < start_[cell + 1]; ++k)
      if (counts(in_cell_[k], sought)) try_facet(in_cell_[k], x, best);
  };
  const int most = std::max(cells_[0], cells_[1]);
  for (int ring = 0; ring <= most; ++ring) {
    for (int i = at[0] - ring; i <= at[0] + ring; ++i)
      for (int j : {at[1] - ring, at[1] + ring}) {
        try_cell(i, j);
        if (ring == 0) break;
      }
    for (int j = at[1] - ring + 1; j < at[1] + ring; ++j)
      for (int i : {at[0] - ring, at[0] + ring}) try_cell(i, j);
    double beyond = std::numeric_limits<double>::infinity();  // nothing that is left is nearer
    for (int i = 0; i < 2; ++i) {
      if (at[i] - ring > 0) beyond = std::min(beyond, x[i] - (corner_[i] + (at[i] - ring) * cell_));
      if (at[i] + ring + 1 < cells_[i]) beyond = std::min(beyond, corner_[i] + (at[i] + ring + 1) * cell_ - x[i]);
    }
    if (best.distance < beyond) break;
  }
  return best;
}

Vec<double, 2> CurveSearch::tangent_at_end(int patch, int end) const {
  const auto w = detail::patch_weights<double>(patches_[patch], end);
  return detail::on_patch<double>(patches_[patch], w.slope, place_in(places_)).normalized();
}

/// The place faced by a point whose foot is beyond the end of a patch at a corner, or where what counts of the curve
/// ends.
Facing CurveSearch::at_end(Facing at, const Sought& sought) const {
  const Vec<double, 2>& x = sought.x;
  const Patch& patch = patches_[at.patch];
  const int end = at.xi > 1 ? 1 : 0, other = end == 1 ? patch.next : patch.previous;
  if (other == Patch::none || !counts(other, sought))
    return (end == 1 ? at.xi - 1 : -at.xi) > past_end_of_curve ? Facing{} : at;
  const Vec<double, 2> along = tangent_at_end(at.patch, end) + tangent_at_end(other, 1 - end);
  const double side = (x - vertex(at.patch, end)).dot(along);
  if (end == 1 ? side <= 0 : side >= 0) return at;
  return {other, foot_on_patch<double>(patches_[other], 1 - end, x, place_in(places_)).xi};
}

/// Newton's method for the foot on smooth patches, from one to the next where they go on, `hops` times at most.
Facing CurveSearch::slide(Facing at, const Vec<double, 2>& x, int hops) const {
  constexpr int most = 50;
  constexpr double longest = 0.5;
  const auto place = place_in(places_);
  const int all = hops;
  for (int step = 0; step < most; ++step) {
    const Patch& patch = patches_[at.patch];
    const auto w = detail::patch_weights<double>(patch, at.xi);
    const Vec<double, 2> slope = detail::on_patch<double>(patch, w.slope, place);
    const Vec<double, 2> bend = detail::on_patch<double>(patch, w.bend, place);
    const Vec<double, 2> off = x - detail::on_patch<double>(patch, w.at, place);
    const double metric = slope.squaredNorm(), falls = metric - off.dot(bend);
    if (!(falls > 1e-8 * metric)) return {};  // the centre of the bend, or past it
    const double whole = off.dot(slope) / falls;
    const double move = patch.smoothing == Smoothing::none ? whole : std::clamp(whole, -longest, longest);
    at.xi += move;
    const bool settled = std::abs(move) <= 1e-9;
    // From patch to patch, but not to and fro between two that meet where the foot is.
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

Facing CurveSearch::faced(const Sought& sought) const {
  const Vec<double, 2>& x = sought.x;
  const Nearest nearest = nearest_facet(sought);
  if (nearest.patch == Patch::none) return {};
  Facing at{nearest.patch, nearest.xi};
  if (patches_[at.patch].smoothing != Smoothing::none) {
    at.xi = std::clamp(at.xi, 0.0, 1.0);
    at = slide(at, x, 8);
    if (at.patch == Patch::none) return at;
  }
  const Patch& patch = patches_[at.patch];
  const bool ends = (at.xi < 0 && !patch.goes_on_before()) || (at.xi > 1 && !patch.goes_on_after());
  return ends ? at_end(at, sought) : at;
}

Facing CurveSearch::stay(int patch, const Vec<double, 2>& x) const { return slide({patch, 0.5}, x, 0); }

Facing CurveSearch::facing(const Vec<double, 2>& x, const Vec<double, 2>& outward) const {
  Facing at = faced({x, outward});
  const auto is_inside = [&](const Facing& facing) {
    return foot_on_patch<double>(patches_[facing.patch], facing.xi, x, place_in(places_)).gap < 0;
  };
  if (at.patch != Patch::none && outward != Vec<double, 2>::Zero() && is_inside(at)) {
    const Facing nearest = faced({x, Vec<double, 2>::Zero()});  // of a face beyond the solid that x is outside of
    if (nearest.patch != Patch::none && !is_inside(nearest)) at = {};
  }
  at = in_second_patch(at, {x, outward});
  if (at.patch == Patch::none) at.distance = nearest_facet({x, Vec<double, 2>::Zero()}).distance;
  return at;
}

Facing CurveSearch::facing_itself(const Vec<double, 2>& x, const Vec<double, 2>& outward, const OwnVertex& own,
                                  int last) const {
  const Sought sought{x, outward, &own, last};
  const Facing at = in_second_patch(faced(sought), sought);  // (may have slid from a patch that counts)
  if (at.patch != Patch::none && counts(at.patch, sought)) return at;
  return {Patch::none, 0, size_};
}

/// Where two patches that count meet, the place on the second, so that rounding does not tell the two apart.
Facing CurveSearch::in_second_patch(Facing at, const Sought& sought) const {
  if (at.patch == Patch::none || std::abs(at.xi - 1) >= at_facet_end) return at;
  const int second = patches_[at.patch].next;
  if (second == Patch::none || !counts(second, sought)) return at;
  const Facing next = slide({second, 0.0}, sought.x, 0);
  return next.patch != Patch::none && std::abs(next.xi) < at_facet_end ? next : at;
}

}  // namespace stickslip
