/// How far the nearest change of a branch is from each step of a run: margins in one table, and a map of the distances
/// in units of the parameters.
#pragma once

#include <optional>
#include <string>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// The map, steps by parameters, coloured by the distance as a share of the parameter's value. Nothing where no step of
/// the run tells the distance: without parameters, and in adjoint mode.
std::optional<Plate> map_of_changes(const Study& run);

/// Margins, certificate and distances of every step, as HTML; "" of a run without parameters.
std::string table_of_margins(const Study& run);

}  // namespace stickslip::report
