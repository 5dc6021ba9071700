/// The points of bodies that flow, one by one, with what says which branch each takes.
#pragma once

#include "core/model/element_kernels.hpp"
#include "core/solids/hardening.hpp"

namespace stickslip {

template <class T>
struct FlowPoint {
  int body, element;
  Eigen::Index memory;  ///< the first number that it remembers, in History::bodies
  FlowTrial<T> trial;
  const Hardening<T>& hardening;
  double size;  ///< of its element: along the longer axis
};

/// Calls f(point) with each point that remembers, at a motion. `only`: elements that are visited; nullptr: all.
template <class T, class F>
void for_each_flow_point(const Model& model, const Slots<T>& slots, const BodyMotion<T>& at, const ElementLists* only,
                         F&& f) {
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    if (model.bodies[b].memory > 0)
      kernels_of<T>(model, b).flow_points({model, slots, b, only ? &(*only)[b] : nullptr}, at, std::ref(f));
}

}  // namespace stickslip
