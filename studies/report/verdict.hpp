/// The first thing a reader sees: the cheapest setting of each method at each accuracy, and why it is.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// A table with the methods in rows and, for responses and for derivatives, the accuracies in columns (those that the
/// study names, else 1 %, 1e-4 and 1e-6, and what this mesh itself is off by), below it a sentence that says what makes
/// the cheapest cheap. HTML, of the main variant; "" where no error was measured.
std::string verdict(const Study& study);

}  // namespace stickslip::report
