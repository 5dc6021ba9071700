/// What an adjoint asks of an element: the derivatives of the work W = sum_n a_n . f(u_n) of its forces f at states u_n
/// on displacements a_n, by everything that the element consists of.
///
///   W = sum_n sum_q A_n : P(H_n) V_q,   A_n = B_q a_n,   H_n = B_q u_n
///
/// The stress P is differentiated forward, along A_n and by the law's numbers; (dP/dH : A) is what multiplies dH, since
/// a stress that has an energy has a symmetric tangent. B_q and the volume V_q are differentiated forward by the
/// coordinates, whatever the kinematics.
///
/// Of a law that remembers, P is that after the flow from the memory before, and the memory h after it joins the work
/// with a weight b: W = sum_n sum_q (A_n : P V_q + b_n . h). It is differentiated by motion and memory too.
#pragma once

#include <vector>

#include "core/solids/elements.hpp"

namespace stickslip {

/// Nodal values of one element at one time.
template <int nodes>
struct StateOfElement {
  Mat<double, 2, nodes> motion;  ///< u
  Mat<double, 2, nodes> weight;  ///< a
  Vector<double> before;         ///< what its points remember of the last increment, one after another
  Vector<double> memory;         ///< b, laid out likewise
};

/// Derivatives of the work.
template <int nodes, std::size_t numbers>
struct ElementWork {
  Mat<double, 2, nodes> coordinates = Mat<double, 2, nodes>::Zero();
  double depth = 0;
  std::array<double, numbers> law{};
  std::vector<Mat<double, 2, nodes>> motion = {};  ///< per state; empty of a law that does not remember
  std::vector<Vector<double>> before = {};
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

/// The stress of one point, and the derivative of its work over its volume, A : P, by H.
template <int rows>
struct PointWork {
  Mat<double, rows> stress, by_gradient;
};

/// Of a law with a symmetric tangent. `probed`: the law with its numbers seeded behind the first direction; `by_law`
/// gets what they make of the work.
template <int rows, class Law, std::size_t count>
PointWork<rows> point_work(const Law& probed, const Mat<double, rows>& H, const Mat<double, rows>& A, double volume,
                           std::array<double, count>& by_law) {
  using Probe = Dual<1 + static_cast<int>(count)>;
  Mat<Probe, rows> seeded;
  for (int k = 0; k < rows * rows; ++k) {
    seeded.data()[k] = Probe(H.data()[k]);
    seeded.data()[k].d[0] = A.data()[k];
  }
  const Mat<Probe, rows> P = probed.template stress<Probe, rows>(seeded);
  PointWork<rows> work;
  for (int k = 0; k < rows * rows; ++k) {
    work.stress.data()[k] = P.data()[k].v;
    work.by_gradient.data()[k] = P.data()[k].d[0];
    for (std::size_t m = 0; m < count; ++m) by_law[m] += volume * A.data()[k] * P.data()[k].d[1 + m];
  }
  return work;
}

/// Of a law that remembers, with b over the volume; `by_before`: derivatives by the memory before.
template <int rows, class Law, std::size_t count, class Memory>
PointWork<rows> point_work(const Law& law, const Mat<double, rows>& H, const Mat<double, rows>& A, double volume,
                           std::array<double, count>& by_law, const Memory& before, const Memory& b,
                           Memory& by_before) {
  constexpr int components = rows == 2 ? 4 : 5, memory = Law::memory;
  using Probe = Dual<components + memory + static_cast<int>(count)>;
  std::array<Probe, count> numbers;
  for (std::size_t m = 0; m < count; ++m)
    numbers[m] = Probe::seed(law.numbers()[m], components + memory + static_cast<int>(m));
  const auto probed = law.with(numbers);
  Mat<Probe, rows> seeded = Mat<Probe, rows>::Constant(Probe(0.0));
  for (int p = 0; p < rows; ++p)
    for (int q = 0; q < rows; ++q)
      if ((p == 2) == (q == 2)) seeded(p, q) = Probe::seed(H(p, q), component(p, q));
  Vec<Probe, memory> remembered;
  for (int m = 0; m < memory; ++m) remembered[m] = Probe::seed(before[m], components + m);
  const Vec<Probe, memory> after = probed.template flow<Probe, rows>(seeded, remembered);
  const Mat<Probe, rows> P = probed.template stress<Probe, rows>(seeded, after);
  Probe sum(0.0);
  for (int k = 0; k < rows * rows; ++k) sum += A.data()[k] * P.data()[k];
  for (int m = 0; m < memory; ++m) sum += b[m] * after[m];
  PointWork<rows> work{stickslip::values(P), Mat<double, rows>::Zero()};
  for (int p = 0; p < rows; ++p)
    for (int q = 0; q < rows; ++q)
      if ((p == 2) == (q == 2)) work.by_gradient(p, q) = sum.d[component(p, q)];
  for (int m = 0; m < memory; ++m) by_before[m] = sum.d[components + m];
  for (std::size_t m = 0; m < count; ++m) by_law[m] += volume * sum.d[components + memory + static_cast<int>(m)];
  return work;
}

/// The derivatives of the work of an element with mean dilatation at finite strain: the Dual of the whole element.
template <class Shape, Kinematics kinematics, class Law>
auto averaged_work(const Law& law, const Mat<double, 2, Shape::nodes>& coordinates, double depth,
                   const std::vector<StateOfElement<Shape::nodes>>& states) {
  constexpr int n = Shape::nodes, count = static_cast<int>(std::tuple_size_v<decltype(law.numbers())>);
  constexpr int memory = [] {
    if constexpr (requires { Law::memory; }) return points_of<Shape>(kinematics) * Law::memory;
    return 0;
  }();
  constexpr int at_motion = 2 * n + 1 + count, at_memory = at_motion + 2 * n;
  constexpr int inputs = memory > 0 ? at_memory + memory : at_motion;
  using Probe = Dual<inputs>;
  Mat<Probe, 2, n> X;
  for (int k = 0; k < 2 * n; ++k) X.data()[k] = Probe::seed(coordinates.data()[k], k);
  std::array<Probe, count> numbers;
  for (int m = 0; m < count; ++m) numbers[m] = Probe::seed(law.numbers()[m], 2 * n + 1 + m);
  const auto probed = law.with(numbers);
  ElementWork<n, static_cast<std::size_t>(count)> out;
  for (const auto& state : states) {
    Mat<Probe, 2, n> u;
    Vec<Probe, memory> before, after;
    for (int k = 0; k < 2 * n; ++k)
      u.data()[k] = memory > 0 ? Probe::seed(state.motion.data()[k], at_motion + k) : Probe(state.motion.data()[k]);
    for (int m = 0; m < memory; ++m) before[m] = Probe::seed(state.before[m], at_memory + m);
    const auto forces = averaged_forces<true, Probe, Shape, kinematics, Probe>(probed, X, u, Probe::seed(depth, 2 * n),
                                                                               before.data(), after.data());
    Probe work(0.0);
    for (int k = 0; k < 2 * n; ++k) work += state.weight.data()[k] * forces.data()[k];
    for (int m = 0; m < memory; ++m) work += state.memory[m] * after[m];
    for (int k = 0; k < 2 * n; ++k) out.coordinates.data()[k] += work.d[k];
    out.depth += work.d[2 * n];
    for (int m = 0; m < count; ++m) out.law[m] += work.d[2 * n + 1 + m];
    if constexpr (memory > 0) {
      out.motion.emplace_back();
      for (int k = 0; k < 2 * n; ++k) out.motion.back().data()[k] = work.d[at_motion + k];
      out.before.emplace_back(work.d.template segment<memory>(at_memory).matrix());
    }
  }
  return out;
}

}  // namespace detail

/// The derivatives of the work of one element. `law`: in double; `depth`: thickness of a plane body.
template <class Shape, Kinematics kinematics, class Law>
auto element_work(const Law& law, const Mat<double, 2, Shape::nodes>& coordinates, double depth,
                  const std::vector<StateOfElement<Shape::nodes>>& states) {
  if constexpr (detail::averages<Law, kinematics>())
    if (law.is_finite) return detail::averaged_work<Shape, kinematics>(law, coordinates, depth, states);
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
  if constexpr (requires { Law::memory; })
    for (const auto& state : states) {
      out.motion.emplace_back(Mat<double, 2, n>::Zero());
      out.before.emplace_back(state.before.size());
    }
  Eigen::Index remembered = 0;  // of the points before
  typename Geometry::Gradient by_geometry = Geometry::Gradient::Zero();
  for_each_gradient<Geometry, Shape, kinematics>(X, Geometry::seed(depth, 2 * n), [&](const auto& gradient) {
    const auto plain = detail::values(gradient);
    std::array<Mat<double, rows>, 2 * n> by_gradient;  // derivative by B_pq,ia, over the volume
    by_gradient.fill(Mat<double, rows>::Zero());
    double density = 0;
    for (std::size_t s = 0; s < states.size(); ++s) {
      const auto& state = states[s];
      const Mat<double, rows> H = plain.of(state.motion), A = plain.of(state.weight);
      detail::PointWork<rows> work;
      if constexpr (requires { Law::memory; }) {
        using Memory = Vec<double, Law::memory>;
        const Memory b = state.memory.template segment<Law::memory>(remembered) / plain.volume;
        Memory by_before;
        work = detail::point_work<rows>(law, H, A, plain.volume, out.law,
                                        Memory(state.before.template segment<Law::memory>(remembered)), b, by_before);
        out.before[s].template segment<Law::memory>(remembered) = plain.volume * by_before;
        for (int a = 0; a < n; ++a)
          for (int i = 0; i < 2; ++i)
            plain.for_each(i, a, [&](int p, int q, double x) {
              out.motion[s](i, a) += plain.volume * work.by_gradient(p, q) * x;
            });
      } else {
        work = detail::point_work<rows>(probed, H, A, plain.volume, out.law);
      }
      for (int k = 0; k < rows * rows; ++k) density += A.data()[k] * work.stress.data()[k];
      for (int ia = 0; ia < 2 * n; ++ia)
        by_gradient[ia] += state.weight.data()[ia] * work.stress + state.motion.data()[ia] * work.by_gradient;
    }
    if constexpr (requires { Law::memory; }) remembered += Law::memory;
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
