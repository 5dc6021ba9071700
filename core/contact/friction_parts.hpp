/// What the laws of friction are written with: the pieces of a bound, and the description of a number.
#pragma once

#include <optional>
#include <tuple>

#include "core/algebra/number.hpp"
#include "core/algebra/scalar.hpp"

namespace stickslip {

/// Which smooth piece of the projection a contact point is on. A frictionless point that is closed counts as slip: it
/// slides without resistance. `limited`: it slips at the law's limit.
enum class ContactState : unsigned char { open, stick, slip, limited };

/// Whether a point with this state slips.
inline bool is_slipping(ContactState state) { return state == ContactState::slip || state == ContactState::limited; }

enum class FrictionUnit { none, stress };

/// A number of a law: where it is, and how files, messages and pages name it. `Member`: T where the number must be
/// there, std::optional<T> where it may be left out.
template <class Law, class Member>
struct FrictionNumber {
  Member Law::*member;
  const char* key;          ///< in the object of the scene file
  const char* symbol;       ///< its value in a message that shows this object
  const char* description;  ///< for the schema and docs/scene.md; their unit is that of `unit`
  FrictionUnit unit;
  Range range;
  double example;
  const char* words;  ///< in front of its value in a sentence

  static constexpr bool is_required = !requires(Member value) { value.has_value(); };
};
template <class Law, class Member>
FrictionNumber(Member Law::*, const char*, const char*, const char*, FrictionUnit, Range, double, const char*)
    -> FrictionNumber<Law, Member>;

}  // namespace stickslip
