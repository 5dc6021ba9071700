/// The law of friction: how much tangential traction a closed point bears under a pressure p.
///
///   bound(p) = mu p               coefficient alone: Coulomb
///   bound(p) = min(mu p, limit)   both: Coulomb with a shear limit, as of a yielding surface (Orowan)
///   bound(p) = limit              limit alone: Tresca; at p = 0 it jumps, since an open point bears nothing
///
/// It is the least of a multiple of p and a constant, hence concave, with a corner where mu p = limit. Here stand the
/// bound, its linear pieces, their corner, its slopes, and what it says of the apex of the cone (p = 0). Two kinds of
/// code take it apart into its pieces: methods/solutions and statics, which look for all solutions, and
/// sensitivity/branches and rays, which know the sides of the corner. All else asks the law.
/// E. Orowan, Proc. Inst. Mech. Eng. 150 (1943) 140-167 (limit); [AC91] (Coulomb).
#pragma once

#include <cassert>
#include <cmath>
#include <concepts>
#include <limits>
#include <optional>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Which smooth piece of the projection a contact point is on. A frictionless point that is closed counts as slip: it
/// slides without resistance. `limited`: it slips at the law's limit.
enum class ContactState : unsigned char { open, stick, slip, limited };

/// Whether a point with this state slips.
inline bool is_slipping(ContactState state) { return state == ContactState::slip || state == ContactState::limited; }

/// The kinds of law, for who tells them apart in words: a switch that lacks one does not compile.
enum class FrictionKind { coulomb, limited_coulomb, tresca };

/// At least one of its numbers is there.
template <class T>
struct FrictionLaw {
  std::optional<T> coefficient;  ///< mu >= 0
  std::optional<T> limit;        ///< >= 0, force per area

  FrictionLaw() : coefficient(T(0)) {}  ///< bears nothing
  template <std::convertible_to<T> U>
  FrictionLaw(const U& mu) : coefficient(mu) {}  // NOLINT: a number alone is Coulomb's
  FrictionLaw(std::optional<T> mu, std::optional<T> most) : coefficient(std::move(mu)), limit(std::move(most)) {
    assert(coefficient || limit);
  }

  FrictionKind kind() const {
    if (!coefficient) return FrictionKind::tresca;
    return limit ? FrictionKind::limited_coulomb : FrictionKind::coulomb;
  }
  /// Bound on the piece that `slip` names: slip or limited.
  T bound(const T& pressure, ContactState slip) const {
    return slip == ContactState::limited ? *limit : T(*coefficient * pressure);
  }
  /// The piece that holds at a pressure; at the corner the sloping one.
  ContactState piece(double pressure) const {
    if (!coefficient) return ContactState::limited;
    return limit && value(*coefficient) * pressure > value(*limit) ? ContactState::limited : ContactState::slip;
  }
  /// Bound at a pressure, without derivative.
  double bound(double pressure) const {
    return piece(pressure) == ContactState::limited ? value(*limit) : value(*coefficient) * pressure;
  }
  /// Whether the bound of a piece follows the pressure. Without pressure such a piece bears nothing.
  static bool follows_pressure(ContactState slip) { return slip != ContactState::limited; }
  /// Pressure at the corner between two pieces; none where there is one piece.
  std::optional<double> corner() const {
    if (!coefficient || !limit) return std::nullopt;
    return value(*limit) / value(*coefficient);
  }
  /// Difference between the bounds of two pieces, force per area: zero at their corner; infinity where there is one.
  double distance_to_corner(double pressure) const {
    if (!coefficient || !limit) return std::numeric_limits<double>::infinity();
    return std::abs(value(*coefficient) * pressure - value(*limit));
  }
  /// Slope of the bound where the pressure begins: mu, or 0.
  T slope_at_apex() const { return coefficient ? *coefficient : T(0); }
  /// Slope that the bound keeps however large the pressure: mu, or 0.
  double slope_at_infinity() const { return limit ? 0 : value(*coefficient); }
  /// Whether a point that is closed without pressure bears nothing: its cone has an apex.
  bool has_apex() const { return coefficient.has_value() || value(*limit) == 0; }
  /// Whether no pressure makes it bear anything.
  bool bears_nothing() const { return (coefficient && value(*coefficient) == 0) || (limit && value(*limit) == 0); }
  /// Whether the bound depends on the pressure: the tangent of a slipping point is unsymmetric then.
  bool couples() const { return coefficient.has_value(); }
  /// Numbers that it consists of.
  int size() const { return (coefficient ? 1 : 0) + (limit ? 1 : 0); }

  /// The law of tractions in units of `stress`.
  FrictionLaw in_units_of(const T& stress) const {
    FrictionLaw law = *this;
    if (limit) *law.limit /= stress;
    return law;
  }
  template <class U, class Cast>
  FrictionLaw<U> as(Cast&& cast) const {
    std::optional<U> mu, most;
    if (coefficient) mu = cast(*coefficient);
    if (limit) most = cast(*limit);
    return {std::move(mu), std::move(most)};
  }
};

}  // namespace stickslip
