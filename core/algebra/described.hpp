/// How a struct of the scene is written in a file, said beside its members. Reader, schema and messages are made from
/// it (studies/input/described.hpp). The struct says
///
///   key, about   the key that names it, and what it is
///   keys()       a tuple of Key: the keys of its object, in the order in which they are read
#pragma once

#include <array>
#include <concepts>

#include "core/algebra/number.hpp"

namespace stickslip {

/// A number that must be there.
struct InRange {
  Range range;
  double example;
};

/// A place that must be there: as many numbers as axes (a std::vector), or two (a std::array).
struct Place2D {
  std::array<double, 2> example;
};

/// A direction that must be there, as many numbers as axes, not all 0. `what` completes "must be ...".
struct Direction2D {
  const char* what;
  std::array<double, 2> example;
};

/// true or false; left out, what the struct begins with.
struct Flag {};

/// A key, the member that it becomes, its meaning with its unit, and how it is written: one of those above, or, of an
/// enumeration, an array of its words in its order. Left out, it is what the struct begins with.
template <class S, class Member, class How>
struct Key {
  Member S::*member;
  const char *key, *about;
  How how;
};
template <class S, class Member, class How>
Key(Member S::*, const char*, const char*, How) -> Key<S, Member, How>;

template <class S>
concept Described = requires {
  { S::key } -> std::convertible_to<const char*>;
  { S::about } -> std::convertible_to<const char*>;
  S::keys();
};

}  // namespace stickslip
