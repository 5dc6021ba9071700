/// What the page says of itself in words: how to read it, what was simulated, and on which machine.
#pragma once

#include <string>

#include "studies/report/records.hpp"

namespace stickslip::report {

/// What the charts of a study mean, and what `work` is in this one. HTML, as all of these.
std::string how_to_read(const Study& study);

/// Scene, methods and options that tell no run from another; the scene in words; the study as given.
std::string what_was_simulated(const Study& study);

/// How to repeat it, the build and the machine of the first run, and whether others differ.
std::string provenance(const Study& study);

/// Whether shards were joined.
bool is_merged(const Study& study);

}  // namespace stickslip::report
