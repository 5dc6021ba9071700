/// The first thing a reader sees: the cheapest setting of each method at each accuracy, and why it is.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// A table with the methods in rows and, for responses and for derivatives, the accuracies in columns (those that the
/// study names, else 1 %, 1e-4 and 1e-6, and what this mesh itself is off by), and in words what makes the cheapest
/// cheap. HTML, of the main variant; empty where no error was measured.
struct Verdict {
  std::string reason, table;
  std::size_t rows = 0;  ///< of the table
};
Verdict verdict(const Study& study);

}  // namespace stickslip::report
