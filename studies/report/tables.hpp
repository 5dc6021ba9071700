/// The tables of a report, as HTML. "" where there is nothing to show.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// Default, tuned and strict setting of each method side by side, in every scene.
std::string settings_table(const Study& study);

/// Every run with its errors and costs; failed ones too.
std::string results_table(const Study& study);

/// Responses and sensitivities at the last step, ten digits: enough to see where two runs part.
std::string values_table(const Study& study);

/// Status by setting and scene variant, where there are several.
std::string status_table(const Study& study);

}  // namespace stickslip::report
