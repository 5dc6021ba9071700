/// Every iterate of a run as text.
#pragma once

#include <string>

#include "methods/newton/trace.hpp"
#include "studies/report/cone_picture.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// For the terminal: a line an iterate, residuals, states and step length.
std::string trace_table(const Trace& trace);

/// The same with all digits, and of scenes with few contact points lambda, trial and traction of each.
std::string trace_csv(const Problem& problem, const Trace& trace);

/// Friction cones of a scene with few contact points; empty where it has many, or none with friction.
std::vector<report::ConePath> cone_paths(const Problem& problem, const Trace& trace);

}  // namespace stickslip
