/// Bound on the work of a step, after which a solution is no longer sought.
///
/// Why: a step is cut down to a thousandth, and each part may take the sequence (methods/rescue/sequential.hpp) and
/// then hundreds of steps of the motion (methods/rescue/motion.hpp). All of these together would take days. The work is
/// counted in iterations of Newton's method, which are the same on every machine. It is checked between equilibria, so
/// one more may follow. If bodies and geometry are linear, an iteration is cheap and there is no bound.
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "core/model/model.hpp"
#include "core/model/result.hpp"

namespace stickslip {

/// Whether supports and closed contacts hold all bodies where a step begins.
enum class Bodies { held, free };

/// Counts iterations in vain of the attempts at a step: all iterations of an attempt that fails, and, of one that
/// succeeds, those beyond 20 per equilibrium. So parts of a step that converge as they should cost nothing.
class WorkBound {
 public:
  /// `counters`: of the run; must outlive it. `spent`: iterations of the run's increments so far, those in vain apart.
  /// If a body is free, the motion is the regular way and not a rescue: then the least bound is higher.
  WorkBound(const Model& model, const Counters& counters, int max_iterations, long spent, Bodies bodies)
      : counters_(counters), each_(max_iterations) {
    const bool linear = model.effects.linear_bulk && !model.effects.current_geometry;
    const long size = model.dof_count() + dofs_a_point * static_cast<long>(model.points.size());
    const long each = std::max(each_, least_each), affordable = dofs_in_vain / std::max(size, 1L);
    const long least = (bodies == Bodies::free ? few_of_motion : few_in_vain) * each;
    most_ = std::clamp(std::max(spent_again * spent, affordable), least, equilibria_in_vain * each);
    if (linear) most_ = std::numeric_limits<long>::max();
  }

  /// Iterations of an attempt that are not in vain, if its equilibria take as many as they should.
  static long due(long iterations, int equilibria) {
    constexpr long converging = 20;
    return std::min(iterations, converging * equilibria);
  }
  void begin() { before_ = counters_.newton; }
  /// Ends an attempt. `equilibria`: number of its equilibria; 0: it failed.
  void end(int equilibria) {
    const long iterations = counters_.newton - before_;
    vain_ += iterations - due(iterations, equilibria);
    begin();
  }
  /// Whether the present attempt and those before it have used up the bound.
  bool is_spent() const { return vain_ + counters_.newton - before_ >= most_; }
  std::string in_words() const {
    return "given up after " + std::to_string(vain_) +
           " iterations without a solution, those of parts of the step included; no equilibrium may lead on from the "
           "last";
  }

 private:
  // Bounds in units of max_iterations: the most, and the least. Steps that succeeded took up to 20. Those of disks
  // between plates, which only contact holds, took up to 11.
  static constexpr long equilibria_in_vain = 50, few_in_vain = 4, few_of_motion = 12;
  static constexpr long dofs_in_vain = 2'000'000;  // iterations times displacements: 3 to 10 s at 3000
  static constexpr long dofs_a_point = 10;         // a contact point takes as long as these
  static constexpr long spent_again = 5;           // where the run was dear so far, it may be so on
  static constexpr long least_each = 100;          // for a small max_iterations, which is chosen to have steps cut
  const Counters& counters_;
  long each_, most_ = 0, vain_ = 0, before_ = 0;
};

}  // namespace stickslip
