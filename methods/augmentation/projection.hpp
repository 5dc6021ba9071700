/// The projection of an extrapolated multiplier onto the friction cones (core/contact/friction_cone.hpp).
#pragma once

#include "core/model/slots.hpp"

namespace stickslip {

namespace detail {

/// The multiplier in the friction cones. Compression is kept and tension set to zero; the tangential part is shortened
/// to the bound.
template <class T>
Vector<T> projected_multiplier(const Model& model, const Slots<T>& slots, Vector<T> multiplier) {
  for (const auto& point : model.points) {
    T& normal = multiplier[point.multiplier];
    if (value(normal) > 0) normal = T(0);
    if (point.tangents == 0) continue;
    auto tangential = multiplier.segment(point.multiplier + 1, point.tangents);
    const auto& law = slots.friction[point.contact];
    const double bound = law.bound(-value(normal)), magnitude = norm(values(tangential));
    if (magnitude > bound) tangential *= law.bound(T(-normal), law.piece(-value(normal))) / norm(tangential);
  }
  return multiplier;
}

}  // namespace detail

}  // namespace stickslip
