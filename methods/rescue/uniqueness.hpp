/// Whether an increment has one solution.
#pragma once

namespace stickslip {

/// What is known of the number of an increment's solutions (solutions.hpp).
enum class Uniqueness {
  unique,    ///< no combination of branches has a negative determinant; or this is not known, as bodies can move
             ///< although all points stick
  critical,  ///< none is negative, and some vanish, though no constraints repeat one another: under some loads
             ///< solutions are a continuum
  several    ///< some are negative: under some loads there are several
};

}  // namespace stickslip
