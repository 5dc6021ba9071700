/// Why the cheapest run is the cheapest, in words.
#pragma once

#include <string>
#include <vector>

#include "studies/report/cheapest.hpp"

namespace stickslip::report {

/// Who is the cheapest at the first accuracy that any method reaches (a tie where works are within 5 %), what the
/// others need, and who misses it: a paragraph of HTML; "" where no run gets anywhere. `variant`: of which scene that
/// is; "" where there is one.
std::string reason(const std::vector<Row>& rows, const Measure& measure, const std::string& variant);

}  // namespace stickslip::report
