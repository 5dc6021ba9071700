/// Why the cheapest run is the cheapest, in words.
#pragma once

#include <string>
#include <vector>

#include "studies/report/cheapest.hpp"

namespace stickslip::report {

/// Who is the cheapest at the first accuracy that any method reaches, what the others need, and who misses it: a
/// paragraph of HTML; "" where no run gets anywhere.
std::string reason(const std::vector<Row>& rows, const Measure& measure);

}  // namespace stickslip::report
