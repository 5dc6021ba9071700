/// A panel as a plain SVG, for readers and printers without scripts.
#pragma once

#include <string>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// Inline SVG of the rows that are chosen at first in one panel of a figure: curves, markers, crosses for failed runs,
/// ticks at round numbers, a legend. "" where no row can be drawn.
std::string draw_plot(const Figure& figure, const Panel& panel);

}  // namespace stickslip::report
