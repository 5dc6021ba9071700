/// Comparison of every derivative with differences of the solver.
///
/// The differences use steps over several decades and repeat the time steps of the base run. A run is of use up to the
/// increment at which its contact states part from those of the base run, because a difference across a change of state
/// is no derivative. Where the two sides of a derivative differ (a tie, a kink of the geometry), each is compared with
/// one-sided differences, of runs with the states of that side; elsewhere the derivative with central differences. The
/// error estimate of a difference is made of its extrapolation and of the noise of the responses
/// (sensitivity/quotients.hpp). Steps in which equilibrium does not determine a response are left out
/// (sensitivity/open_responses.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sensitivity/differentiate.hpp"

namespace stickslip {

struct GradientCheck {
  enum class Verdict { agrees, differs, not_checked, undetermined };
  struct Entry {
    std::string response, parameter;  ///< `response`: of a response or an objective
    double time = 0;                  ///< step with the largest error
    int side = 0;                     ///< of that: 0 both, -1 from below, 1 from above
    double computed = 0;              ///< derivative by the method's scheme, at that step
    double difference = 0;            ///< derivative by differences
    double error = 0;                 ///< |computed - difference| / scale
    double estimate = 0;              ///< error estimate of the difference itself / scale
    double allowed = 0;               ///< max(1e-8 (oversized: 10 / kappa_s), estimate)
    double scale = 0;              ///< largest |derivative| of the run, or largest |response| / size of the parameter
    double step = 0;               ///< relative step of the chosen difference
    int steps = 0, unchecked = 0;  ///< how many; those of which no difference tells three digits
    double unchecked_at = 0;       ///< the first of these
    int undetermined = 0;          ///< steps in which it hangs on forces that equilibrium leaves open: no derivative
    Verdict verdict = Verdict::not_checked;
  };
  std::vector<Entry> entries;
  Status status = Status::converged;  ///< of the base run
  std::string message;
  int runs = 0;         ///< difference runs
  int rejected = 0;     ///< of these, runs that pass through other states somewhere, or fail
  bool passed() const;  ///< at least one entry agrees, and the others do or are undetermined
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
