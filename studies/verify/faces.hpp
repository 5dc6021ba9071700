/// Foot of a point on the faces of a master in space: the closest of all places, found inside of each patch, on each
/// of its edges and at its corners (core/README.md, Faces in space).
///
///   (x - y) . y_s = (x - y) . y_t = 0,   n = y_s x y_t / |y_s x y_t|,   g = n . (x - y)
///
/// Where several patches have it: at finite strain each is extended over its edges, and that with the largest gap is
/// faced, of equal gaps the first; at small strain, of faces of the start, the normal is the mean of theirs, of those
/// that oppose the slave's side.
#pragma once

#include <functional>

#include "studies/verify/own_walls.hpp"
#include "studies/verify/patches.hpp"

namespace stickslip::verify {

class Faces {
 public:
  /// `X`: nodes at the start; `smooth`, `corner`: as a Patchwork has them.
  Faces(const Field& X, const std::vector<Nodes>& faces, int smooth, double corner, bool finite)
      : finite_(finite), patches_(Patchwork(X, faces, smooth, corner).patches) {
    place_nodes(X);
    for (int p = 0; p < std::ssize(patches_); ++p) {
      const Nodes& face = patches_[p].face;
      for (std::size_t j = 0; j < face.size(); ++j)
        widths_[{p, static_cast<int>(j)}] = (face.size() == 3 ? 2 : 1) * boxes_[p][2].norm() /
                                            (X.col(face[(j + 1) % face.size()]) - X.col(face[j])).norm();
    }
  }

  void place_nodes(const Field& x) {
    x_ = x;
    nets_.clear();
    boxes_.clear();
    for (const auto& patch : patches_) {  // (differences are exact where a coordinate is one of all nodes)
      const Vec3 first = x.col(patch.nodes[0]);
      nets_.emplace_back(((x(Eigen::all, patch.nodes).colwise() - first) * patch.weigh).colwise() + first);
      boxes_.push_back(
          {nets_.back().rowwise().minCoeff(), nets_.back().rowwise().maxCoeff(), area_vector(x, patch.face)});
    }
  }

  Vec3 position(const Place& place) const { return jet(place.patch, {place.xi, place.eta}).col(0); }
  /// y_s, y_t and n.
  Mat3 frame(const Place& place) const {
    const Mat3 y = jet(place.patch, {place.xi, place.eta});
    return (Mat3() << y.rightCols<2>(), y.col(1).cross(y.col(2)).normalized()).finished();
  }

  /// The side is its own master from now on. `seekers`: its nodes at the start, where the nodes still are.
  void touch_itself(const std::vector<Seeker>& seekers) {
    std::vector<Nodes> faces;
    for (const auto& patch : patches_) faces.push_back(patch.face);
    own_.emplace(x_, faces, seekers);
  }

  Foot foot(const Seeker& seeker) const {
    const Vec3 &x = seeker.x, &outward = seeker.outward;
    auto near = own_      ? nearest(x, [&](int p) { return own_->may_face(seeker, p, x_); })
                : finite_ ? closest(x, outward)
                          : closest(x, Vec3(0, 0, 0));
    if (near.empty() && own_) near = nearest(x, [&](int p) { return own_->may_touch(seeker.node, p); });
    if (near.empty()) return {};
    const Near first = near[0];
    const bool faces = settle_on(near, seeker);
    if (!faces) return Foot{false, first.y, first.normal}.away_from(x);
    const Near& best = near[0];
    const auto& [p, s, t] = best.place;
    Foot foot{true, best.y, best.normal, best.gap, best.place};
    const Eigen::VectorXd N = patches_[p].weigh * blend(patches_[p], Vec2(s, t)).col(0);
    for (Eigen::Index k = 0; k < N.size(); ++k) foot.weights.emplace_back(patches_[p].nodes[k], -N[k]);
    if (finite_) {
      foot.gap += rounding_off(best, seeker);
      return foot;
    }
    Vec3 normal = own_ ? best.normal : Vec3(0, 0, 0);
    for (const auto& at : own_ ? std::vector<Near>{} : near) normal += at.normal;
    normal.normalize();
    foot.normal = (normal - seeker.against(normal).normalized()).normalized();  // the bisector of the two sides
    foot.gap = foot.normal.dot(x - foot.y);
    return foot;
  }

 private:
  struct Near {
    Place place;
    Vec3 y, normal;
    double gap, distance;
  };

  /// y, y_s, y_t.
  Mat3 jet(int p, const Vec2& at) const {
    Mat3 y = (nets_[p].colwise() - nets_[p].col(0)) * blend(patches_[p], at);
    y.col(0) += nets_[p].col(0);
    return y;
  }
  double size(int p) const { return (boxes_[p][1] - boxes_[p][0]).norm(); }

  Near near(int p, const Vec2& at, const Vec3& x) const {
    const Mat3 y = jet(p, at);
    const Vec3 off = x - y.col(0), normal = y.col(1).cross(y.col(2)).normalized();
    return {{p, at[0], at[1]}, y.col(0), normal, normal.dot(off), off.norm()};
  }

  /// Where x - y is across y in the directions D of (s, t): Newton's method; none where it does not end, or ends past
  /// an edge by more than the patch is wide.
  std::optional<Vec2> across(int p, Vec2 at, const Eigen::Matrix2Xd& D, const Vec3& x) const {
    constexpr double h = 1e-4;  // of central differences, whose errors of 1e-8 slow down the last steps alone
    for (int k = 0; k < 50 && at.cwiseAbs().maxCoeff() < 3; ++k) {
      const Mat3 y = jet(p, at);
      const Vec3 off = x - y.col(0);
      const Eigen::MatrixXd slope = y.rightCols<2>() * D, metric = slope.transpose() * slope;
      Eigen::MatrixXd bend = metric;
      for (int i = 0; i < D.cols(); ++i)
        bend.col(i) = ((jet(p, at + h * D.col(i)) - jet(p, at - h * D.col(i))).rightCols<2>() * D).transpose() * off;
      const Eigen::LLT<Eigen::MatrixXd> exact(metric - bend / (2 * h)), safe(metric);
      const Vec2 step = D * (exact.info() == Eigen::Success ? exact : safe).solve(slope.transpose() * off);
      at += step * std::min(1.0, 0.5 / step.norm());
      const bool is_near = at.minCoeff() >= -1 && at.maxCoeff() <= 2;
      if (step.norm() < 1e-14) return is_near ? std::optional(at) : std::nullopt;
    }
    return std::nullopt;
  }

  /// The nearest place of a patch, from several starts inside, and on each edge.
  Near nearest(int p, const Vec3& x) const {
    const int m = patches_[p].sides();
    Vec2 middle = Vec2::Zero();
    for (int j = 0; j < m; ++j) middle += corner_at(m, j) / m;
    Near best{{}, {}, {}, 0, infinity};
    const auto keep = [&](const std::optional<Vec2>& at) {
      if (!at || from_edges(m, (*at)[0], (*at)[1]).minCoeff() < -at_end) return;
      if (const Near found = near(p, *at, x); found.distance < best.distance) best = found;
    };
    keep(across(p, middle, Eigen::Matrix2d::Identity(), x));
    for (int j = 0; j < m; ++j) {
      const Vec2 from = corner_at(m, j), along = edge_along(m, j);
      keep(from);
      keep(across(p, (from + middle) / 2, Eigen::Matrix2d::Identity(), x));
      for (const double u : {0.25, 0.75}) keep(across(p, from + u * along, along, x));
    }
    return best;
  }

  /// The closest place of all patches but those that look the way of a side, in each that has it, the best first. A
  /// patch is in the box of its control points.
  std::vector<Near> closest(const Vec3& x, const Vec3& outward) const {
    return nearest(x, [&](int p) { return !looks_away(p, outward); });
  }
  std::vector<Near> nearest(const Vec3& x, const std::function<bool(int)>& counts) const {
    std::vector<std::pair<double, int>> boxes;  // with their distance
    for (int p = 0; p < std::ssize(patches_); ++p) {
      const Vec3 &low = boxes_[p][0], &high = boxes_[p][1];
      if (counts(p)) boxes.emplace_back((x - x.cwiseMax(low).cwiseMin(high)).norm(), p);
    }
    std::ranges::sort(boxes);
    std::vector<Near> near;
    double least = infinity;
    for (const auto& [distance, p] : boxes) {
      if (distance > least + 2 * at_end * size(p)) break;
      near.push_back(nearest(p, x));
      least = std::min(least, near.back().distance);
    }
    std::ranges::stable_sort(near, {}, &Near::distance);
    std::erase_if(near, [&](const Near& at) { return (at.y - near[0].y).norm() > 2 * at_end * size(at.place.patch); });
    return near;
  }

  bool looks_away(int p, const Vec3& outward) const { return !opposes(boxes_[p][2], outward); }

  /// Whether the faces that oppose a side end at an edge of a patch.
  bool ends(int p, int edge, const Seeker& seeker) const {
    const int other = patches_[p].beyond[edge];
    if (other < 0) return other == FacePatch::none;
    return own_ ? !own_->may_face(seeker, other, x_) : looks_away(other, seeker.outward);
  }

  /// How far a place is into what is rounded off of an end: 0 where that begins, 1 where the gap is infinite.
  double into_end(int p, int edge, double beyond, const Seeker& seeker) const {
    const double last = std::min(0.5, 0.5 * seeker.rounded / widths_.at({p, edge})), first = std::min(0.01, last / 5);
    return (beyond - first) / (last - first);
  }

  /// By how much the gap is larger past the ends.
  double rounding_off(const Near& here, const Seeker& seeker) const {
    const auto& [p, s, t] = here.place;
    const Eigen::VectorXd off = from_edges(patches_[p].sides(), s, t);
    double sum = 0;
    for (int j = 0; j < off.size(); ++j) {
      if (seeker.rounded == 0 || !ends(p, j, seeker)) continue;
      const double into = std::max(0.0, into_end(p, j, -off[j], seeker));
      sum += 0.01 * seeker.rounded * std::pow(into / (1 - into), 2);
    }
    return sum;
  }

  /// Whether x is past an edge at which the faces that oppose a side end: at finite strain by more than what is rounded
  /// off there, or by a hundredth of a face. A place so far past an edge where the surface goes on smoothly is on no
  /// patch: as past a corner.
  bool is_past_border(const Near& here, const Seeker& seeker) const {
    const auto& [p, s, t] = here.place;
    const Vec3& x = seeker.x;
    const Eigen::VectorXd off = from_edges(patches_[p].sides(), s, t);
    for (int j = 0; j < off.size(); ++j) {
      const bool is_end = ends(p, j, seeker), is_joint = finite_ && patches_[p].beyond[j] == FacePatch::smooth;
      if (!is_end && !is_joint) continue;
      if (is_end && seeker.rounded > 0 ? into_end(p, j, -off[j], seeker) <= 0.95 : off[j] > (finite_ ? -0.01 : at_end))
        continue;
      const Vec3 along = jet(p, {s, t}).rightCols<2>() * edge_along(patches_[p].sides(), j);
      if (finite_ || (x - here.y).dot(along.cross(here.normal).normalized()) > 1e-6 * size(p)) return true;
    }
    return false;
  }

  /// Keeps of the nearest places those that x faces, the best first; whether there is one. What is inside of the solid
  /// by a patch is not where it is outside by a nearer one.
  bool settle_on(std::vector<Near>& near, const Seeker& seeker) const {
    const Vec3 &x = seeker.x, &outward = seeker.outward;
    const bool moves = finite_ || own_;
    for (const auto& at : moves ? std::exchange(near, {}) : std::vector<Near>{})
      if (const auto on = across(at.place.patch, {at.place.xi, at.place.eta}, Eigen::Matrix2d::Identity(), x))
        near.push_back(this->near(at.place.patch, *on, x));
    if (!moves) std::erase_if(near, [&](const Near& at) { return looks_away(at.place.patch, outward); });
    if (std::ranges::any_of(near, [&](const Near& at) { return is_past_border(at, seeker); })) return false;
    if (!moves || near.empty()) return !near.empty();
    std::ranges::sort(near, {}, [](const Near& at) { return at.place.patch; });
    const double most = std::ranges::max(near, {}, &Near::gap).gap - at_end * size(near[0].place.patch);
    std::iter_swap(near.begin(), std::ranges::find_if(near, [&](const Near& at) { return at.gap >= most; }));
    if (own_) {
      const auto& [p, s, t] = near[0].place;
      const int m = patches_[p].sides();
      const Eigen::VectorXd N =
          m == 3 ? Eigen::VectorXd(Eigen::Vector3d(1 - s - t, s, t))
                 : Eigen::VectorXd(Eigen::Vector4d((1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t));
      return own_->may_face(seeker, p, x_) && own_->comes_after(seeker.node, p, N);
    }
    const double edge = std::sqrt(boxes_[near[0].place.patch][2].norm());  // of a square of its area
    if (near[0].gap >= -1e-6 * edge || outward.isZero(0)) return true;
    auto all = closest(x, Vec3::Zero());
    const bool is_outside = std::ranges::any_of(all, [](const Near& at) { return at.gap > 0; });
    Seeker any{seeker.node, x};
    any.rounded = seeker.rounded;
    if (!settle_on(all, any)) return !is_outside;
    const double half = seeker.rounded / 2;
    const bool is_beside =
        !seeker.comes_on && near[0].gap > -std::max(0.25 * edge, half) && !opposes(all[0].normal, near[0].normal);
    return all[0].gap < (is_beside ? std::max(0.01 * edge, half) : 0);  // (a little past the end of a sole)
  }

  bool finite_;
  Field x_;  ///< where nodes are
  std::vector<FacePatch> patches_;
  std::vector<Field> nets_;                       ///< control points
  std::vector<std::array<Vec3, 3>> boxes_;        ///< two ends of what they are in; area vectors of faces
  std::map<std::pair<int, int>, double> widths_;  ///< of a face behind one of its edges, at the start
  std::optional<OwnWalls> own_;                   ///< of a side that touches itself
};

}  // namespace stickslip::verify
