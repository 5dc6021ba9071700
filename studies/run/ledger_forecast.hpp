/// Forecast of the ledger of a run, from counts alone. Each amount has the factor by which it may be wrong.
#pragma once

#include "studies/input/scene_reader.hpp"
#include "studies/run/ledger.hpp"

namespace stickslip {

/// Rows and names are those of ledger(). Assumptions: no step is cut, each increment has one solution, and the output
/// is that of `run SCENE`. An amount that depends on the path is not known; its spread is 0.
Ledger forecast(const Input& input, const Problem& problem);

}  // namespace stickslip
