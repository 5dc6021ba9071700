/// Coulomb's friction, and Coulomb's with a shear limit, as of a yielding surface.
///
///   bound(p) = mu p               coefficient alone
///   bound(p) = min(mu p, limit)   both; the corner is at mu p = limit
///
/// E. Orowan, Proc. Inst. Mech. Eng. 150 (1943) 140-167 (limit); [AC91] (Coulomb).
#pragma once

#include "core/contact/friction_parts.hpp"

namespace stickslip {

template <class T>
struct Coulomb {
  T coefficient{};              ///< mu >= 0
  std::optional<T> limit = {};  ///< >= 0, force per area

  static constexpr auto numbers() {
    return std::tuple{FrictionNumber{&Coulomb::coefficient, "coulomb", "mu",
                                     "coefficient mu: at most mu p tangentially, p the pressure", FrictionUnit::none,
                                     Range::not_negative, 0.3, "Coulomb friction "},
                      FrictionNumber{&Coulomb::limit, "limit", "force per area", "but no more than this",
                                     FrictionUnit::stress, Range::not_negative, 5.0, ", limited to "}};
  }
  static constexpr const char* idle = "friction coefficient of {:.6g}";
  static constexpr bool is_piecewise_linear = true;

  bool has(ContactState piece) const { return piece == ContactState::slip || limit; }
  T bound(const T& pressure, ContactState piece) const {
    return piece == ContactState::limited ? *limit : T(coefficient * pressure);
  }
  T slope_at_apex() const { return coefficient; }
  T slope_at_infinity() const { return limit ? T(0) : coefficient; }
};

}  // namespace stickslip
