/// A piece of segment-integrated contact (core/contact/segments.hpp).
#pragma once

#include <array>

namespace stickslip {

/// Part of a slave facet that faces one master facet, or an obstacle.
struct Piece {
  static constexpr int start = -1, end = -2;  ///< ends of the slave facet
  static constexpr int none = -1;
  std::array<int, 2> slave{};               ///< nodes a -> b, solid on the left
  std::array<int, 2> master{{none, none}};  ///< nodes c -> d; none: the obstacle of the contact
  int facet = none;                         ///< of the master, by number
  int first_end = start, last_end = end;    ///< ends of the piece: of the facet, or the master node projected there
  int carrier = 0;                          ///< which of the two slave nodes carries the multiplier
  bool whole = false;                       ///< psi = 1: the other node carries none
  friend bool operator==(const Piece&, const Piece&) = default;
};

}  // namespace stickslip
