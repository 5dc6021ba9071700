/// A study: every cell (a method with its options on a variant of the scene) is run, measured against the references,
/// and recorded as one line of DIR/results.jsonl as soon as it is done. (docs/study.md)
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/run/case.hpp"
#include "studies/sweep/references.hpp"

namespace stickslip {

/// Errors of a case by name: "response:NAME", "sensitivity:NAME/PARAMETER", "field:normal_traction", ...
using Errors = std::map<std::string, double>;

/// Against a case on the same mesh: what enforcing the constraint this way costs in accuracy. Response: largest
/// difference over the steps / largest reference value; sensitivity: the same, the scale at least response / size of
/// the parameter (its value or, if that is zero, the least change that would change a response by its own size, or by
/// scale_of() if that is larger); field: relative L2 difference of the tractions of the last step, area weighted. Empty
/// where the steps differ (one of the two stopped early).
Errors enforcement_errors(const CaseResult& result, const CaseResult& reference);

/// Against closed forms or given values, at the last step: what the mesh and the steps cost.
Errors discretisation_errors(const CaseResult& result, const ReferenceValues& reference);

/// What an error is relative to.
struct ErrorScale {
  double size = 0;
  bool referred = false;  ///< whether the reference has a value, of which it then is
};

/// By the names of discretisation_errors(), of all that the last step has: the size of the reference value, or, where
/// there is none or it is zero, of the result's own.
std::map<std::string, ErrorScale> error_scales(const CaseResult& result, const ReferenceValues& reference);

/// Whether an error is asked for by patterns such as "response:*", "sensitivity:press/*", "kkt".
bool asked_for(const std::string& name, const std::vector<std::string>& patterns);

}  // namespace stickslip
