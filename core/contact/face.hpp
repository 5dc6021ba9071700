/// Faces of a surface in space: triangles, and bilinear quadrilaterals. The position y(s, t) is linear in the positions
/// of the corners, so forces and derivatives have the weights N_i:
///
///   triangle        N = 1 - s - t, s, t                              s, t >= 0, s + t <= 1
///   quadrilateral   N = (1-s)(1-t), s (1-t), s t, (1-s) t            0 <= s, t <= 1
///
/// Corners are counter-clockwise seen from outside of the solid, so y_s x y_t points out of it. The place that is
/// closest to x is inside of the face, on an edge, or at a corner: two, one or no coordinates are free, and along each
/// free direction d
///
///   (x - y) . (y_s d_s + y_t d_t) = 0
///
/// The search solves this in double. face_foot() gives the place its derivatives.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/contact/point_geometry.hpp"

namespace stickslip {

/// What of a face is closest to a point. `edge`: from corner `number` to the next; `corner`: corner `number`.
enum class FacePart { inside, edge, corner };

/// A place of a face.
struct FacePlace {
  std::array<int, 4> nodes{};  ///< corners; of a triangle the last one stands for nothing
  int corners = 0;             ///< 3 or 4
  FacePart part = FacePart::inside;
  int number = 0;
  Vec<double, 2> at = Vec<double, 2>::Zero();  ///< (s, t)

  bool has(int node) const {
    return std::find(nodes.begin(), nodes.begin() + corners, node) != nodes.begin() + corners;
  }
  /// Whether both are the same part of the same face, at whatever place of it.
  bool is_part_of(const FacePlace& other) const {
    return nodes == other.nodes && corners == other.corners && part == other.part && number == other.number;
  }
};

/// Positions of the corners of a face; `position`: node -> position. Of a triangle the last stands for nothing.
template <class T, class Position>
std::array<Vec<T, 3>, 4> corners_of(const FacePlace& face, const Position& position) {
  std::array<Vec<T, 3>, 4> corner;
  for (int k = 0; k < 4; ++k) corner[k] = position(face.nodes[std::min(k, face.corners - 1)]);
  return corner;
}

/// Area vector of a face, out of the solid: of a quadrilateral by its diagonals. `corner(k)`: its position.
template <class T, class Corner>
Vec<T, 3> area_vector(int corners, const Corner& corner) {
  const auto between = [&](int from, int to) -> Vec<T, 3> { return corner(to) - corner(from); };
  const bool is_triangle = corners == 3;
  return T(0.5) * cross<T>(is_triangle ? between(0, 1) : between(0, 2), is_triangle ? between(0, 2) : between(1, 3));
}

/// Width of a face behind an edge, length: of a triangle its height, of a quadrilateral its area over the length of the
/// edge.
template <class T, class Corner>
T width_behind(int corners, int edge, const Corner& corner) {
  const Vec<T, 3> along = corner((edge + 1) % corners) - corner(edge);
  return T(corners == 3 ? 2 : 1) * norm(area_vector<T>(corners, corner)) / norm(along);
}

/// Coordinates (s, t) of a corner, counted on from the first beyond the last.
inline Vec<double, 2> face_corner(int corners, int number) {
  const int k = number % corners;
  if (corners == 3) return {k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
  return {k == 1 || k == 2 ? 1.0 : 0.0, k >= 2 ? 1.0 : 0.0};
}

/// N_i and their derivatives by s and t, at one place of a face; those of a fourth corner that is none are zero.
template <class T>
struct FaceWeights {
  std::array<T, 4> value, along_s, along_t;
};

template <class T>
FaceWeights<T> face_weights(int corners, const T& s, const T& t) {
  const T zero(0), one(1);
  if (corners == 3) return {{one - s - t, s, t, zero}, {-one, one, zero, zero}, {-one, zero, one, zero}};
  return {{(one - s) * (one - t), s * (one - t), s * t, (one - s) * t},
          {t - one, one - t, t, -t},
          {s - one, -s, s, one - s}};
}

/// The twist y_st of a face, length; zero of a parallelogram and of a triangle.
template <class T>
Vec<T, 3> face_twist(const std::array<Vec<T, 3>, 4>& corner, int corners) {
  if (corners == 3) return Vec<T, 3>::Constant(T(0));
  return corner[0] - corner[1] + corner[2] - corner[3];
}

/// Position and tangents of a place.
template <class T>
struct FacePosition {
  Vec<T, 3> y, along_s, along_t;
};

template <class T>
FacePosition<T> face_position(const std::array<Vec<T, 3>, 4>& corner, const FaceWeights<T>& weights) {
  FacePosition<T> at{Vec<T, 3>::Constant(T(0)), Vec<T, 3>::Constant(T(0)), Vec<T, 3>::Constant(T(0))};
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i) {
      at.y[i] += weights.value[k] * corner[k][i];
      at.along_s[i] += weights.along_s[k] * corner[k][i];
      at.along_t[i] += weights.along_t[k] * corner[k][i];
    }
  return at;
}

/// How (s, t) changes with (off . y_s, off . y_t) at a place, off = x - y, so that off stays perpendicular to the
/// directions that are free there; zero at a corner. `off`, `along_s`, `along_t`, `twist`: vectors there, length.
Mat<double, 2> foot_step(const FacePlace& place, const Vec<double, 3>& off, const Vec<double, 3>& along_s,
                         const Vec<double, 3>& along_t, const Vec<double, 3>& twist);

/// Foot of a point on a face: its position and the slopes there, its coordinates (s, t), its weights, and the normal of
/// the face.
template <class T>
struct FaceFoot : FacePosition<T> {
  Vec<T, 2> at;
  std::array<T, 4> weights;
  Vec<T, 3> normal;  ///< unit, out of the solid
};

/// The foot of x at a place that was found in double, with its derivatives. `corner`: positions of the corners.
template <class T>
FaceFoot<T> face_foot(const FacePlace& place, const Vec<T, 3>& x, const std::array<Vec<T, 3>, 4>& corner) {
  T s(place.at[0]), t(place.at[1]);
  // Newton's corrections by the slope in double: one gives first derivatives, and another those of two layers.
  constexpr int layers = 2;
  for (int layer = 0; layer < layers && place.part != FacePart::corner; ++layer) {
    const auto at = face_position(corner, face_weights<T>(place.corners, s, t));
    const Vec<T, 3> off = x - at.y;
    const T along_s = dot(off, at.along_s), along_t = dot(off, at.along_t);
    const Mat<double, 2> step = foot_step(place, values(off), values(at.along_s), values(at.along_t),
                                          values(face_twist(corner, place.corners)));
    s += T(step(0, 0)) * along_s + T(step(0, 1)) * along_t;
    t += T(step(1, 0)) * along_s + T(step(1, 1)) * along_t;
  }
  const auto weights = face_weights<T>(place.corners, s, t);
  const auto at = face_position(corner, weights);
  FaceFoot<T> foot{at, {s, t}, weights.value, cross(at.along_s, at.along_t)};
  const T area = norm(foot.normal);
  for (int i = 0; i < 3; ++i) foot.normal[i] /= area;
  return foot;
}

/// Share of a face's size within which a projection counts as lying on its edge.
inline constexpr double at_face_edge = 1e-9;

/// The place of a face that is closest to x, with its corners' positions.
struct NearestPlace {
  FacePlace place;
  double distance;  ///< length
  Vec<double, 3> position;
  double size;  ///< of the face: its longest edge, length
};
/// `place`: nodes and corners of the face; its other values are not read.
NearestPlace nearest_of_face(FacePlace place, const std::array<Vec<double, 3>, 4>& corner, const Vec<double, 3>& x);

}  // namespace stickslip
