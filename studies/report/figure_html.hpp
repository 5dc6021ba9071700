/// Figures as HTML: what a reader switches, the chart, and its data for the page's script.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/report/charts.hpp"

namespace stickslip::report {

/// What a page shows, kept for the files beside it.
class Figures {
 public:
  /// The figure as HTML; "" where there is none.
  std::string show(std::optional<Figure> figure);
  std::string show(std::optional<Plate> plate);
  /// Side by side where both are there, open, and the figure has one panel; else one below the other.
  std::string beside(std::optional<Figure> figure, std::optional<Plate> plate);

  std::vector<Figure> figures;
  std::vector<Plate> plates;
};

}  // namespace stickslip::report
