#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/contact/foot_in_space.hpp"
#include "core/contact/surface_search.hpp"

namespace stickslip {
namespace {

/// Share of an edge at which a place near it is.
double along_edge(int corners, int edge, const Vec<double, 2>& at) {
  const Vec<double, 2> from = face_corner(corners, edge), way = face_corner(corners, edge + 1) - from;
  return std::clamp((at - from).dot(way) / way.squaredNorm(), 0.0, 1.0);
}

std::vector<FacePlace> faces_of(const Surface<3>& patches) {
  std::vector<FacePlace> faces;
  for (const auto& patch : patches) faces.push_back(face_of(patch));
  return faces;
}

std::vector<std::array<char, 4>> borders_of(const Surface<3>& patches) {
  std::vector<std::array<char, 4>> borders;
  for (const auto& patch : patches) {
    auto& border = borders.emplace_back();
    for (int k = 0; k < patch.corners; ++k) border[k] = patch.across[k] == no_patch;
  }
  return borders;
}

/// The place of an edge at a share of it, from its first corner.
Facing facing_on_edge(const Surface<3>& patches, int patch, int edge, double share) {
  const int corners = patches[patch].corners;
  const Vec<double, 2> from = face_corner(corners, edge), to = face_corner(corners, edge + 1);
  return {patch, from + share * (to - from)};
}

}  // namespace

std::vector<Facing> patches_at(const Surface<3>& patches, Facing facing, double within) {
  const auto is_on = [&](const Facing& at, int k) {
    return std::abs(beyond_edge(patches[at.patch], k, at.at)) <= within;
  };
  const auto share_of = [&](const Facing& at, int k) {  // at a corner all of it
    const double share = along_edge(patches[at.patch].corners, k, at.at);
    return share <= within ? 0 : share >= 1 - within ? 1 : share;
  };
  for (int k = 0; k < patches[facing.patch].corners; ++k)
    if (is_on(facing, k)) facing = facing_on_edge(patches, facing.patch, k, share_of(facing, k));
  std::vector<Facing> all{facing};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Facing at = all[i];
    for (int k = 0; k < patches[at.patch].corners; ++k) {
      const int next = patches[at.patch].across[k];
      if (next == no_patch || !is_on(at, k)) continue;
      if (std::any_of(all.begin(), all.end(), [&](const Facing& other) { return other.patch == next; })) continue;
      all.push_back(facing_on_edge(patches, next, patches[at.patch].across_edge[k], 1 - share_of(at, k)));
    }
  }
  return all;
}

std::array<Facing, 2> places_on_edge(const Surface<3>& patches, const Facing& facing, int edge) {
  const Patch<3>& patch = patches[facing.patch];
  const double share = along_edge(patch.corners, edge, facing.at);
  return {facing_on_edge(patches, facing.patch, edge, share),
          facing_on_edge(patches, patch.across[edge], patch.across_edge[edge], 1 - share)};
}

PatchSearch<3>::PatchSearch(const Surface<3>& patches, const Places<3>& positions)
    : patches_(patches), positions_(positions), faces_(positions, faces_of(patches), borders_of(patches)) {}

/// Vectors from x to the vertices of a patch.
Eigen::Matrix3Xd PatchSearch<3>::arms(int patch, const Vec<double, 3>& x) const {
  const auto& vertices = patches_[patch].vertices;
  Eigen::Matrix3Xd arms(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    arms.col(static_cast<Eigen::Index>(i)) = positions_.col(vertices[i]) - x;
  return arms;
}

double PatchSearch<3>::gap(const Facing& at, const Vec<double, 3>& x) const {
  const Eigen::Matrix3Xd y = arms(at.patch, x) * curved_weights(patches_[at.patch], at.at).leftCols<3>();
  return -y.col(0).dot(cross<double>(y.col(1), y.col(2)).normalized());
}

/// Whether x is outside of a facet that it is nearest to. Far past its edges a patch has no foot.
bool PatchSearch<3>::is_outside_of_facets(const Vec<double, 3>& x) const {
  const auto near = faces_.nearest(x, [](int) { return true; });
  return std::any_of(near.begin(), near.end(),
                     [&](const Near& at) { return across(at.face).dot(x - at.position) > 0; });
}

/// Area vector of the facet of a patch.
Vec<double, 3> PatchSearch<3>::across(int patch) const {
  return area_vector<double>(patches_[patch].corners,
                             [&](int k) -> Vec<double, 3> { return positions_.col(patches_[patch].vertices[k]); });
}

/// Normal of a patch at a foot, of any length.
Vec<double, 3> PatchSearch<3>::normal(const Facing& at) const {
  const Eigen::Matrix3Xd y =
      arms(at.patch, Vec<double, 3>::Zero()) * curved_weights(patches_[at.patch], at.at).middleCols<2>(1);
  return cross<double>(y.col(0), y.col(1));
}

/// Newton's method for the foot of x, from the start value `at`. It may pass to the next patch, `hops` times at most,
/// where the two patches join smoothly. patch = none if it does not end, or ends past the patch where it has no hop
/// left; or if x is beyond a centre of curvature.
Facing PatchSearch<3>::newton_foot(Facing at, const Vec<double, 3>& x, int hops) const {
  constexpr int most = 50;
  constexpr double longest = 0.5, settled = 1e-10, farthest = 1;
  const bool passes = hops > 0;
  for (int step = 0; step < most; ++step) {
    const Patch<3>& patch = patches_[at.patch];
    const Vec<double, 2> from = at.at;
    const CurvedWeights weights = curved_weights(patch, from);
    const Eigen::Matrix3Xd around = arms(at.patch, x);
    const Eigen::Matrix3Xd y = around * weights.leftCols<3>();
    const Vec<double, 3> off = -y.col(0);
    const Mat<double, 2> metric = y.rightCols<2>().transpose() * y.rightCols<2>();
    Mat<double, 2> slope = foot_slope(weights.middleCols<5>(1), around, off);
    // Of slope as it was: 1 over that of the inverse.
    const double determinant = slope.determinant() * metric.determinant();
    const bool is_minimum = determinant > 0 && slope.trace() > 0 && determinant < 1e8;
    if (!is_minimum) slope = foot_slope(weights.middleCols<5>(1), around, Vec<double, 3>::Zero());
    Vec<double, 2> move = slope * Vec<double, 2>(off.dot(y.col(1)), off.dot(y.col(2)));
    const double length = move.cwiseAbs().maxCoeff();
    if (!(length < std::numeric_limits<double>::infinity())) return {};
    if (length <= settled)
      return is_minimum && !(passes && is_past_joint<3>(patch, from, past_end_of_surface)) ? at : Facing{};
    if (length > longest) move *= longest / length;
    const Vec<double, 2> to = from + move;
    int crossed = no_patch;
    double earliest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < patch.corners && hops > 0; ++k) {
      const double before = beyond_edge(patch, k, from), after = beyond_edge(patch, k, to);
      if (!patch.goes_on(k) || after <= at_face_edge || after <= before) continue;
      const double share = std::max(0.0, -before) / (after - before);
      if (share < earliest) {
        earliest = share;
        crossed = k;
      }
    }
    if (crossed != no_patch) {
      const Vec<double, 2> place = from + std::min(earliest, 1.0) * move;
      at = places_on_edge(patches_, {at.patch, place}, crossed)[1];
      --hops;
      continue;
    }
    for (int i = 0; i < 2; ++i) at.at[i] = std::clamp(to[i], -farthest, 1 + farthest);
  }
  return {};
}

Facing PatchSearch<3>::larger_gap(const std::vector<Facing>& feet, const Vec<double, 3>& x) const {
  Facing best;
  double largest = -std::numeric_limits<double>::infinity();
  for (const Facing& foot : feet) {
    if (foot.patch == no_patch) continue;
    const double of_foot = gap(foot, x), rounding = at_face_edge * std::abs(largest);
    const bool is_larger = best.patch == no_patch || of_foot > largest + rounding;
    if (!is_larger && (of_foot < largest - rounding || foot.patch > best.patch)) continue;
    best = foot;
    largest = of_foot;
  }
  return best;
}

std::vector<FaceSearch::Near> PatchSearch<3>::nearest_faces(const Query& query) const {
  const auto counts = [&](int patch) { return is_eligible(patch, query); };
  return faces_.nearest(query.x, counts, {query.outward, query.least_against()});
}

/// Whether a vertex of this surface may touch a patch of it.
bool PatchSearch<3>::may_be_touched(int patch, const Query& query) const {
  return !faces_.has(patch, query.own->vertex) && !is_of_own_wall(*query.own, patches_[patch], *query.start);
}

bool PatchSearch<3>::is_eligible(int patch, const Query& query) const {
  if (!query.own) return query.outward == Vec<double, 3>::Zero() || opposes<3>(across(patch), query.outward);
  const Vec<double, 3> normal = across(patch).normalized();
  if (query.outward.dot(normal) > -query.least_against() * query.outward.norm()) return false;
  if (!may_be_touched(patch, query)) return false;
  const FaceMiddle here = face_middle(patches_[patch], positions_);
  const double depth = -(query.x - here.place).dot(normal);
  if (depth <= 0) return true;
  bool is_near_last = false;
  if (query.last != no_patch) {
    const FaceMiddle last = face_middle(patches_[query.last], positions_);
    is_near_last = (here.place - last.place).norm() <= OwnVertex::neighbourhood * 2 * last.reach;
  }
  return here.is_beside(query.x) && depth <= (is_near_last ? 1 : OwnVertex::share_of_depth) * query.own->max_depth;
}

bool PatchSearch<3>::comes_after(const Facing& at, const OwnVertex& own) const {
  const Patch<3>& patch = patches_[at.patch];
  const auto weights = face_weights<double>(patch.corners, at.at[0], at.at[1]).value;
  double number = 0;
  for (int k = 0; k < patch.corners; ++k) number += weights[k] * patch.corner(k);
  return number > own.vertex;
}

Facing PatchSearch<3>::facing_itself(const Query& query) const {
  const Facing foot = nearest_facing(query);
  // Newton's method may have left the eligible patches.
  if (foot.patch != no_patch && is_eligible(foot.patch, query) && comes_after(foot, *query.own)) return foot;
  return {.distance = faces_.size()};
}

int PatchSearch<3>::nearest_of_itself(const Query& query) const {
  if (!query.x.allFinite()) return no_patch;
  const auto may_touch = [&](int patch) { return may_be_touched(patch, query); };
  auto near = nearest_faces(query);
  if (near.empty()) near = faces_.nearest(query.x, may_touch);
  return near.empty() ? no_patch : near.front().face;
}

/// Whether the eligible patches end at an edge.
bool PatchSearch<3>::ends(int patch, int edge, const Query& query) const {
  const Patch<3>& of = patches_[patch];
  return !of.goes_on(edge) && (of.across[edge] == no_patch || !is_eligible(of.across[edge], query));
}

/// Whether a foot is too far beyond an edge at which the eligible patches end.
bool PatchSearch<3>::is_past_end(const Facing& at, const Query& query) const {
  const Patch<3>& patch = patches_[at.patch];
  for (int k = 0; k < patch.corners; ++k) {
    const double furthest =
        query.size > 0 ? RoundedEnd<double>(query.size, patch.widths[k]).furthest() : past_end_of_surface;
    if (beyond_edge(patch, k, at.at) > furthest && ends(at.patch, k, query)) return true;
  }
  return false;
}

/// A foot with the ends that it is beyond where these are rounded off; none if it is too far beyond one.
Facing PatchSearch<3>::at_ends(Facing at, const Query& query) const {
  if (at.patch == no_patch || !(query.size > 0)) return at;
  if (is_past_end(at, query)) return {};
  const Patch<3>& patch = patches_[at.patch];
  for (int k = 0; k < patch.corners; ++k)
    if (beyond_edge(patch, k, at.at) > RoundedEnd<double>(query.size, patch.widths[k]).from && ends(at.patch, k, query))
      at.ends |= 1 << k;
  return at;
}

/// What x faces if its foot on a patch lies past an edge at which the surface is not smooth.
Facing PatchSearch<3>::beyond_edges(const Facing& at, const Query& query) const {
  const Patch<3>& patch = patches_[at.patch];
  if (is_past_end(at, query)) return {};
  std::vector<Facing> feet{at};
  for (int k = 0; k < patch.corners; ++k) {
    const int next = patch.across[k];
    if (patch.goes_on(k) || beyond_edge(patch, k, at.at) <= at_face_edge) continue;
    if (next != no_patch && is_eligible(next, query))
      feet.push_back(newton_foot(places_on_edge(patches_, at, k)[1], query.x, 0));
  }
  return feet.size() == 1 ? at : larger_gap(feet, query.x);
}

Facing PatchSearch<3>::nearest_facing(const Query& query) const {
  constexpr int hops = 8;
  if (!query.x.allFinite()) return {};
  const auto near = nearest_faces(query);
  if (near.empty()) return {};
  const auto foot = [&](const Near& from, int most) { return newton_foot({from.face, from.place.at}, query.x, most); };
  const Near* first = &near.front();
  for (const Near& at : near) {
    const bool is_inside = at.place.part == FacePart::inside, has_inside = first->place.part == FacePart::inside;
    if (is_inside != has_inside ? is_inside : at.face < first->face) first = &at;
  }
  if (patches_[first->face].is_smooth()) {
    const Facing at = foot(*first, hops);
    return at.patch == no_patch ? at : beyond_edges(at, query);
  }
  if (first->place.part == FacePart::inside) return foot(*first, 0);
  std::vector<Facing> feet;
  for (const Near& at : near) {
    const Facing there = foot(at, 0);
    if (there.patch != no_patch && !is_past_end(there, query)) feet.push_back(there);
  }
  return larger_gap(feet, query.x);
}

Facing PatchSearch<3>::facing_nothing(const Vec<double, 3>& x) const {
  const auto near = x.allFinite() ? faces_.nearest(x, [](int) { return true; }) : std::vector<Near>();
  if (near.empty()) return {.distance = std::numeric_limits<double>::infinity()};
  const auto first =
      std::min_element(near.begin(), near.end(), [](const Near& a, const Near& b) { return a.face < b.face; });
  return {.distance = first->distance, .nearest = first->face};
}

}  // namespace stickslip
