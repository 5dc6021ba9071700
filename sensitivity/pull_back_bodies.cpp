#include "sensitivity/pull_back_bodies.hpp"

#include "core/solids/element_work.hpp"

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

/// The elements of a continuum: each is differentiated by its own inputs, for all increments together.
template <class Shape, Kinematics kinematics, class L>
void pull_back_continuum(const L& law, const Model& model, const Slots<Reverse>& slots, int b, const WorkPairs& pairs,
                         std::vector<double>& by) {
  const auto& body = model.bodies[b];
  const auto [plain, numbers] = plain_law(law);
  const Reverse& thickness = slots.depths[b].thickness;
  std::vector<StateOfElement<Shape::nodes>> states(pairs.weights.cols());
  for (int e = 0; e < body.mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(body, e);
    Mat<double, 2, Shape::nodes> X;
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < 2; ++i) X(i, a) = slots.points(i, nodes[a]).v;
    for (Eigen::Index n = 0; n < pairs.weights.cols(); ++n) {
      StateOfElement<Shape::nodes>& state = states[n];
      for (int a = 0; a < Shape::nodes; ++a)
        for (int i = 0; i < 2; ++i) {
          state.motion(i, a) = pairs.motions(2 * nodes[a] + i, n);
          state.weight(i, a) = pairs.weights(2 * nodes[a] + i, n);
        }
    }
    const auto work = element_work<Shape, kinematics>(plain, X, thickness.v, states);
    const auto add = [&](const Reverse& input, double derivative) {
      if (input.at >= 0) by[input.at] += derivative;
    };
    for (int a = 0; a < Shape::nodes; ++a)
      for (int i = 0; i < 2; ++i) add(slots.points(i, nodes[a]), work.coordinates(i, a));
    add(thickness, work.depth);
    for (std::size_t k = 0; k < numbers.size(); ++k) add(numbers[k], work.law[k]);
  }
}

/// Elements of two nodes: each is recorded behind what the tape holds, increment by increment, and taken off again.
template <int D, class L>
void pull_back_two_nodes(const L& law, const Model& model, const Slots<Reverse>& slots, int b, Tape& tape,
                         const WorkPairs& pairs, std::vector<double>& by) {
  const int start = tape.size();
  for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e) {
    const auto nodes = detail::element_nodes(model.bodies[b], e);
    const auto X = detail::two_places<Reverse, D>(slots.points, nodes);
    const auto stretch = [&](const Matrix<double>& of, Eigen::Index n) -> Vec<double, D> {
      return of.col(n).template segment<D>(nodes[1] * D) - of.col(n).template segment<D>(nodes[0] * D);
    };
    for (Eigen::Index n = 0; n < pairs.weights.cols(); ++n) {
      const Vec<Reverse, D> d = stretch(pairs.motions, n).template cast<Reverse>();
      const Vec<double, D> weight = stretch(pairs.weights, n);
      const Vec<Reverse, D> force = law.template force<D>(X, d);
      by.resize(tape.size(), 0);
      for (int i = 0; i < D; ++i)
        if (force[i].at >= 0) by[force[i].at] += weight[i];
      tape.pull_back(by, start);
      by.resize(start);
      tape.rewind(start);
    }
  }
}

}  // namespace

void pull_back_bodies(const Model& model, const Slots<Reverse>& slots, Tape& tape, const WorkPairs& pairs,
                      std::vector<double>& by) {
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    detail::with_law<Reverse>(
        model, slots, b,
        [&]<class Shape, Kinematics kinematics>(const auto& law) {
          pull_back_continuum<Shape, kinematics>(law, model, slots, b, pairs, by);
        },
        [&]<int D>(const auto& law) { pull_back_two_nodes<D>(law, model, slots, b, tape, pairs, by); });
}

}  // namespace stickslip
