/// Two recordings of a study held against each other, cell by cell.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/io/result_rows.hpp"

namespace stickslip {

/// What passes as rounding.
struct ComparisonBands {
  double relative = 0.05;  ///< of an error: it may grow by this share of itself
  /// And by this: errors are relative, and this is what a change in the order of sums may do. As much of its largest
  /// size in any cell a response or a sensitivity may differ by: one that is zero but for rounding has no own size.
  double rounding = 1e-11;
};

/// A quantity that differs: the scene (by its hash), a status, a count, an error, a response or a sensitivity.
struct Change {
  std::string quantity;  ///< "scene", "status", "count newton", "enforcement response:press", "response press", ...
  nlohmann::json before, after;
  /// |log10(after / before)|, with the rounding band as the least value; of a response or sensitivity log10(1 +
  /// relative difference); of a scene or status infinity.
  double size = 0;
  bool worse = false;
};

/// One cell, named by what it is, not by its id, which another version of the program changes.
struct CellComparison {
  std::string label, variant;
  bool only_before = false, only_after = false;
  std::vector<Change> changes;  ///< those beyond the bands, largest first
  double seconds_before = 0, seconds_after = 0;

  bool worse() const;
  bool other_scene() const;
  double size() const;
};

/// Cells of both, those with the largest change first. A count is worse where it is larger, an error where it grew
/// beyond the bands, a status where it was converged and no longer is; a cell that is gone is worse. A response, a
/// sensitivity or a scene is only another one.
std::vector<CellComparison> compare_rows(const RowsById& before, const RowsById& after, const ComparisonBands& bands);

/// Why the two cannot be recordings of one study: "they have no cell in common", or those in common are of unlike
/// scenes with no response in common; "" where they can.
std::string unrelated(const RowsById& before, const RowsById& after);

}  // namespace stickslip
