/// Foot of a point on the faces of a master in space, triangles and bilinear quadrilaterals, at small strain: the
/// closest of all places, found inside of each face and on each of its edges. Where several faces have it, the normal
/// is the mean of theirs, of those that oppose the slave's side (core/README.md, Faces in space).
#pragma once

#include "studies/verify/masters.hpp"
#include "studies/verify/solids.hpp"

namespace stickslip::verify {

class Faces {
 public:
  Faces(const Scene& scene, const Side& master) : points_(scene.points), faces_(master.edges) {
    for (const auto& face : faces_)
      for (std::size_t k = 0; k < face.size(); ++k) ++count_[edge_of(face, k)];
  }

  Foot foot(const Seeker& seeker) const {
    std::vector<Near> near;
    for (const auto& face : faces_) near.push_back(nearest(face, seeker.x));
    const Near best = *std::ranges::min_element(near, {}, &Near::distance);
    const double band = at_end * best.size;
    std::erase_if(near, [&](const Near& at) { return (at.y - best.y).norm() > 2 * band; });
    Foot foot{true, best.y};
    const bool is_past = std::ranges::any_of(near, [&](const Near& at) { return is_past_border(at, seeker.x); });
    std::erase_if(near, [&](const Near& at) { return seeker.outward.dot(at.normal) >= 0; });
    if (near.empty() || is_past) return foot.away_from(seeker.x);
    Vec3 normal = Vec3::Zero();
    for (const auto& at : near) normal += at.normal;
    foot.normal = (normal.normalized() - seeker.outward.normalized()).normalized();  // the bisector of the two sides
    for (std::size_t a = 0; a < near[0].face->size(); ++a)
      foot.weights.emplace_back(near[0].face->at(a), -near[0].N[a]);
    foot.gap = foot.normal.dot(seeker.x - foot.y);
    return foot;
  }

 private:
  struct Near {
    const Nodes* face;
    double distance, size;  ///< size: of the face, its longest edge
    Vec3 y, normal;
    Eigen::VectorXd N;
  };

  static std::set<int> edge_of(const Nodes& face, std::size_t k) { return {face[k], face[(k + 1) % face.size()]}; }
  Line line_of(const Nodes& face, std::size_t k) const {
    return {points_.col(face[k]), points_.col(face[(k + 1) % face.size()])};
  }

  /// The place (r, s) of a face.
  Near place(const Nodes& face, const Vec3& at, const Vec3& x) const {
    const Field X = points_(Eigen::all, face);
    const Shape N = shape(face.size() == 3 ? "T3" : "Q4", at);
    const Vec3 y = X * N.value, normal = (X * N.gradient.col(0)).cross(X * N.gradient.col(1));
    double size = 0;
    for (std::size_t k = 0; k < face.size(); ++k) size = std::max(size, line_of(face, k).tau.norm());
    return {&face, (x - y).norm(), size, y, normal.normalized(), N.value};
  }

  /// Where x - y is across the face, by the steps of Gauss and Newton from its middle; else on the nearest edge.
  Near nearest(const Nodes& face, const Vec3& x) const {
    const std::string kind = face.size() == 3 ? "T3" : "Q4";
    const Field X = points_(Eigen::all, face), &corners = reference(kind).nodes;
    Vec3 at = corners.rowwise().mean();
    for (int k = 0; k < 100 && at.cwiseAbs().maxCoeff() < 2; ++k) {
      const Shape N = shape(kind, at);
      const Eigen::Matrix<double, 3, 2> slope = X * N.gradient.leftCols<2>();
      at.head<2>() += (slope.transpose() * slope).inverse() * slope.transpose() * (x - X * N.value);
    }
    const double most = kind == "T3" ? at.sum() : at.maxCoeff();
    if (at.minCoeff() >= -at_end && most <= 1 + at_end) return place(face, at, x);
    Near best{nullptr, infinity};
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec3 from = corners.col(k), to = corners.col((k + 1) % face.size());
      const Near on_edge = place(face, from + std::clamp(line_of(face, k).xi(x), 0.0, 1.0) * (to - from), x);
      if (on_edge.distance < best.distance) best = on_edge;
    }
    return best;
  }

  /// Whether x projects past an edge that no other face has.
  bool is_past_border(const Near& at, const Vec3& x) const {
    for (std::size_t k = 0; k < at.face->size(); ++k) {
      const Line line = line_of(*at.face, k);
      const bool is_here = line.distance(at.y) <= at_end * at.size && count_.at(edge_of(*at.face, k)) == 1;
      if (is_here && (x - at.y).dot(line.tau.cross(at.normal).normalized()) > 1e-6 * at.size) return true;
    }
    return false;
  }

  const Field& points_;
  std::vector<Nodes> faces_;
  std::map<std::set<int>, int> count_;  ///< of the faces at an edge
};

}  // namespace stickslip::verify
