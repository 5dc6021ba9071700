/// What an adjoint asks of an element: the derivatives of the work W = sum_n a_n . f(u_n) of its forces f at states u_n
/// on displacements a_n, by everything that the element consists of.
///
///   W = sum_n sum_q A_n : P(H_n) V_q,   A_n = B_q a_n,   H_n = B_q u_n
///
/// The stress P is differentiated forward, along A_n and by the law's numbers; (dP/dH : A) is what multiplies dH, since
/// a stress that has an energy has a symmetric tangent. B_q and the volume V_q are differentiated forward by the
/// coordinates, whatever the kinematics.
#pragma once

#include <vector>

#include "core/solids/continuum.hpp"

namespace stickslip {

/// Nodal values of one element at one time.
template <int nodes>
struct StateOfElement {
  Mat<double, 2, nodes> motion;  ///< u
  Mat<double, 2, nodes> weight;  ///< a
};

/// Derivatives of the work.
template <int nodes, std::size_t numbers>
struct ElementWork {
  Mat<double, 2, nodes> coordinates = Mat<double, 2, nodes>::Zero();
  double depth = 0;
  std::array<double, numbers> law{};
};

namespace detail {

/// What an element's gradient is without its derivatives.
template <class T, class Shape, Kinematics kinematics>
Gradient<double, Shape, kinematics> values(const Gradient<T, Shape, kinematics>& gradient) {
  Gradient<double, Shape, kinematics> out;
  const auto plain = [](const T& x) { return value(x); };
  out.dN = gradient.dN.unaryExpr(plain);
  out.volume = value(gradient.volume);
  out.hoop = gradient.hoop.unaryExpr(plain);
  out.exchange = gradient.exchange.unaryExpr(plain);
  return out;
}

}  // namespace detail

/// The derivatives of the work of one element. `law`: in double; `depth`: thickness of a plane body.
template <class Shape, Kinematics kinematics, class Law>
auto element_work(const Law& law, const Mat<double, 2, Shape::nodes>& coordinates, double depth,
                  const std::vector<StateOfElement<Shape::nodes>>& states) {
  constexpr int n = Shape::nodes, rows = stress_dimension(kinematics);
  constexpr std::size_t count = std::tuple_size_v<decltype(law.numbers())>;
  using Geometry = Dual<2 * n + 1>;
  using Probe = Dual<1 + static_cast<int>(count)>;
  Mat<Geometry, 2, n> X;
  for (int k = 0; k < 2 * n; ++k) X.data()[k] = Geometry::seed(coordinates.data()[k], k);
  std::array<Probe, count> numbers;
  for (std::size_t k = 0; k < count; ++k) numbers[k] = Probe::seed(law.numbers()[k], 1 + static_cast<int>(k));
  const auto probed = law.with(numbers);
  ElementWork<n, count> out;
  typename Geometry::Gradient by_geometry = Geometry::Gradient::Zero();
  for_each_gradient<Geometry, Shape, kinematics>(X, Geometry::seed(depth, 2 * n), [&](const auto& gradient) {
    const auto plain = detail::values(gradient);
    std::array<Mat<double, rows>, 2 * n> by_gradient;  // derivative by B_pq,ia, over the volume
    by_gradient.fill(Mat<double, rows>::Zero());
    double density = 0;
    for (const auto& state : states) {
      const Mat<double, rows> H = plain.of(state.motion), A = plain.of(state.weight);
      Mat<Probe, rows> seeded;
      for (int k = 0; k < rows * rows; ++k) {
        seeded.data()[k] = Probe(H.data()[k]);
        seeded.data()[k].d[0] = A.data()[k];
      }
      const Mat<Probe, rows> P = probed.template stress<Probe, rows>(seeded);
      for (int k = 0; k < rows * rows; ++k) {
        density += A.data()[k] * P.data()[k].v;
        for (std::size_t m = 0; m < count; ++m) out.law[m] += plain.volume * A.data()[k] * P.data()[k].d[1 + m];
        for (int ia = 0; ia < 2 * n; ++ia)
          by_gradient[ia].data()[k] +=
              state.weight.data()[ia] * P.data()[k].v + state.motion.data()[ia] * P.data()[k].d[0];
      }
    }
    by_geometry += density * gradient.volume.d;
    for (int a = 0; a < n; ++a)
      for (int i = 0; i < 2; ++i)
        gradient.for_each(i, a, [&](int p, int q, const Geometry& b) {
          by_geometry += plain.volume * by_gradient[2 * a + i](p, q) * b.d;
        });
  });
  for (int k = 0; k < 2 * n; ++k) out.coordinates.data()[k] = by_geometry[k];
  out.depth = by_geometry[2 * n];
  return out;
}

}  // namespace stickslip
