/// Warnings of contacts that do not see all that they should: nodes of the master inside of the slave, contacts that
/// are narrower than a facet, obstacles that are turned inside out, nodes without an area, moments that do not balance.
#pragma once

#include <vector>

#include "core/model/warning.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// What warnings tell of a contact at a step.
ContactMeasures measures_of_contact(const Problem& problem, const State<double>& state, double time, int contact);

/// Why an obstacle cannot be what the contact means, in words that complete "NAME: ..."; empty: it can. Its solid is
/// where the slave is: no outward normal of the slave is against its own, or a closed slave is inside of it as a whole.
/// `faulty`: result, number of slave nodes.
std::string turned_surface(const Problem& problem, int contact, int& faulty);

/// Adds to the message of a run that failed the obstacles that are turned inside out.
void name_turned_surfaces(const Problem& problem, Trajectory<double>& trajectory);

void add_contact_warnings(const CaseResult& result, std::vector<Warning>& warnings);

/// Those that are known before a run.
std::vector<Warning> contact_warnings_before(const Problem& problem);

}  // namespace stickslip
