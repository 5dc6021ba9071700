/// The settings a user would compare: each method as it comes, tuned, and as strict as it goes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/report/records.hpp"

namespace stickslip::report {

enum class Of { responses, sensitivities };

constexpr double much_the_same = 1.05;  ///< work within 5 % of the least names no winner

/// Worst enforcement error of the kind; nothing where the study has no reference on the same mesh.
std::optional<double> accuracy(const Cell& cell, Of of);

/// Work of the solution, or of it and its derivatives.
double work_of(const Cell& cell, Of of);

/// Whether some converged run of the main variant errs by more than rounding; where none does, charts order noise.
bool tells_apart(const Study& study, Of of);

/// What the mesh itself is off by: the worst error, against the study's discretisation reference, of the run of the
/// main variant that enforces contact best.
std::optional<double> own_error(const Study& study, Of of);

/// The error to compare at: 1e-6, or the strictest power of ten that some converged run reached; nothing without one.
std::optional<double> target_error(const Study& study, Of of);

/// A scene variant with the error that is asked for.
struct Problem {
  std::string variant;
  double target;
};

/// How one method fares with one way of setting it, on each problem.
struct Contestant {
  enum class Setting { standard, tuned, strict };
  std::string family;
  Setting setting;
  std::vector<const Cell*> cells;  ///< one a problem: the run that stands for it; nullptr where there is none
  /// Work to solve problem i; nothing where the run failed or missed the target.
  std::optional<double> work(std::size_t i, const std::vector<Problem>& problems, Of of) const;
};

/// "default", "tuned", "strict".
std::string name_of(Contestant::Setting setting);

/// Standard: all options at their defaults. Tuned: of the settings tried, the cheapest that solves this very problem
/// (the nearest to it, where none does). Strict: the setting with the least error in this scene, whatever it costs. A
/// method has no standard one where the study did not run it.
std::vector<Contestant> contestants(const Study& study, const std::vector<Problem>& problems, Of of);

}  // namespace stickslip::report
