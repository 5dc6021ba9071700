/// Warnings of elements that lock: of those whose pressure cannot follow a material that keeps its volume, and of those
/// that cannot bend.
///
///   locking        Q4 or T3, nu near 1/2: pressures that oscillate within and between elements
///   shear_locking  Q4 or T3, one element thick, that bend: a shear that varies within elements
#pragma once

#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

void add_locking_warnings(const CaseResult& result, std::vector<Warning>& warnings);

/// Measure of locking of a body: root mean square over its volume of the pressure that remains after the dilatation is
/// averaged over the elements around each node, over that of the stress. 0 unless the body is of Q4 without mean
/// dilatation or of T3; 0 in plane stress.
double spurious_pressure(const Problem& problem, const State<double>& state, std::size_t body);
/// The same where a warning may be made of it, else 0.
double watched_pressure(const Problem& problem, const State<double>& state, std::size_t body);

/// Measure of shear locking of a body of Q4 or T3 that is one element thick: the share, in the squared strain of the
/// body, of shears along and across it that vary within elements or from each to those around it. Bending makes them
/// where an element has no curvature: a third in squares, more in longer elements. 0 for other bodies.
double parasitic_shear(const Problem& problem, const State<double>& state, std::size_t body);

}  // namespace stickslip
