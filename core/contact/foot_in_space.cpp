#include "core/contact/foot_in_space.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <type_traits>

#include "core/contact/gregory.hpp"

namespace stickslip {
namespace {

/// Coordinate i of a place, with the derivatives of T by the two coordinates.
template <class T>
T seeded(double at, int i) {
  if constexpr (std::is_same_v<T, double>) {
    return at;
  } else {
    using Inner = decltype(T::v);
    return T::seed(seeded<Inner>(at, i), i);
  }
}

bool is_beyond_edges(const Patch<3>& patch, const Vec<double, 2>& at) {
  for (int k = 0; k < patch.corners; ++k)
    if (beyond_edge(patch, k, at) > 0) return true;
  return false;
}

/// The place of a patch from which it goes on to a place beyond its edges: of a quadrilateral the nearest in its
/// coordinates; of a triangle that on the line to the corner across from the edge, or a corner if it is beyond two.
template <class T>
Vec<T, 2> place_before(const Patch<3>& patch, const Vec<T, 2>& at) {
  const auto inside = [](const T& x) { return value(x) < 0 ? T(0) : x; };
  if (patch.corners == 4) {
    const auto from_end = [&](const T& x) { return T(T(1) - inside(T(T(1) - inside(x)))); };
    return {from_end(at[0]), from_end(at[1])};
  }
  const T s = inside(at[0]), t = inside(at[1]), whole = s + t + inside(T(T(1) - at[0] - at[1]));
  return {s / whole, t / whole};
}

/// The way w in the coordinates of a patch from `before`, the place before `at`: at - before = -b v beyond an edge by
/// b, with v across it, in a triangle to the corner across from it. Beyond an end it is -b (along e + across v), with e
/// along the edge and shares that are linear between its two (WayBeyond).
template <class T>
Vec<T, 2> way_beyond(const Patch<3>& patch, const Vec<T, 2>& at, const Vec<T, 2>& before) {
  const auto corner = [&](int k) -> Vec<double, 2> { return face_corner(patch.corners, k); };
  Vec<T, 2> way = at - before;
  for (int k = 0; k < patch.corners; ++k) {
    const T by = beyond_edge(patch, k, at);
    if (patch.goes_on(k) || value(by) <= 0) continue;
    const auto& [first, last] = patch.beyond[k];
    const Vec<double, 2> e = corner(k + 1) - corner(k);
    T share(0);
    for (int i = 0; i < 2; ++i) share += (before[i] - T(corner(k)[i])) * T(e[i] / e.squaredNorm());
    const T along = T(first.along) + T(last.along - first.along) * share,
            across = T(first.across) + T(last.across - first.across) * share;
    for (int i = 0; i < 2; ++i) {
      const T v = patch.corners == 3 ? T(corner(k + 2)[i]) - before[i] : T(i == 0 ? -e[1] : e[0]);
      way[i] -= by * (along * T(e[i]) + (across - T(1)) * v);
    }
  }
  return way;
}

/// Basis functions of a smooth patch, with slopes in T. Beyond its edges it goes on straight: its polynomials would
/// fold there. With c = place_before(x) and w = way_beyond(x, c) it is N(c) + N_s(c) w_s + N_t(c) w_t.
template <class T>
detail::Basis<T> smooth_basis(const Patch<3>& patch, const Vec<double, 2>& at) {
  if (!is_beyond_edges(patch, at))
    return detail::gregory_basis<T>(patch.corners, seeded<T>(at[0], 0), seeded<T>(at[1], 1));
  using U = Dual<2, T>;
  const Vec<U, 2> place(seeded<U>(at[0], 0), seeded<U>(at[1], 1)), before = place_before<U>(patch, place);
  const Vec<U, 2> way = way_beyond<U>(patch, place, before);
  const auto edge = detail::gregory_basis<U>(patch.corners, before[0], before[1]);
  detail::Basis<T> basis;
  for (std::size_t k = 0; k < basis.value.size(); ++k) {
    const U beyond = edge.value[k] + way[0] * edge.along_s[k] + way[1] * edge.along_t[k];
    basis.value[k] = beyond.v;
    basis.along_s[k] = beyond.d[0];
    basis.along_t[k] = beyond.d[1];
  }
  return basis;
}

/// A row a control point, filled by put(row, value, along_s, along_t) from the basis functions with slopes in T.
template <int columns, class T, class Put>
Eigen::Matrix<double, Eigen::Dynamic, columns> basis_at(const Patch<3>& patch, const Vec<double, 2>& at, Put&& put) {
  const auto fill = [&](int count, const auto& w) {
    Eigen::Matrix<double, Eigen::Dynamic, columns> n(count, columns);
    for (int c = 0; c < count; ++c) put(n.row(c), w.value[c], w.along_s[c], w.along_t[c]);
    return n;
  };
  if (patch.is_smooth()) return fill(detail::points_per_corner * patch.corners, smooth_basis<T>(patch, at));
  return fill(patch.corners, face_weights<T>(patch.corners, seeded<T>(at[0], 0), seeded<T>(at[1], 1)));
}

/// Basis functions with their slopes alone.
Eigen::Matrix<double, Eigen::Dynamic, 3> slopes_at(const Patch<3>& patch, const Vec<double, 2>& at) {
  return basis_at<3, double>(patch, at,
                             [](auto row, double n, double along_s, double along_t) { row << n, along_s, along_t; });
}

/// Of the vertices, from those of the control points.
template <class Rows>
auto of_vertices(const Patch<3>& patch, Rows rows) {
  if (!patch.is_smooth()) return rows;
  return Rows(patch.control.transpose() * rows);
}

/// Shares of a way, ascending, between which it crosses no edge of a smooth patch, on the two sides of which it has
/// other formulas.
std::vector<double> parts_of(const Patch<3>& patch, const Vec<double, 2>& from, const Vec<double, 2>& to) {
  std::vector<double> shares{0, 1};
  for (int k = 0; k < patch.corners && patch.is_smooth(); ++k) {
    const double before = beyond_edge(patch, k, from), after = beyond_edge(patch, k, to);
    if (before * after < 0) shares.push_back(before / (before - after));
  }
  std::sort(shares.begin(), shares.end());
  return shares;
}

}  // namespace

PlaceWeights place_weights(const Patch<3>& patch, const Vec<double, 2>& at) {
  using Second = Dual<2, Dual<2>>;
  return of_vertices(patch, basis_at<10, Second>(patch, at, [](auto row, const auto& n, const auto& s, const auto& t) {
                       row << n.v.v, s.v.v, t.v.v, s.v.d[0], s.v.d[1], t.v.d[1], s.d[0].d[0], s.d[0].d[1], s.d[1].d[1],
                           t.d[1].d[1];
                     }));
}

CurvedWeights curved_weights(const Patch<3>& patch, const Vec<double, 2>& at) {
  return of_vertices(patch, basis_at<6, Dual<2>>(patch, at, [](auto row, const auto& n, const auto& s, const auto& t) {
                       row << n.v, s.v, t.v, s.d[0], s.d[1], t.d[1];
                     }));
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
  const auto parts = parts_of(patch, from, to);
  for (std::size_t part = 0; part + 1 < parts.size(); ++part) {
    const double length = parts[part + 1] - parts[part];
    for (std::size_t g = 0; g < place.size(); ++g)
      moved +=
          share[g] * length * slopes_at(patch, from + (parts[part] + length * place[g]) * way).rightCols<2>() * way;
  }
  return of_vertices(patch, std::move(moved));
}

Mat<double, 2> foot_slope(const PlaceSlopes& slopes, const Eigen::Matrix3Xd& arms, const Vec<double, 3>& off) {
  const Eigen::Matrix<double, 3, 5> y = arms * slopes;
  Mat<double, 2> slope = y.leftCols<2>().transpose() * y.leftCols<2>();
  slope(0, 0) -= off.dot(y.col(2));
  slope(0, 1) -= off.dot(y.col(3));
  slope(1, 0) -= off.dot(y.col(3));
  slope(1, 1) -= off.dot(y.col(4));
  return slope.inverse();
}

}  // namespace stickslip
