/// The ledger of a run before it: from counts alone, each amount with the factor that it holds to.
#pragma once

#include "studies/input/scene_reader.hpp"
#include "studies/run/ledger.hpp"

namespace stickslip {

/// Rows and names are those of ledger(). It supposes that no step is cut, that each increment has one solution, and
/// that no more is written than `run SCENE` does. What hangs on the path is not known: `within` is 0.
Ledger forecast(const Input& input, const Problem& problem);

}  // namespace stickslip
