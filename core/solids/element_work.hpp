/// What an adjoint asks of an element: the derivatives of the work W = sum_n a_n . f(u_n) of its forces f at states u_n
/// on displacements a_n, by everything that the element consists of.
///
///   W = sum_n sum_q A_n : P(H_n) V_q,   A_n = B_q a_n,   H_n = B_q u_n
///
/// The stress P is differentiated forward, along A_n and by the law's numbers; Q = dP/dH : A is what multiplies dH,
/// since a stress that has an energy has a symmetric tangent. Of all increments together follow the derivatives by B_q
/// and the volume V_q, and from them those by the coordinates (core/solids/gradient_work.hpp).
///
/// Of a law that is linear the states join in one matrix, however many they are:
///
///   W = 1/2 S : K,   S = sum_n (u_n a_n^T + a_n u_n^T)
///
/// so that each column of S is a motion, on half the unit displacement of its dof.
///
/// Of a law that remembers, P is that after the flow from the memory before, and the memory h after it joins the work
/// with a weight b: W = sum_n sum_q (A_n : P V_q + b_n . h). It is differentiated by motion and memory too.
#pragma once

#include <algorithm>
#include <vector>

#include "core/solids/elements.hpp"
#include "core/solids/gradient_work.hpp"

namespace stickslip {

/// Nodal values of one element at one time.
template <class Shape>
struct StateOfElement {
  Nodal<double, Shape> motion;    ///< u
  Nodal<double, Shape> weight;    ///< a
  Vector<double> last_memory;     ///< what its points remember of the last increment, one after another
  Vector<double> memory;          ///< b, laid out likewise
  const int* branches = nullptr;  ///< of the flows, likewise (ElementMemory)
};

/// By what the work is differentiated.
struct Wanted {
  bool geometry = true;  ///< coordinates and depth
  bool law = true;
};

/// Derivatives of the work; zero where they are not wanted.
template <class Shape, std::size_t numbers>
struct ElementWork {
  Nodal<double, Shape> coordinates = Nodal<double, Shape>::Zero();
  double depth = 0;
  std::array<double, numbers> law{};
  std::vector<Nodal<double, Shape>> motion = {};  ///< per state; empty of a law that does not remember
  std::vector<Vector<double>> last_memory = {};
};

namespace detail {

/// The stress of one point, and the derivative of its work over its volume, A : P, by H.
template <TensorLayout layout>
struct PointWork {
  Tensor<double, layout> stress, by_gradient;
};

/// The numbers of a law, the first of them with the derivative `first`.
template <class Probe, class Law>
auto seeded_numbers(const Law& law, int first) {
  const auto numbers = law.numbers();
  std::array<Probe, std::tuple_size_v<std::decay_t<decltype(numbers)>>> probes;
  for (std::size_t m = 0; m < probes.size(); ++m) probes[m] = Probe::seed(numbers[m], first + static_cast<int>(m));
  return probes;
}

/// Of a law with a symmetric tangent. `by_law` gets what the `seeds` first numbers of the law make of the work.
template <std::size_t seeds, TensorLayout layout, class Law, std::size_t count>
PointWork<layout> point_work(const Law& law, const Tensor<double, layout>& H, const Tensor<double, layout>& A,
                             double volume, std::array<double, count>& by_law) {
  using Probe = Dual<1 + static_cast<int>(seeds)>;
  Tensor<Probe, layout> probe, P;
  for (int k = 0; k < H.size; ++k) {
    probe[k] = Probe(H[k]);
    probe[k].d[0] = A[k];
  }
  if constexpr (seeds > 0)
    P = law.with(seeded_numbers<Probe>(law, 1)).stress(probe);
  else
    P = law.stress(probe);
  for (int k = 0; k < H.size; ++k)
    for (std::size_t m = 0; m < seeds; ++m) by_law[m] += volume * A[k] * P[k].d[1 + m];
  return {P.map([](const Probe& x) { return x.v; }), P.map([](const Probe& x) { return double(x.d[0]); })};
}

/// Of a law that remembers, with b over the volume and the branch of its flow; `by_before`: derivatives by the memory
/// before.
template <TensorLayout layout, class Law, std::size_t count, class Memory>
PointWork<layout> point_work(const Law& law, const Tensor<double, layout>& H, const Tensor<double, layout>& A,
                             double volume, std::array<double, count>& by_law, const Memory& before, int branch,
                             const Memory& b, Memory& by_before) {
  constexpr int components = Tensor<double, layout>::size, memory = Memory::RowsAtCompileTime;
  using Probe = Dual<components + memory + static_cast<int>(count)>;
  const auto probed = law.with(seeded_numbers<Probe>(law, components + memory));
  const auto probe = seeded<Probe>(H);
  Vec<Probe, memory> remembered;
  for (int m = 0; m < memory; ++m) remembered[m] = Probe::seed(before[m], components + m);
  const Vec<Probe, memory> after = probed.flow(probe, remembered, branch);
  const Tensor<Probe, layout> P = probed.stress(probe, after);
  Probe sum(0.0);
  for (int k = 0; k < components; ++k) sum += A[k] * P[k];
  for (int m = 0; m < memory; ++m) sum += b[m] * after[m];
  PointWork<layout> work;
  work.stress = P.map([](const Probe& x) { return x.v; });
  for (int k = 0; k < components; ++k) work.by_gradient[k] = sum.d[k];
  for (int m = 0; m < memory; ++m) by_before[m] = sum.d[components + m];
  for (std::size_t m = 0; m < count; ++m) by_law[m] += volume * sum.d[components + memory + static_cast<int>(m)];
  return work;
}

/// Adds the derivatives of one point's work by its gradient, over the volume but that by the volume itself.
template <class Shape, TensorLayout layout, class By>
void add_by_gradient(const StateOfElement<Shape>& state, const Tensor<double, layout>& A, const PointWork<layout>& work,
                     By& by) {
  const auto& [P, Q] = work;
  by.volume += A.full().cwiseProduct(P.full()).sum();
  by.dN += P.matrix().transpose().lazyProduct(state.weight) + Q.matrix().transpose().lazyProduct(state.motion);
  if constexpr (decltype(by.hoop)::RowsAtCompileTime > 0)
    by.hoop += P(2, 2) * state.weight.row(0).transpose() + Q(2, 2) * state.motion.row(0).transpose();
  if constexpr (decltype(by.exchange)::ColsAtCompileTime > 0)
    by.exchange += P.full().trace() * state.weight + Q.full().trace() * state.motion;
}

/// The derivatives of the work of an element with mean dilatation at finite strain, by the Dual of the whole element.
/// Its inputs are coordinates, depth and the law's numbers, and of a law that remembers motion and last memory. They
/// are seeded in turns: a dual number of all that a hexahedron has takes minutes to compile.
template <class Shape, Kinematics kinematics, class Law>
auto averaged_work(const Law& law, const Nodal<double, Shape>& coordinates, double depth,
                   const std::vector<StateOfElement<Shape>>& states) {
  const auto numbers = law.numbers();
  constexpr int dofs = dofs_of<Shape>, count = static_cast<int>(std::tuple_size_v<decltype(law.numbers())>);
  constexpr int memory = points_of<Shape>(kinematics) * memory_at<Law, kinematics>();
  constexpr int at_motion = dofs + 1 + count, at_memory = at_motion + dofs;
  constexpr int inputs = memory > 0 ? at_memory + memory : at_motion, at_once = std::min(inputs, 40);
  using Probe = Dual<at_once>;
  ElementWork<Shape, static_cast<std::size_t>(count)> out;
  for (const auto& state : states) {
    Vec<double, inputs> by;
    for (int first = 0; first < inputs; first += at_once) {
      const auto input = [&](double x, int k) {
        Probe probe(x);
        if (k >= first && k < first + at_once) probe.d[k - first] = 1;
        return probe;
      };
      Nodal<Probe, Shape> X, u;
      std::array<Probe, static_cast<std::size_t>(count)> of_law;
      Vec<Probe, memory> before, after;
      for (int k = 0; k < dofs; ++k) {
        X.data()[k] = input(coordinates.data()[k], k);
        u.data()[k] = input(state.motion.data()[k], at_motion + k);
      }
      for (int m = 0; m < count; ++m) of_law[m] = input(numbers[m], dofs + 1 + m);
      for (int m = 0; m < memory; ++m) before[m] = input(state.last_memory[m], at_memory + m);
      const auto forces = averaged_forces<true, Probe, Shape, kinematics, Probe>(
          law.with(of_law), X, u, input(depth, dofs), ElementMemory<Probe>(before.data(), state.branches),
          after.data());
      Probe work(0.0);
      for (int k = 0; k < dofs; ++k) work += state.weight.data()[k] * forces.data()[k];
      for (int m = 0; m < memory; ++m) work += state.memory[m] * after[m];
      for (int k = first; k < std::min(first + at_once, inputs); ++k) by[k] = work.d[k - first];
    }
    for (int k = 0; k < dofs; ++k) out.coordinates.data()[k] += by[k];
    out.depth += by[dofs];
    for (int m = 0; m < count; ++m) out.law[m] += by[dofs + 1 + m];
    if constexpr (memory > 0) {
      out.motion.emplace_back(by.template segment<dofs>(at_motion).reshaped(Shape::dimension, Shape::nodes));
      out.last_memory.emplace_back(by.template segment<memory>(at_memory));
    }
  }
  return out;
}

/// S = sum_n (u_n a_n^T + a_n u_n^T).
template <class Shape>
Mat<double, dofs_of<Shape>> joined(const std::vector<StateOfElement<Shape>>& states) {
  Mat<double, dofs_of<Shape>> half = Mat<double, dofs_of<Shape>>::Zero();
  for (const auto& state : states) {
    const Eigen::Map<const Vec<double, dofs_of<Shape>>> u(state.motion.data()), a(state.weight.data());
    half += u.lazyProduct(a.transpose());
  }
  return half + half.transpose();
}

/// Adds what one point of a linear law makes of the columns of S: to `by`, over the volume but that by the volume
/// itself, and to `by_law`, where that is wanted.
template <class Shape, Kinematics kinematics, class Law, std::size_t count>
void add_joined(const Law& law, const Gradient<double, Shape, kinematics>& gradient,
                const Mat<double, dofs_of<Shape>>& S, Wanted wanted, ByGradient<Shape, kinematics>& by,
                std::array<double, count>& by_law) {
  using Probe = Dual<static_cast<int>(count)>;
  const auto probed = law.with(seeded_numbers<Probe>(law, 0));
  for (int a = 0; a < Shape::nodes; ++a)
    for (int i = 0; i < Shape::dimension; ++i) {
      const Nodal<double, Shape> motion(S.col(Shape::dimension * a + i).data());
      const auto H = gradient.of(motion), P = law.stress(H);
      const auto on_unit = [&](const auto& stress) {  // B e : stress
        auto sum = 0.0 * stress(0, 0);
        gradient.for_each(i, a, [&](int p, int r, double x) { sum += x * stress(p, r); });
        return sum;
      };
      by.volume += 0.5 * on_unit(P);
      by.dN.col(a) += P.matrix().row(i).transpose();
      if constexpr (Gradient<double, Shape, kinematics>::revolved)
        if (i == 0) by.hoop[a] += P(2, 2);
      if constexpr (Gradient<double, Shape, kinematics>::averaged) by.exchange(i, a) += P.full().trace();
      if (!wanted.law) continue;
      const Probe work = on_unit(probed.stress(H.map([](double x) { return Probe(x); })));
      for (std::size_t m = 0; m < count; ++m) by_law[m] += 0.5 * gradient.volume * work.d[static_cast<int>(m)];
    }
}

}  // namespace detail

/// The derivatives of the work of one element. `law`: in double; `depth`: thickness of a plane body.
template <class Shape, Kinematics kinematics, class Law>
auto element_work(const Law& law, const Nodal<double, Shape>& coordinates, double depth,
                  const std::vector<StateOfElement<Shape>>& states, Wanted wanted = {}) {
  if constexpr (detail::averages<Law, kinematics>())
    if (law.is_finite) return detail::averaged_work<Shape, kinematics>(law, coordinates, depth, states);
  constexpr int n = Shape::nodes, points = points_of<Shape>(kinematics);
  constexpr std::size_t count = std::tuple_size_v<decltype(law.numbers())>;
  ElementWork<Shape, count> out;
  if constexpr (requires { Law::memory; })
    for (const auto& state : states) {
      out.motion.emplace_back(Nodal<double, Shape>::Zero());
      out.last_memory.emplace_back(state.last_memory.size());
    }
  std::array<Gradient<double, Shape, kinematics>, points> gradients;
  std::array<detail::ByGradient<Shape, kinematics>, points> by;
  const bool joins = detail::IsLinear<Law> && states.size() > n;  // a column takes half the time of a state
  Mat<double, dofs_of<Shape>> S;
  if (joins) S = detail::joined(states);
  int q = 0;
  for_each_gradient<double, Shape, kinematics>(coordinates, depth, [&](const auto& gradient) {
    gradients[q] = gradient;
    auto& of_point = by[q];
    if constexpr (detail::IsLinear<Law>)
      if (joins) detail::add_joined<Shape, kinematics>(law, gradient, S, wanted, of_point, out.law);
    for (std::size_t s = 0; s < states.size() && !joins; ++s) {
      const auto& state = states[s];
      const auto H = gradient.of(state.motion), A = gradient.of(state.weight);
      detail::PointWork<layout_of(kinematics)> work;
      if constexpr (requires { Law::memory; }) {
        constexpr int remembered = memory_at<Law, kinematics>();
        using Memory = Vec<double, remembered>;
        const Eigen::Index first = q * remembered;
        const Memory b = state.memory.template segment<remembered>(first) / gradient.volume;
        Memory by_before;
        const int branch = state.branches ? state.branches[first] : flow_branch::by_values;
        work = detail::point_work(law, H, A, gradient.volume, out.law,
                                  Memory(state.last_memory.template segment<remembered>(first)), branch, b, by_before);
        out.last_memory[s].template segment<remembered>(first) = gradient.volume * by_before;
        for (int a = 0; a < n; ++a)
          for (int i = 0; i < Shape::dimension; ++i)
            gradient.for_each(i, a, [&](int p, int r, double x) {
              out.motion[s](i, a) += gradient.volume * work.by_gradient(p, r) * x;
            });
      } else if (wanted.law) {
        work = detail::point_work<count>(law, H, A, gradient.volume, out.law);
      } else {
        work = detail::point_work<0>(law, H, A, gradient.volume, out.law);
      }
      if (wanted.geometry) detail::add_by_gradient(state, A, work, of_point);
    }
    of_point.dN *= gradient.volume;
    of_point.hoop *= gradient.volume;
    of_point.exchange *= gradient.volume;
    ++q;
  });
  if (!wanted.geometry) return out;
  if constexpr (has_mean_dilatation(kinematics)) detail::pull_back_exchange(gradients, by);
  for (q = 0; q < points; ++q)
    out.depth += detail::pull_back_gradient<Shape, kinematics>(gradients[q], by[q], out.coordinates) / depth;
  return out;
}

}  // namespace stickslip
