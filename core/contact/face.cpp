#include "core/contact/face.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <optional>

namespace stickslip {
namespace {

using Corners = std::array<Vec<double, 3>, 4>;

FacePosition<double> position_at(const FacePlace& face, const Corners& corner, const Vec<double, 2>& at) {
  return face_position(corner, face_weights<double>(face.corners, at[0], at[1]));
}

/// Whether (s, t) is in a face that is wider by a share of itself.
bool is_inside(int corners, const Vec<double, 2>& at, double wider) {
  const double most = corners == 3 ? 1 - at.sum() : std::min(1 - at[0], 1 - at[1]);
  return std::min({at[0], at[1], most}) >= -wider;
}

/// The stationary place of the distance in a face; none if it lies outside. A bilinear face has another such place, far
/// outside of it, so the way there ends where it leaves the face by half.
std::optional<Vec<double, 2>> projection(const FacePlace& face, const Corners& corner, const Vec<double, 3>& x) {
  constexpr int most = 50;
  constexpr double far = 0.5, done = 1e-14;
  Vec<double, 2> at = face.corners == 3 ? Vec<double, 2>(1.0 / 3, 1.0 / 3) : Vec<double, 2>(0.5, 0.5);
  for (int i = 0; i < most; ++i) {
    const auto p = position_at(face, corner, at);
    const Vec<double, 3> off = x - p.y;
    const Vec<double, 3> twist = face_twist(corner, face.corners) * (i > 0);  // (first as of a flat face)
    const Vec<double, 2> step =
        foot_step(face, off, p.along_s, p.along_t, twist) * Vec<double, 2>(off.dot(p.along_s), off.dot(p.along_t));
    if (!step.allFinite()) return std::nullopt;
    at += step;
    if (!is_inside(face.corners, at, far)) {
      if (i > 0) return std::nullopt;
      at = at.cwiseMax(0.0).cwiseMin(1.0);
    } else if (step.norm() <= done) {
      break;
    }
  }
  return is_inside(face.corners, at, at_face_edge) ? std::optional(at) : std::nullopt;
}

double size_of(int corners, const Corners& corner) {
  double size = 0;
  for (int k = 0; k < corners; ++k) size = std::max(size, (corner[(k + 1) % corners] - corner[k]).norm());
  return size;
}

}  // namespace

Mat<double, 2> foot_step(const FacePlace& place, const Vec<double, 3>& off, const Vec<double, 3>& along_s,
                         const Vec<double, 3>& along_t, const Vec<double, 3>& twist) {
  Mat<double, 2> slope;  // of -(off . y_s, off . y_t)
  const double across = along_s.dot(along_t) - off.dot(twist);
  slope << along_s.squaredNorm(), across, across, along_t.squaredNorm();
  if (place.part == FacePart::inside) return slope.inverse();
  if (place.part == FacePart::corner) return Mat<double, 2>::Zero();
  const Vec<double, 2> free = face_corner(place.corners, place.number + 1) - face_corner(place.corners, place.number);
  return free * free.transpose() / free.dot(slope * free);
}

NearestPlace nearest_of_face(FacePlace place, const std::array<Vec<double, 3>, 4>& corner, const Vec<double, 3>& x) {
  const double size = size_of(place.corners, corner);
  place.part = FacePart::inside;
  place.number = 0;
  if (const auto at = projection(place, corner, x)) {
    place.at = *at;
    const auto y = position_at(place, corner, *at).y;
    return {place, (x - y).norm(), y, size};
  }
  NearestPlace best{place, std::numeric_limits<double>::infinity(), x, size};
  for (int k = 0; k < place.corners; ++k) {
    const auto &a = corner[k], &b = corner[(k + 1) % place.corners];
    const double along = (x - a).dot(b - a) / (b - a).squaredNorm(), share = std::clamp(along, 0.0, 1.0);
    const bool at_end = along < -at_face_edge || along > 1 + at_face_edge;
    const Vec<double, 3> y = a + share * (b - a);
    const double distance = (x - y).norm();
    if (distance >= best.distance) continue;
    place.part = at_end ? FacePart::corner : FacePart::edge;
    place.number = at_end && along > 1 ? (k + 1) % place.corners : k;
    const Vec<double, 2> from = face_corner(place.corners, k), to = face_corner(place.corners, k + 1);
    place.at = from + share * (to - from);
    best = {place, distance, y, size};
  }
  return best;
}

}  // namespace stickslip
