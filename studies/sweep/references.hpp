/// What the results of a case are held against: closed forms, given values, another run.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "studies/run/case.hpp"

namespace stickslip {

/// Reference values of a case by name of the response or objective, and of its sensitivities.
struct ReferenceValues {
  std::map<std::string, double> responses;
  std::map<std::string, std::map<std::string, double>> sensitivities;  ///< response -> parameter
  /// Per contact {"x" or "s" (length along its points), "normal", "tangential"}; null where the closed form has none.
  nlohmann::json curves;
};

/// One entry of a study's "reference" at the last step of `result`:
///   {"values": {RESPONSE: v, "RESPONSE/PARAMETER": v}}
///   {"analytic": NAME, "map": {RESPONSE: QUANTITY}, "inputs": {QUANTITY: number or PARAMETER}}
/// A response that the map gives an input's name is measured and goes into the closed form, with its derivatives; one
/// with an output's name is held against it. `modulus` and `friction` that are not given are those of the first
/// contact. Empty where the closed form says nothing (no force presses). pre: read_study found no fault in the entry.
ReferenceValues reference_values(const nlohmann::json& entry, const CaseResult& result);

/// Responses and sensitivities of the last step of another run, its objectives and their gradients.
ReferenceValues values_of(const CaseResult& result);

}  // namespace stickslip
