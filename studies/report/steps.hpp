/// The steps of a run whose fields were kept, one after another under a slider.
#pragma once

#include <string>

#include "studies/report/figure_html.hpp"

namespace stickslip::report {

/// HTML: pictures of the bodies with the states of their points, and the tractions of the step that the slider is at;
/// "" where fewer than two steps were kept.
std::string steps_of_run(const Study& run, Figures& figures);

}  // namespace stickslip::report
