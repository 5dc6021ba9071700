/// The oracle: the whole program at T = complex<double>, one parameter shifted by an imaginary step. No difference, no
/// subtraction: the imaginary part of a response over the step is its derivative to rounding.
#pragma once

#include <vector>

#include "methods/method.hpp"

namespace stickslip::oracle {

/// Derivatives of all responses along a motion of all parameters at every increment of a replayed run: responses x
/// increments. `motion`: per parameter.
Matrix<double> complex_step(const Model& model, const Method& method, const std::vector<double>& step_table,
                            const Vector<double>& motion);
/// The same with respect to parameter j. `replay`: what is repeated, and where it begins.
Matrix<double> complex_step(const Model& model, const Method& method, const RunOptions& replay, int j);
/// The same of increments that begin where the last one ended.
Matrix<double> complex_step(const Model& model, const Method& method, const std::vector<double>& step_table, int j);

}  // namespace stickslip::oracle
