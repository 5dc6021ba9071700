/// Every iterate of a run as text.
#pragma once

#include <string>

#include "methods/trace.hpp"
#include "studies/case.hpp"

namespace stickslip {

/// For the terminal: a line an iterate, residuals, states and step length.
std::string trace_table(const Trace& trace);

/// The same with all digits, and of scenes with few contact points lambda, trial and traction of each.
std::string trace_csv(const Problem& problem, const Trace& trace);

}  // namespace stickslip
