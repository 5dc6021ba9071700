/// The page of a single run: where it went, what it gave, what it took.
#pragma once

#include <string>
#include <vector>

#include "studies/report/figure_html.hpp"
#include "studies/report/page.hpp"
#include "studies/report/records.hpp"

namespace stickslip::report {

/// Scene, histories, and how the run ended. `run`: of read_run(). HTML.
std::string first_of_run(const Study& run, Figures& figures);

std::vector<Section> sections_of_run(const Study& run, Figures& figures);

}  // namespace stickslip::report
