/// Closed forms that a study's responses are held against. Each is written once, in any scalar: in dual numbers it
/// gives the reference of the sensitivities too, with the derivatives of the measured inputs carried through.
///
/// hertz_line         [J85 4.2] two cylinders, force P per length: b = sqrt(4 P R/(pi E*)), p0 = 2 P/(pi b),
///                    p(x) = p0 sqrt(1 - x^2/b^2). Inputs: force. Outputs: peak_pressure, half_width.
/// cattaneo_mindlin   [J85 7.2] then sheared by Q < mu P: c = b sqrt(1 - Q/(mu P)),
///                    q(x) = mu p(x) - (c/b) mu p0 sqrt(1 - x^2/c^2) where |x| < c. Inputs: force, tangential_force.
///                    Outputs as hertz_line, and stick_half_width.
/// In both 1/E* = sum (1 - nu^2)/E over the two bodies of the contact (none for a rigid one), R is `radius`, the
/// relative radius 1/R = 1/R1 + 1/R2 (a length the mesh does not tell).
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/case.hpp"

namespace stickslip {

/// Reference values of a case by response name, and of its sensitivities.
struct ReferenceValues {
  std::map<std::string, double> responses;
  std::map<std::string, std::map<std::string, double>> sensitivities;  ///< response -> parameter
  nlohmann::json curves;  ///< per contact: {"x", "normal", "tangential"}; null where the closed form has none
};

/// One entry of a study's "reference": {"analytic": NAME, "map": {RESPONSE: QUANTITY}, "radius": R} or
/// {"values": {RESPONSE: v, "RESPONSE/PARAMETER": v}}, at the last step of `result`. What is wrong with the entry
/// comes back in `error`.
ReferenceValues reference_values(const nlohmann::json& entry, const CaseResult& result, std::string& error);

/// Quantities a closed form knows, inputs first; empty for an unknown name.
std::vector<std::string> analytic_quantities(const std::string& name);
std::vector<std::string> analytic_names();

}  // namespace stickslip
