#include "core/model/element_nodes.hpp"
#include "core/model/with_law.hpp"
#include "core/solids/element_work.hpp"
#include "sensitivity/pull_back.hpp"

namespace stickslip {

namespace {

/// The law with plain numbers, and the numbers as they are on the tape.
template <class L>
auto plain_law(const L& law) {
  const auto recorded = law.numbers();
  std::array<double, std::tuple_size_v<std::decay_t<decltype(recorded)>>> plain;
  for (std::size_t k = 0; k < plain.size(); ++k) plain[k] = recorded[k].v;
  return std::make_pair(law.with(plain), recorded);
}

/// Calls f(law) with each part of the law's numbers behind the first, where there are any.
template <class L, class F>
void for_each_further_part(const L& law, F&& f) {
  if constexpr (requires { law.part_count(); }) {
    L of_part = law;
    for (of_part.part = 1; of_part.part < law.part_count(); ++of_part.part) f(of_part);
  }
}

/// The columns of pairs, one an increment.
Eigen::Index increments_in(const WorkPairs& pairs) { return pairs.motions.cols(); }

/// The part of a column that a body's element e remembers, or is to; of a matrix that is empty, zeros.
Vector<double> remembered(const Matrix<double>& of, const BodyMesh& body, int e, Eigen::Index column) {
  if (of.size() == 0) return Vector<double>::Zero(body.memory);
  return of.col(column).segment(body.first_memory + e * body.memory, body.memory);
}

/// The branches of the flows of a body's element in a column; nullptr: by their values.
const int* branches_of(const WorkPairs& pairs, const BodyMesh& body, int e, Eigen::Index column) {
  const FlowBranches& all = pairs.flows[column];
  return all.empty() ? nullptr : all.data() + body.first_memory + e * body.memory;
}

/// The elements of a continuum: each is differentiated by its own inputs, for all increments together.
template <class Shape, Kinematics kinematics, class L>
void pull_back_continuum(const L& law, const Model& model, const Slots<Reverse>& slots, int b, const WorkPairs& pairs,
                         std::vector<double>& by, WorkDerivative& left) {
  constexpr int D = Shape::dimension;
  const auto& body = model.bodies[b];
  const auto [plain, numbers] = plain_law(law);
  const Reverse& thickness = slots.depths[b].thickness;
  std::vector<StateOfElement<Shape>> states(increments_in(pairs));
  if (!Remembers<L> && pairs.weights.size() == 0) return;
  const auto is_on_tape = [](const Reverse& x) { return x.entry >= 0; };
  const Wanted wanted{is_on_tape(slots.points(0, body.first_node)) || is_on_tape(thickness),
                      std::any_of(numbers.begin(), numbers.end(), is_on_tape)};
  if (!Remembers<L> && !wanted.geometry && !wanted.law) return;
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(body, e);
    Nodal<double, Shape> X;
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < D; ++i) X(i, a) = slots.points(i, nodes[a]).v;
    for (Eigen::Index n = 0; n < increments_in(pairs); ++n) {
      StateOfElement<Shape>& state = states[n];
      for (int a = 0; a < Shape::nodes; ++a)
        for (int i = 0; i < D; ++i) {
          state.motion(i, a) = pairs.motions(D * nodes[a] + i, n);
          state.weight(i, a) = pairs.weights.size() > 0 ? pairs.weights(D * nodes[a] + i, n) : 0;
        }
      if constexpr (Remembers<L>) {
        state.last_memory = remembered(pairs.last_memory, body, e, n);
        state.memory = remembered(pairs.memory, body, e, n);
        state.branches = branches_of(pairs, body, e, n);
      }
    }
    const auto work = element_work<Shape, kinematics>(plain, X, thickness.v, states, wanted);
    const auto add = [&](const Reverse& input, double derivative) {
      if (input.entry >= 0) by[input.entry] += derivative;
    };
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < D; ++i) add(slots.points(i, nodes[a]), work.coordinates(i, a));
    add(thickness, work.depth);
    for (std::size_t k = 0; k < numbers.size(); ++k) add(numbers[k], work.law[k]);
    for_each_further_part(law, [&](const L& of_part) {
      const auto [part, its_numbers] = plain_law(of_part);
      const auto by_part = element_work<Shape, kinematics>(part, X, thickness.v, states, {false, true}).law;
      for (std::size_t k = 0; k < by_part.size(); ++k) add(its_numbers[k], by_part[k]);
    });
    for (std::size_t n = 0; n < work.last_memory.size(); ++n) {
      const auto column = static_cast<Eigen::Index>(n);
      left.last_memory.col(column).segment(body.first_memory + e * body.memory, body.memory) += work.last_memory[n];
      for (int a = 0; a < Shape::nodes; ++a)
        left.motion.col(column).template segment<D>(D * nodes[a]) += work.motion[n].col(a);
    }
  }
}

/// Elements of two nodes: each is recorded behind what the tape holds, increment by increment, and taken off again.
template <int D, class L>
void pull_back_two_nodes(const L& law, const Model& model, const Slots<Reverse>& slots, int b, Tape& tape,
                         const WorkPairs& pairs, std::vector<double>& by, WorkDerivative& left) {
  const int start = tape.size();
  if (!Remembers<L> && pairs.weights.size() == 0) return;
  const auto& body = model.bodies[b];
  for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(model.bodies[b], e);
    const auto X = detail::two_places<Reverse, D>(slots.points, nodes);
    const auto stretch = [&](const Matrix<double>& of, Eigen::Index n) -> Vec<double, D> {
      return of.col(n).template segment<D>(nodes[1] * D) - of.col(n).template segment<D>(nodes[0] * D);
    };
    for (Eigen::Index n = 0; n < increments_in(pairs); ++n) {
      const Vec<Reverse, D> d = stretch(pairs.motions, n).template cast<Reverse>();
      Vec<double, D> weight = Vec<double, D>::Zero();
      if (pairs.weights.size() > 0) weight = stretch(pairs.weights, n);
      const auto seed = [&](const auto& results, const auto& weights) {
        by.resize(tape.size(), 0);
        for (Eigen::Index i = 0; i < results.size(); ++i)
          if (results[i].entry >= 0) by[results[i].entry] += weights[i];
        tape.pull_back(by, start);
      };
      if constexpr (Remembers<L>) {
        const Vector<Reverse> variables = leaves(values(d), tape),
                              before = leaves(remembered(pairs.last_memory, body, e, n), tape);
        const Vec<Reverse, D> moved = variables;
        const int* const branch = branches_of(pairs, body, e, n);
        const Vec<Reverse, L::memory> after =
            law.template flow<D>(X, moved, before, branch ? *branch : flow_branch::by_values);
        const Vec<Reverse, D> force = law.template force<D>(X, moved, after);
        by.resize(tape.size(), 0);
        for (int m = 0; m < L::memory; ++m)
          if (after[m].entry >= 0) by[after[m].entry] += remembered(pairs.memory, body, e, n)[m];
        seed(force, weight);
        for (int m = 0; m < L::memory; ++m)
          left.last_memory(body.first_memory + e * body.memory + m, n) += by[before[m].entry];
        for (int i = 0; i < D; ++i) {
          left.motion(nodes[1] * D + i, n) += by[variables[i].entry];
          left.motion(nodes[0] * D + i, n) -= by[variables[i].entry];
        }
      } else {
        seed(law.template force<D>(X, d), weight);
      }
      by.resize(start);
      tape.rewind(start);
    }
  }
}

}  // namespace

WorkDerivative pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, const WorkPairs& pairs,
                                std::vector<double>& by) {
  WorkDerivative left;
  if (model.memory_count > 0) {
    left.motion = Matrix<double>::Zero(model.dof_count(), increments_in(pairs));
    left.last_memory = Matrix<double>::Zero(model.memory_count, increments_in(pairs));
  }
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    detail::with_law<Reverse>(
        model, slots, b,
        [&]<class Shape, Kinematics kinematics>(const auto& law) {
          pull_back_continuum<Shape, kinematics>(law, model, slots, b, pairs, by, left);
        },
        [&]<int D>(const auto& law) { pull_back_two_nodes<D>(law, model, slots, b, tape, pairs, by, left); });
  return left;
}

}  // namespace stickslip
