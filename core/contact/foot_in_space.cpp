#include "core/contact/foot_in_space.hpp"

#include <Eigen/LU>

#include "core/contact/gregory.hpp"

namespace stickslip {
namespace {

/// Basis functions and the derivatives in PlaceWeights, a row a control point.
PlaceWeights basis_at(const Patch<3>& patch, const Vec<double, 2>& at) {
  using First = Dual<2>;
  using Second = Dual<2, First>;
  const auto seed = [&](int i) {
    Second x(First::seed(at[i], i));
    x.d[i] = First(1.0);
    return x;
  };
  const Second s = seed(0), t = seed(1);
  const auto fill = [&](int count, const auto& value, const auto& along_s, const auto& along_t) {
    PlaceWeights n(count, 10);
    for (int c = 0; c < count; ++c)
      n.row(c) << value[c].v.v, along_s[c].v.v, along_t[c].v.v, along_s[c].v.d[0], along_s[c].v.d[1], along_t[c].v.d[1],
          along_s[c].d[0].d[0], along_s[c].d[0].d[1], along_s[c].d[1].d[1], along_t[c].d[1].d[1];
    return n;
  };
  if (patch.control.size() == 0) {
    const auto w = face_weights<Second>(patch.corners, s, t);
    return fill(patch.corners, w.value, w.along_s, w.along_t);
  }
  const auto w = detail::gregory_basis<Second>(patch.corners, s, t);
  return fill(detail::points_per_corner * patch.corners, w.value, w.along_s, w.along_t);
}

/// Basis functions with their slopes alone.
Eigen::Matrix<double, Eigen::Dynamic, 3> slopes_at(const Patch<3>& patch, const Vec<double, 2>& at) {
  const auto fill = [](int count, const auto& w) {
    Eigen::Matrix<double, Eigen::Dynamic, 3> n(count, 3);
    for (int c = 0; c < count; ++c) n.row(c) << w.value[c], w.along_s[c], w.along_t[c];
    return n;
  };
  if (!patch.is_smooth()) return fill(patch.corners, face_weights<double>(patch.corners, at[0], at[1]));
  return fill(detail::points_per_corner * patch.corners, detail::gregory_basis<double>(patch.corners, at[0], at[1]));
}

/// Of the vertices, from those of the control points.
template <class Rows>
auto of_vertices(const Patch<3>& patch, Rows rows) {
  if (!patch.is_smooth()) return rows;
  return Rows(patch.control.transpose() * rows);
}

}  // namespace

PlaceWeights place_weights(const Patch<3>& patch, const Vec<double, 2>& at) {
  return of_vertices(patch, basis_at(patch, at));
}

Eigen::VectorXd weights_moved(const Patch<3>& patch, const Vec<double, 2>& from, const Vec<double, 2>& to) {
  // The difference loses the digits of a short way, and the mean slope along a long one is not exact: its error is of
  // the ninth power of the way. Both are good to rounding where they meet.
  constexpr double is_short = 0.01;
  const Vec<double, 2> way = to - from;
  if (way == Vec<double, 2>::Zero()) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(patch.vertices.size()));
  if (way.cwiseAbs().maxCoeff() > is_short)
    return of_vertices(patch, Eigen::VectorXd(slopes_at(patch, to).col(0) - slopes_at(patch, from).col(0)));
  // Gauss's rule with four points on (0, 1)
  constexpr std::array place{0.06943184420297371, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629};
  constexpr std::array share{0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693};
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(patch.is_smooth() ? patch.control.rows() : patch.corners);
  for (std::size_t g = 0; g < place.size(); ++g)
    moved += share[g] * slopes_at(patch, from + place[g] * way).rightCols<2>() * way;
  return of_vertices(patch, std::move(moved));
}

Mat<double, 2> foot_slope(const PlaceWeights& weights, const Eigen::Matrix3Xd& arms, const Vec<double, 3>& off) {
  const Eigen::Matrix<double, 3, 5> y = arms * weights.middleCols<5>(1);
  Mat<double, 2> slope = y.leftCols<2>().transpose() * y.leftCols<2>();
  slope(0, 0) -= off.dot(y.col(2));
  slope(0, 1) -= off.dot(y.col(3));
  slope(1, 0) -= off.dot(y.col(3));
  slope(1, 1) -= off.dot(y.col(4));
  return slope.inverse();
}

}  // namespace stickslip
