/// Every sensitivity against central differences of the solver itself.
///
/// The differences sweep the step over several decades, replay the step table of the base run, and throw out a step
/// whose runs pass through other contact states than the base run: across a change of state a difference is no
/// derivative. Neighbouring steps are extrapolated (Richardson, error h^2 -> h^4); the spread of the extrapolated
/// values and the rounding of the responses give the difference its own error estimate.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sensitivity/differentiate.hpp"

namespace stickslip {

struct GradientCheck {
  enum class Verdict { agrees, differs, not_checked };
  struct Entry {
    std::string response, parameter;  ///< or an objective
    double time = 0;                  ///< step with the largest error
    double computed = 0;              ///< derivative by the method's scheme, at that step
    double difference = 0;            ///< by differences
    double error = 0;                 ///< |computed - difference| / scale
    double estimate = 0;              ///< error estimate of the difference itself / scale
    double allowed = 0;               ///< max(1e-8 (oversized: 10 / kappa_s), estimate)
    double scale = 0;  ///< largest |derivative| of the run, or largest |response| / size of the parameter
    double step = 0;   ///< relative step of the chosen difference
    Verdict verdict = Verdict::not_checked;
  };
  std::vector<Entry> entries;
  Status status = Status::converged;  ///< of the base run
  std::string message;
  int runs = 0;         ///< difference runs
  int rejected = 0;     ///< of them, thrown out for other states or no convergence
  bool passed() const;  ///< something was checked, and nothing differs or was left unchecked
};

/// The method whose derivative a scheme claims to be, solved to rounding (converged_at_roundoff ends it), for what a
/// tolerance leaves is noise in a difference. Uzawa's schemes stand for the converged solution, but for the truncated
/// one, which stands for the loop as it is.
Method as_claimed(const Method& method);

/// Checks all parameters and responses at every requested step, and all objectives; the objectives alone where the
/// scene's mode is adjoint. `progress(done, total)` is called after each run; it
/// may be empty.
GradientCheck check_gradients(const Model& model, const Method& method, const RunOptions& options,
                              const std::function<void(int, int)>& progress = {});

}  // namespace stickslip
