/// Comparison of every derivative with central differences of the solver.
///
/// The differences use steps over several decades and repeat the time steps of the base run. A step is rejected if its
/// runs pass through other contact states than the base run, because a difference across a change of state is no
/// derivative. Neighbouring steps are extrapolated (Richardson, error h^2 -> h^4). The error estimate of a difference
/// consists of the spread of the extrapolated values and the rounding of the responses.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sensitivity/differentiate.hpp"

namespace stickslip {

struct GradientCheck {
  enum class Verdict { agrees, differs, not_checked };
  struct Entry {
    std::string response, parameter;  ///< `response`: of a response or an objective
    double time = 0;                  ///< step with the largest error
    double computed = 0;              ///< derivative by the method's scheme, at that step
    double difference = 0;            ///< derivative by differences
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
  int rejected = 0;     ///< difference runs rejected for other states or no convergence
  bool passed() const;  ///< at least one entry was checked, and none differs or is unchecked
};

/// The method whose derivative a scheme claims to be, solved to rounding (status converged_at_roundoff). Why to
/// rounding: what a tolerance leaves is noise in a difference. The schemes of Uzawa claim the derivative of the
/// converged solution, except the truncated one, which claims that of the loop as it is.
Method as_claimed(const Method& method);

/// Checks all responses at every requested step and all objectives, by all parameters. If the mode of the scene is
/// adjoint, only the objectives. `progress(done, total)` is called after each run; it may be empty.
GradientCheck check_gradients(const Model& model, const Method& method, const RunOptions& options,
                              const std::function<void(int, int)>& progress = {});

}  // namespace stickslip
