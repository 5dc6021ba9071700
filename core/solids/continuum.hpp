/// The continuum's gradients at the quadrature points of an element of any shape, in the plane, of revolution or in
/// space, with or without mean dilatation:
///
///   H_pq = B_pq,ia u_ia        dV
///
/// H is the displacement gradient. In the plane and in space B_pq,ia = delta_ip dN_a/dX_q; dV is area times thickness,
/// or a volume. Of revolution (X_0 = r, X_1 axial) the hoop strain H_22 = u_r / r joins them, and dV is area times the
/// circumference 2 pi r. Mean dilatation, at small strain, replaces the trace of H by its mean over the element,
///
///   H -> H + (theta - tr H)/3 I,   theta = int tr H dV / V,
///
/// so that a nearly incompressible element has one volume to keep and not one at every point: the limit of
/// F -> (theta/J)^(1/3) F (core/solids/mean_dilatation.hpp). It has a potential, hence a symmetric tangent. In plane
/// strain it too has H_22, the spread of the dilatation out of the plane. [H80]
///
/// What elements make of them is in core/solids/elements.hpp.
#pragma once

#include "core/mesh/shapes.hpp"
#include "core/solids/tensor.hpp"

namespace stickslip {

/// The kinematics of a shape in its own dimension, without mean dilatation.
template <class Shape>
inline constexpr Kinematics plain_kinematics = Shape::dimension == 3 ? Kinematics::space : Kinematics::plane;

/// Whether elements of a shape may have a mean dilatation: the four-node quadrilateral and the eight-node hexahedron.
template <class Shape>
inline constexpr bool may_average = !Shape::is_simplex && Shape::nodes == Shape::corners;

/// Calls f.template operator()<K>() with the kinematics as a compile-time constant.
template <class Shape, class F>
void with_kinematics(Kinematics kinematics, F&& f) {
  if constexpr (Shape::dimension == 3) {
    if constexpr (may_average<Shape>)
      if (kinematics == Kinematics::space_mean_dilatation)
        return f.template operator()<Kinematics::space_mean_dilatation>();
    return f.template operator()<Kinematics::space>();
  } else {
    if (kinematics == Kinematics::plane) return f.template operator()<Kinematics::plane>();
    if (kinematics == Kinematics::revolution) return f.template operator()<Kinematics::revolution>();
    if constexpr (may_average<Shape>) {
      if (kinematics == Kinematics::plane_mean_dilatation)
        return f.template operator()<Kinematics::plane_mean_dilatation>();
      f.template operator()<Kinematics::revolution_mean_dilatation>();
    }
  }
}

namespace detail {

template <class T>
T determinant(const Mat<T, 2>& J) {
  return J(0, 0) * J(1, 1) - J(0, 1) * J(1, 0);
}
template <class T>
T determinant(const Mat<T, 3>& J) {
  return dot(J.row(0), cofactors<T>(J).row(0));
}

}  // namespace detail

/// dN/dX (one column a node) and the volume of one quadrature point. `coordinates`: dimension x nodes. `depth`:
/// thickness of a plane body, unread in one of revolution and in space.
template <class T, class Shape, Kinematics kinematics = plain_kinematics<Shape>>
struct Gradient {
  static constexpr int nodes = Shape::nodes, D = Shape::dimension;
  static constexpr TensorLayout layout = layout_of(kinematics);
  static constexpr bool revolved = is_of_revolution(kinematics), averaged = has_mean_dilatation(kinematics);
  Mat<T, D, nodes> dN;
  T volume;
  Vec<T, revolved ? nodes : 0> hoop;         ///< N_a / r
  Mat<T, D, averaged ? nodes : 0> exchange;  ///< d(theta - tr H)/du_ia, a third of it

  Gradient() = default;
  Gradient(const ShapePoint<nodes, D>& point, const Mat<T, D, nodes>& coordinates, const T& depth = T(1)) {
    if constexpr (averaged) exchange.setConstant(T(0));  // element_gradients sets it
    Mat<T, D> J = Mat<T, D>::Zero();                     // J(i, j) = dX_i/dxi_j
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) J(i, j) += coordinates(i, a) * T(point.gradient(j, a));
    const T det = detail::determinant<T>(J);
    volume = det * T(point.weight);
    if constexpr (D == 2) {
      for (int a = 0; a < nodes; ++a) {
        const T gx(point.gradient(0, a)), gy(point.gradient(1, a));
        dN(0, a) = (gx * J(1, 1) - gy * J(1, 0)) / det;
        dN(1, a) = (gy * J(0, 0) - gx * J(0, 1)) / det;
      }
    } else {
      const Mat<T, D> minors = cofactors<T>(J);
      for (int a = 0; a < nodes; ++a)
        for (int i = 0; i < D; ++i) {
          T sum{};
          for (int j = 0; j < D; ++j) sum += minors(i, j) * T(point.gradient(j, a));
          dN(i, a) = sum / det;
        }
    }
    if constexpr (revolved) {
      T r{};
      for (int a = 0; a < nodes; ++a) r += coordinates(0, a) * T(point.value[a]);
      for (int a = 0; a < nodes; ++a) hoop[a] = T(point.value[a]) / r;
      volume *= T(2 * std::acos(-1.0)) * r;
    } else if constexpr (D == 2) {
      volume *= depth;
    }
  }

  /// d tr H / du_ia before averaging.
  T dilatation(int i, int a) const {
    if constexpr (revolved)
      if (i == 0) return dN(0, a) + hoop[a];
    return dN(i, a);
  }

  /// Calls f(p, q, B_pq,ia) for the components of H that u_ia moves.
  template <class F>
  void for_each(int i, int a, F&& f) const {
    for (int q = 0; q < D; ++q) f(i, q, dN(q, a));
    if constexpr (revolved)
      if (i == 0) f(2, 2, hoop[a]);
    if constexpr (averaged)
      for (int p = 0; p < 3; ++p) f(p, p, exchange(i, a));
  }

  /// Displacement gradient of nodal displacements (dimension x nodes), in their scalar: T, or a Dual built on it.
  template <class U>
  Tensor<U, layout> of(const Mat<U, D, nodes>& u) const {
    auto H = Tensor<U, layout>::constant(U(0));
    for (int a = 0; a < nodes; ++a)
      for (int i = 0; i < D; ++i) for_each(i, a, [&](int p, int q, const T& b) { H(p, q) += b * u(i, a); });
    return H;
  }
};

namespace detail {

template <class Shape, Kinematics kinematics>
const auto& quadrature_of() {
  static const auto points = [] {
    if constexpr (is_of_revolution(kinematics))
      return Shape::quadrature_of_revolution();
    else
      return Shape::quadrature();
  }();
  return points;
}

/// Sets the exchange of all gradients of an element.
template <class Gradients>
void average_dilatation(Gradients& gradients) {
  using T = std::decay_t<decltype(gradients[0].volume)>;
  T volume{};
  for (const auto& gradient : gradients) volume += gradient.volume;
  for (int a = 0; a < gradients[0].nodes; ++a)
    for (int i = 0; i < gradients[0].D; ++i) {
      T mean{};
      for (const auto& gradient : gradients) mean += gradient.dilatation(i, a) * gradient.volume;
      for (auto& gradient : gradients) gradient.exchange(i, a) = (mean / volume - gradient.dilatation(i, a)) / T(3);
    }
}

}  // namespace detail

/// Calls f(gradient) at each quadrature point of an element.
template <class T, class Shape, Kinematics kinematics, class F>
void for_each_gradient(const Nodal<T, Shape>& coordinates, const T& depth, F&& f) {
  const auto& quadrature = detail::quadrature_of<Shape, kinematics>();
  if constexpr (has_mean_dilatation(kinematics)) {
    std::array<Gradient<T, Shape, kinematics>, std::tuple_size_v<std::decay_t<decltype(quadrature)>>> gradients;
    for (std::size_t p = 0; p < gradients.size(); ++p) gradients[p] = {quadrature[p], coordinates, depth};
    detail::average_dilatation(gradients);
    for (const auto& gradient : gradients) f(gradient);
  } else {
    for (const auto& point : quadrature) f(Gradient<T, Shape, kinematics>(point, coordinates, depth));
  }
}

/// Quadrature points of an element.
template <class Shape>
constexpr int points_of(Kinematics kinematics) {
  if constexpr (Shape::dimension == 2)
    if (is_of_revolution(kinematics))
      return static_cast<int>(std::tuple_size_v<decltype(Shape::quadrature_of_revolution())>);
  return static_cast<int>(std::tuple_size_v<decltype(Shape::quadrature())>);
}

}  // namespace stickslip
