/// Certificates (docs/verify.md) on the pages of runs and of studies.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// What code that shares nothing with the solver found of each law, where it is nearest to its bound; empty where it
/// was not asked.
std::string certificate_of_run(const Study& run);

/// A line for each run, and for each solution of another program; empty of a study without the latter.
std::string certificates_of_study(const Study& study);

}  // namespace stickslip::report
