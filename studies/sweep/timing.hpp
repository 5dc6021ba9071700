/// How long the cells of a study take, measured apart from what they give: serially, after all of them are known.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stickslip {

struct TimedRun {
  std::size_t cell;
  int round;  ///< from 1
};

/// The runs of a timing pass. Cells with one key share a problem and are timed together: each round runs all of them
/// once, forwards in odd rounds and backwards in even ones, so that a machine that grows slower or faster meanwhile
/// favours none. `keys`: one per cell, equal ones adjacent.
std::vector<TimedRun> timing_plan(const std::vector<std::string>& keys, int repeat);

/// Least of each kind of seconds over the runs (noise only adds), and the median. pre: at least one run; all objects
/// with the same keys.
nlohmann::json least_seconds(const std::vector<nlohmann::json>& runs);
nlohmann::json median_seconds(const std::vector<nlohmann::json>& runs);

}  // namespace stickslip
