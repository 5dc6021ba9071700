/// How a struct of the scene is written in a file, said beside its members. Reader, schema and messages are made from
/// it (studies/input/described.hpp). The struct says
///
///   key, about   the key that names it, and what it is
///   keys()       a tuple of Key: the keys of its object, in the order in which they are read
///   example      JSON of an example of its object, if the examples of the keys that must be there make no good one
#pragma once

#include <array>
#include <concepts>
#include <string>

#include "core/algebra/number.hpp"

namespace stickslip {

// How a key is written. Those with an example must be there, but an IfGiven and a Grade.

/// A number.
struct InRange {
  Range range;
  double example;
};
/// A number; left out, what the struct begins with.
struct IfGiven {
  Range range;
  double example;
};

/// A place: as many numbers as axes (a std::vector), or two (a std::array).
struct Place2D {
  std::array<double, 2> example;
};
/// A place in space, for structs that are in space alone.
struct Place3D {
  std::array<double, 3> example;
};
/// A generated mesh of the plane. `example`: JSON.
struct MeshInPlane {
  const char* example;
};
/// Four places in the plane.
struct Corners2D {
  std::array<std::array<double, 2>, 4> example;
};

/// A direction, as many numbers as axes, not all 0. `what` completes "must be ...".
struct Direction2D {
  const char* what;
  std::array<double, 2> example;
};

/// A direction in space, for structs that are in space alone.
struct Direction3D {
  const char* what;
  std::array<double, 3> example;
};

/// The angle in degrees at which a sector ends that starts at another. Where it ends after a full turn is where it
/// starts, and then its end is no number of its own. Left out, what the struct begins with.
template <class S>
struct EndOfTurn {
  Number S::*start;
  double example;
};
template <class S>
EndOfTurn(Number S::*, double) -> EndOfTurn<S>;

/// A number of cells; numbers of cells along two directions (a std::array), or one an axis (a std::vector).
struct Count {
  int example;
};
struct Counts {
  std::array<int, 2> example;
};

/// {SIDE: ratio, ...}: of each side, the ratio of the largest to the smallest cell, the smallest at the side. Left out,
/// what the struct begins with.
template <std::size_t n>
struct Grade {
  std::array<const char*, n> sides;
  double example;
};
template <std::size_t n>
Grade(std::array<const char*, n>, double) -> Grade<n>;

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
