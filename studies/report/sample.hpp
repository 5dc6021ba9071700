/// What of a large study the page shows run by run.
#pragma once

#include <filesystem>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// The study where it is small, else some of its runs: so many that a few hundred runs, and some 10 000 errors in all,
/// are left. Whole scene variants, the main one first, then others evenly spaced; of a main variant that is too large
/// itself, the runs that the tables of settings name, and others evenly spaced.
Study sample_of(const Study& study);

/// Reads what draws a run by its steps and contact points (convergence, tractions, film) for runs of the main variant,
/// the telling ones first, 60 at most.
void attach_curves(Study& study, const std::filesystem::path& directory);

/// Takes these parts, which are most of it, out of a row, and what the page says of the first run alone.
void drop_bulk(nlohmann::json& row, bool first);

}  // namespace stickslip::report
