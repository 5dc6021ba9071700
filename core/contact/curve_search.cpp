#include "core/contact/curve_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/search.hpp"

namespace stickslip {
namespace {

/// How far past the free end of a curve a point still faces it, as a share of the length of the last patch. Two sides
/// that end together overlap only roughly. Example: two blocks pressed to 0.7 of their height; the stiffness of a
/// penalty, or the first augmentation, moves the last node off its master and back for ever. Within this share the node
/// stays.
constexpr double past_end_of_curve = 0.01;

/// Two places of a curve touch only where the cosine of the angle between their outward normals is below minus this, at
/// more than 120 degrees: the two sides of a corner never do.
constexpr double least_against = 0.5;

auto place_in(const Eigen::Matrix2Xd& places) {
  return [&places](int vertex) -> Vec<double, 2> { return places.col(vertex); };
}

}  // namespace

CurveSearch::CurveSearch(const std::vector<Patch>& patches, const Eigen::Matrix2Xd& places)
    : patches_(patches), places_(places) {
  if (!places.allFinite()) return;  // of a trial out of bounds
  const int count = static_cast<int>(patches.size());
  boxes_.reserve(count);
  add_boxes(0, count);
  size_ = (boxes_[0].high - boxes_[0].low).norm();
  double longest = 0;
  for (int p = 0; p < count; ++p) longest = std::max(longest, (vertex(p, 1) - vertex(p, 0)).norm());
  band_ = at_facet_end * longest;
  if (!std::isfinite(size_) || !(longest > 0)) boxes_.clear();
}

void CurveSearch::add_boxes(int first, int last) {
  constexpr int leaf = 4;
  const std::size_t at = boxes_.size();
  boxes_.push_back({{}, {}, {}, {}, first, last});
  if (last - first <= leaf) return bound(boxes_[at]);
  const int middle = (first + last) / 2;
  add_boxes(first, middle);
  const auto right = static_cast<int>(boxes_.size());
  add_boxes(middle, last);
  const Box &a = boxes_[at + 1], &b = boxes_[right];
  boxes_[at] = {a.low.cwiseMin(b.low),
                a.high.cwiseMax(b.high),
                a.normal_low.cwiseMin(b.normal_low),
                a.normal_high.cwiseMax(b.normal_high),
                first,
                last,
                right};
}

void CurveSearch::bound(Box& box) const {
  box.low = box.high = vertex(box.first, 0);
  box.normal_low.setConstant(1);
  box.normal_high.setConstant(-1);
  for (int p = box.first; p < box.last; ++p) {
    const Vec<double, 2> a = vertex(p, 0), b = vertex(p, 1), tau = (b - a).normalized();
    box.low = box.low.cwiseMin(a).cwiseMin(b);
    box.high = box.high.cwiseMax(a).cwiseMax(b);
    const bool has_normal = tau.squaredNorm() > 0;  // of a facet without length any will do
    box.normal_low = box.normal_low.cwiseMin(has_normal ? Vec<double, 2>(tau[1], -tau[0]) : Vec<double, 2>(-1, -1));
    box.normal_high = box.normal_high.cwiseMax(has_normal ? Vec<double, 2>(tau[1], -tau[0]) : Vec<double, 2>(1, 1));
  }
}

double CurveSearch::distance(const Box& box, const Vec<double, 2>& x) const {
  return (box.low - x).cwiseMax(x - box.high).cwiseMax(0.0).norm();
}

/// False where no facet of a box counts: by its normal, or because x is too far behind the curve, if that is its own.
bool CurveSearch::may_count(const Box& box, const Sought& sought) const {
  constexpr double rounding = 1e-12;
  const Vec<double, 2>& outward = sought.outward;
  const Vec<double, 2> least =
      (outward.array() * box.normal_low.array()).min(outward.array() * box.normal_high.array());
  if (least.sum() > (rounding - (sought.own ? least_against : 0)) * outward.norm()) return false;
  if (!sought.own) return true;
  double most = 0;  // largest gap of x to a facet of the box
  for (int i = 0; i < 2; ++i) {
    const double near = sought.x[i] - box.low[i], far = sought.x[i] - box.high[i];
    most += std::max(
        {near * box.normal_low[i], near * box.normal_high[i], far * box.normal_low[i], far * box.normal_high[i]});
  }
  return most >= -reach(box.first, box.last, sought) - rounding * size_;
}

/// How far x may be inside of some of the patches first to last - 1 of its own curve: its reach, where one of them is
/// within 8 patches of the one that it faced last; elsewhere a quarter of its reach.
double CurveSearch::reach(int first, int last, const Sought& sought) const {
  constexpr int next_to = 8;
  const int count = static_cast<int>(patches_.size());
  bool was_in_front = false;
  for (const int turn : {-count, 0, count})
    was_in_front |= first <= sought.last + turn + next_to && last > sought.last + turn - next_to;
  return (sought.last != Patch::none && was_in_front ? 1 : 0.25) * sought.own->reach;
}

bool CurveSearch::counts(int patch, const Sought& sought) const {
  const Vec<double, 2> a = vertex(patch, 0), tau = vertex(patch, 1) - a, &outward = sought.outward;
  const double along = outward[0] * tau[1] - outward[1] * tau[0];  // of the normals, times the facet's length
  if (along > 0 || !sought.own) return !(along > 0);
  if (along > -least_against * outward.norm() * tau.norm() || !sought.own->may_face(patches_, patch)) return false;
  const Vec<double, 2> off = sought.x - a;
  const double gap = (off[0] * tau[1] - off[1] * tau[0]) / tau.norm();
  constexpr double beside = 0.5;  // facets: what it is inside of is where it is
  const double xi = off.dot(tau) / tau.squaredNorm();
  if (gap >= 0) return true;
  return gap >= -reach(patch, patch + 1, sought) && xi >= -beside && xi <= 1 + beside;
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
  if (boxes_.empty() || !x.allFinite()) return best;
  const auto visit = [&](const auto& self, int at) -> void {
    const Box& box = boxes_[at];
    if (distance(box, x) > best.distance + band_ || !may_count(box, sought)) return;
    if (box.right == 0) {
      for (int p = box.first; p < box.last; ++p)
        if (counts(p, sought)) try_facet(p, x, best);
      return;
    }
    const bool left_first = distance(boxes_[at + 1], x) <= distance(boxes_[box.right], x);
    self(self, left_first ? at + 1 : box.right);
    self(self, left_first ? box.right : at + 1);
  };
  visit(visit, 0);
  return best;
}

Vec<double, 2> CurveSearch::tangent_at_end(int patch, int end) const {
  const auto w = detail::patch_weights<double>(patches_[patch], end);
  return detail::on_patch<double>(patches_[patch], w.slope, place_in(places_)).normalized();
}

/// The place that a point faces whose foot is beyond the end of a patch: at a corner, or where the patches that count
/// end.
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
    const Vec<double, 2> off = x - detail::on_patch<double>(patch, w.value, place);
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
