/// Of a study of several scenes: which method is the cheapest for each.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// A table with a row for each scene and a column for each accuracy; "" of a study of one scene, or without errors.
std::string cheapest_by_scene(const Study& study);

}  // namespace stickslip::report
