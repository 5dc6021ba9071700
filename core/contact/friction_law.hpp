/// The list of laws of friction, and what follows from any of them: how much tangential traction a closed point bears
/// under a pressure p.
///
/// A law has a file of its own, as core/contact/coulomb.hpp. Its bound is the least of at most two pieces, named by the
/// state of a point that slips on them:
///
///   slip      grows with the pressure from zero at p = 0; concave; its slope there is finite
///   limited   a constant
///
/// so that it is concave, with a corner where the two meet. Of a law the file says
///
///   numbers()                   its numbers, each with its range and words; the key of the first names the law in
///                               files
///   idle                        words for the first of them, which has no influence where no point slips
///   has(piece), bound(p, piece) in the scalar of the numbers; derivatives are those of its dual numbers
///   slope_at_apex()             slope of the piece `slip` where the pressure begins; 0 without such a piece
///   slope_at_infinity()         slope that the bound keeps however large the pressure
///   is_piecewise_linear         whether `slip` is a multiple of p. Solutions by trial of all branches
///                               (methods/rescue/solutions) are for such laws alone, and only these may have both
///                               pieces.
///
/// What it lacks does not compile. Reader, schema and words are made from numbers() (studies/input/friction_laws.hpp).
#pragma once

#include <cmath>
#include <concepts>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "core/contact/coulomb.hpp"
#include "core/contact/tresca.hpp"

namespace stickslip {

/// What a scene may name.
template <class T>
using FrictionLaws = std::variant<Coulomb<T>, Tresca<T>>;

template <class L>
concept WholeFrictionLaw = requires(const L& law, const double& pressure, ContactState piece) {
  { std::get<0>(L::numbers()).key } -> std::convertible_to<const char*>;
  { L::idle } -> std::convertible_to<const char*>;
  { L::is_piecewise_linear } -> std::convertible_to<bool>;
  { law.has(piece) } -> std::same_as<bool>;
  { law.bound(pressure, piece) } -> std::same_as<double>;
  { law.slope_at_apex() } -> std::same_as<double>;
  { law.slope_at_infinity() } -> std::same_as<double>;
};

namespace detail {

template <class L>
constexpr bool is_whole_law() {
  static_assert(WholeFrictionLaw<L>, "a law of friction lacks something");
  return true;
}
template <class... L>
constexpr bool are_whole_laws(const std::variant<L...>*) {
  return (is_whole_law<L>() && ...);
}
static_assert(are_whole_laws(static_cast<const FrictionLaws<double>*>(nullptr)));

/// Calls f(number, value) for each number of a law that is there.
template <class L, class F>
void for_each_number(L& law, F&& f) {
  const auto call = [&](const auto& number) {
    auto& member = law.*number.member;
    if constexpr (std::decay_t<decltype(number)>::is_required)
      f(number, member);
    else if (member)
      f(number, *member);
  };
  std::apply([&](const auto&... number) { (call(number), ...); }, L::numbers());
}

template <class From, class To, class Cast>
void cast_number(const From& from, To& to, Cast& cast) {
  if constexpr (requires { from.has_value(); }) {
    if (from) to = cast(*from);
  } else {
    to = cast(from);
  }
}

}  // namespace detail

/// One of the laws.
template <class T>
struct FrictionLaw {
  FrictionLaws<T> law;

  FrictionLaw() = default;  ///< bears nothing: Coulomb's, with mu = 0
  template <std::convertible_to<T> U>
  FrictionLaw(const U& mu) : law(Coulomb<T>{T(mu)}) {}  // NOLINT: a number alone is Coulomb's
  template <template <class> class L>
  FrictionLaw(L<T> of) : law(std::move(of)) {}  // NOLINT: a law is one

  /// Whether the bound has a piece: slip or limited.
  bool has(ContactState slip) const {
    return std::visit([&](const auto& of) { return of.has(slip); }, law);
  }
  int piece_count() const { return has(ContactState::slip) + has(ContactState::limited); }
  bool is_piecewise_linear() const {
    return std::visit([](const auto& of) { return of.is_piecewise_linear; }, law);
  }
  /// Bound on the piece that `slip` names: slip or limited. pre: it has this piece.
  T bound(const T& pressure, ContactState slip) const {
    return std::visit([&](const auto& of) { return of.bound(pressure, slip); }, law);
  }
  /// The piece that holds at a pressure; at the corner the sloping one.
  ContactState piece(double pressure) const {
    return std::visit([&](const auto& of) { return piece_of(of, pressure); }, plain().law);
  }
  /// Bound at a pressure, without derivative.
  double bound(double pressure) const requires(!std::same_as<T, double>) { return plain().bound(pressure); }
  double bound(double pressure) const requires std::same_as<T, double> {
    return std::visit([&](const auto& of) { return of.bound(pressure, piece_of(of, pressure)); }, law);
  }
  /// Whether the bound of a piece follows the pressure. Without pressure such a piece bears nothing.
  static bool follows_pressure(ContactState slip) { return slip != ContactState::limited; }
  /// Pressure at the corner between two pieces; none where there is one piece.
  std::optional<double> corner() const {
    if (piece_count() < 2) return std::nullopt;
    return plain().bound(0.0, ContactState::limited) / value(slope_at_apex());
  }
  /// Difference between the bounds of two pieces, force per area: zero at their corner; infinity where there is one.
  double distance_to_corner(double pressure) const {
    if (piece_count() < 2) return std::numeric_limits<double>::infinity();
    const auto of = plain();
    return std::abs(of.bound(pressure, ContactState::slip) - of.bound(pressure, ContactState::limited));
  }
  /// Slope of the bound where the pressure begins; 0 where it does not follow the pressure.
  T slope_at_apex() const {
    return std::visit([](const auto& of) { return of.slope_at_apex(); }, law);
  }
  /// Slope that the bound keeps however large the pressure.
  double slope_at_infinity() const {
    return std::visit([](const auto& of) { return of.slope_at_infinity(); }, plain().law);
  }
  /// Whether a point that is closed without pressure bears nothing: its cone has an apex.
  bool has_apex() const { return bound(0.0) == 0; }
  /// Whether no pressure makes it bear anything. A concave bound that is zero at one pressure is zero at all.
  bool bears_nothing() const { return bound(1.0) == 0; }
  /// Whether the bound depends on the pressure: the tangent of a slipping point is unsymmetric then.
  bool couples() const { return has(ContactState::slip); }
  /// Calls f(number, value) for each number that is there, number being its FrictionNumber.
  template <class F>
  void for_each_number(F&& f) const {
    std::visit([&](const auto& of) { detail::for_each_number(of, f); }, law);
  }
  /// Numbers that it consists of.
  int size() const {
    int count = 0;
    for_each_number([&](auto&&...) { ++count; });
    return count;
  }
  /// The one that names it.
  const T& first_number() const {
    return std::visit([](const auto& of) -> const T& { return of.*std::get<0>(of.numbers()).member; }, law);
  }

  /// The law of tractions in units of `stress`.
  FrictionLaw in_units_of(const T& stress) const {
    FrictionLaw out = *this;
    std::visit(
        [&](auto& of) {
          detail::for_each_number(of, [&](const auto& number, T& x) {
            if (number.unit == FrictionUnit::stress) x /= stress;
          });
        },
        out.law);
    return out;
  }
  /// The law whose numbers are cast(number).
  template <class U, class Cast>
  FrictionLaw<U> as(Cast&& cast) const {
    return std::visit(
        [&]<template <class> class L>(const L<T>& from) -> FrictionLaw<U> {
          L<U> to;
          constexpr auto size = std::tuple_size_v<decltype(L<T>::numbers())>;
          [&]<std::size_t... i>(std::index_sequence<i...>) {
            (detail::cast_number(from.*std::get<i>(L<T>::numbers()).member, to.*std::get<i>(L<U>::numbers()).member,
                                 cast),
             ...);
          }
          (std::make_index_sequence<size>());
          return to;
        },
        law);
  }

 private:
  FrictionLaw<double> plain() const {
    return as<double>([](const T& x) { return value(x); });
  }
  template <class L>
  static ContactState piece_of(const L& of, double pressure) {
    if (!of.has(ContactState::limited)) return ContactState::slip;
    if (!of.has(ContactState::slip)) return ContactState::limited;
    return of.bound(pressure, ContactState::slip) > of.bound(pressure, ContactState::limited) ? ContactState::limited
                                                                                              : ContactState::slip;
  }
};

}  // namespace stickslip
