/// Runs of one problem whose responses differ by more than their errors explain: then they are different solutions, or
/// one of them is wrong. Two converged runs a and b of a response r disagree if
///
///   |r_a - r_b| > max(1e-5 |r|, 10 (e_a + e_b) max(|r|, scale), 1e-9 scale)
///
///   |r|    its largest size in the runs of the problem
///   e      largest method-blind error of a run (errors.kkt): of a penalty, what its springs yield
///   scale  size that the kind of r has in these runs (`scales` of a row): beside it r may be rounding
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stickslip {

/// A sentence for each response that some runs disagree about: both runs, their values, how far apart these are, what
/// their errors explain, and what the runs warn of. Of several pairs and variants the pair whose difference is the
/// largest multiple of what is explained. Empty if all runs agree. `rows`: of a study.
std::vector<std::string> disagreements(const std::vector<const nlohmann::json*>& rows);

}  // namespace stickslip
