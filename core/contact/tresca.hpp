/// Tresca's friction: bound(p) = limit. At p = 0 it jumps, since an open point bears nothing.
#pragma once

#include "core/contact/friction_parts.hpp"

namespace stickslip {

template <class T>
struct Tresca {
  T limit{};  ///< >= 0, force per area

  static constexpr auto numbers() {
    return std::tuple{FrictionNumber{&Tresca::limit, "tresca", "force per area",
                                     "alone: the tangential traction that a closed point bears", FrictionUnit::stress,
                                     Range::not_negative, 5.0, "Tresca friction "}};
  }
  static constexpr const char* idle = "limit of friction, {:.6g},";
  static constexpr bool is_piecewise_linear = true;

  static bool has(ContactState piece) { return piece == ContactState::limited; }
  T bound(const T& /*pressure*/, ContactState /*piece*/) const { return limit; }
  T slope_at_apex() const { return T(0); }
  T slope_at_infinity() const { return T(0); }
};

}  // namespace stickslip
