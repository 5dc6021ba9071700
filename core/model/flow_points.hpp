/// The points of bodies that flow, one by one, with what says which branch each takes.
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

template <class T>
struct FlowPoint {
  int body, element;
  Eigen::Index memory;  ///< the first number that it remembers, in History::bodies
  FlowTrial<T> trial;
  const Hardening<T>& hardening;
  double size;  ///< of its element: along the longer axis
};

namespace detail {

template <class T, int D, int nodes>
double extent(const Mat<T, D, nodes>& coordinates) {
  const auto places = values(coordinates);
  return (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).maxCoeff();
}

}  // namespace detail

/// Calls f(point) with each point that remembers, at a motion. `only`: elements that are visited; nullptr: all.
template <class T, class F>
void for_each_flow_point(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at, const ElementLists* only,
                         F&& f) {
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b) {
    const auto& body = model.bodies[b];
    if (body.memory == 0) continue;
    const int count = only ? static_cast<int>((*only)[b].size()) : body.mesh.element_count();
    const auto element = [&](int k) { return only ? (*only)[b][k] : k; };
    const auto first_of = [&](int e) { return body.first_memory + static_cast<Eigen::Index>(e) * body.memory; };
    const auto continuum = [&]<class Shape, Kinematics kinematics, class L>(const L& law) {
      if constexpr (Remembers<L>)
        for (int k = 0; k < count; ++k) {
          const int e = element(k);
          const auto nodes = detail::element_nodes(body, e);
          const auto X = detail::gather_coordinates<T, Shape>(slots.points, nodes.data());
          auto before = detail::memory_of_element<L>(body, e, at.last_memory, at.branches);
          Eigen::Index memory = first_of(e);
          for_each_strain_in<T, Shape, kinematics>(
              law.is_finite, X, T(1), detail::gather_displacements<T, Shape>(at.displacement, nodes.data()),
              [&](const auto& H, const T&) {
                const int branch = before.branch();
                const auto trial = law.trial(H, before.template take<L::memory>(), branch);
                f(FlowPoint<T>{b, e, std::exchange(memory, memory + L::memory), trial, law.hardening,
                               detail::extent(X)});
              });
        }
    };
    const auto two_nodes = [&]<int D, class L>(const L& law) {
      if constexpr (Remembers<L>)
        for (int k = 0; k < count; ++k) {
          const int e = element(k);
          const auto nodes = detail::element_nodes(body, e);
          const auto X = detail::two_places<T, D>(slots.points, nodes);
          auto before = detail::memory_of_element<L>(body, e, at.last_memory, at.branches);
          const int branch = before.branch();
          const auto trial = law.template trial<D>(X, detail::two_node_stretch<T, D>(nodes, &at.displacement),
                                                   before.template take<L::memory>(), branch);
          f(FlowPoint<T>{b, e, first_of(e), trial, law.hardening, detail::extent(X)});
        }
    };
    detail::with_law<T>(model, slots, b, continuum, two_nodes);
  }
}

}  // namespace stickslip
