/// Warnings of contacts that do not see all that they should: nodes of the master inside of the slave, contacts that
/// are narrower than a facet, obstacles that are turned inside out, nodes without an area, moments that do not balance.
#pragma once

#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// What warnings measure of a contact at a step.
ContactMeasures measures_of_contact(const Problem& problem, const State<double>& state, double time, int contact);

void add_contact_warnings(const CaseResult& result, std::vector<Warning>& warnings);

/// Those that are known before a run.
std::vector<Warning> contact_warnings_before(const Problem& problem);

}  // namespace stickslip
