/// A chart as a line drawing: for readers and printers without scripts, and for the files in DIR/figures.
#pragma once

#include <optional>

#include "studies/report/charts.hpp"
#include "studies/report/drawing.hpp"

namespace stickslip::report {

/// Widths of a chart in pixels of 1/96 inch, whose texts are 9 points then: two columns of a paper, 169 mm, and one, 85
/// mm.
constexpr double two_columns = 640, one_column = 320;

/// The rows that are chosen at first in one chart of a figure: curves, the values at their ends where these have room,
/// guides, the line of exact zeros, markers, crosses for failed runs, ticks at round numbers, a legend, and which of
/// the choices that the page offers is drawn. Nothing where no row can be drawn.
std::optional<Drawing> draw_plot(const Figure& figure, const Chart& chart, double width = two_columns);

/// One axis: values onto pixels, linear or logarithmic (over a decade at least), with some room at both ends, but none
/// below `low` where the axis is `bounded` there.
class Axis {
 public:
  Axis(double low, double high, bool logarithmic, double from, double to, bool bounded = false);
  double operator()(double value) const;
  /// Some four to eight round values inside the axis; fewer where it is short, or they are to lie `least_step` apart.
  std::vector<double> ticks(double least_step = 0) const;

 private:
  double scaled(double value) const;
  bool log_;
  double from_, to_, low_, high_;
};

/// The colour of a series in a drawing.
std::string color_of(const Series& series);

/// Looks of a series.
Style style_of(const Series& series, bool dashed);

}  // namespace stickslip::report
