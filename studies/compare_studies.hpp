/// Two recordings of a study held against each other, cell by cell.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/result_rows.hpp"

namespace stickslip {

/// What passes as rounding.
struct ComparisonBands {
  double relative = 0.05;   ///< of an error: it may grow by this share of itself
  double rounding = 1e-11;  ///< and by this: errors are relative, and this is what a change in the order of sums may do
};

/// A quantity that differs: a status, a count or an error.
struct Change {
  std::string quantity;  ///< "status", "count newton", "enforcement response:press", ...
  nlohmann::json before, after;
  double size = 0;  ///< |log10(after / before)|, with the rounding band as the least value; a status: infinity
  bool worse = false;
};

/// One cell, named by what it is, not by its id, which another version of the program changes.
struct CellComparison {
  std::string label, variant;
  bool only_before = false, only_after = false;
  std::vector<Change> changes;  ///< those beyond the bands, largest first
  double seconds_before = 0, seconds_after = 0;

  bool worse() const;
  double size() const;
};

/// Cells of both, those with the largest change first. A count is worse where it is larger, an error where it grew
/// beyond the bands, a status where it was converged and no longer is; a cell that is gone is worse.
std::vector<CellComparison> compare_rows(const RowsById& before, const RowsById& after, const ComparisonBands& bands);

}  // namespace stickslip
