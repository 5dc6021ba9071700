/// Bound on the work of a step: a solution that is sought in vain is given up, instead of being sought for ever.
///
/// A step is cut to a thousandth, a part of it may take turns of contact and bodies (methods/sequential.hpp) and then
/// hundreds of steps of the motion (methods/motion.hpp): all of these together would end after days. What counts are
/// iterations of Newton's method, equal on every machine. It is asked between equilibria, so that one of them may
/// follow. Where neither bodies nor geometry change an iteration is cheap, no turns are taken, and nothing is bounded.
#pragma once

#include <algorithm>
#include <limits>
#include <string>

#include "core/model/model.hpp"
#include "core/model/result.hpp"

namespace stickslip {

/// Iterations that the attempts at a step take in vain: all of those that fail, and of one that does not those beyond
/// max_iterations for each of its equilibria. Parts of a step that go as they should cost nothing, however many.
class WorkBound {
 public:
  /// `counters`: of the run; must outlive it.
  WorkBound(const Model& model, const Counters& counters, int max_iterations)
      : counters_(counters), each_(max_iterations) {
    const bool linear = model.effects.linear_bulk && !model.effects.current_geometry;
    most_ = linear ? std::numeric_limits<long>::max() : equilibria_in_vain * std::max(each_, least_each);
  }

  void begin() { before_ = counters_.newton; }
  /// Ends the attempt. `equilibria`: those of its solution; 0 where there is none.
  void end(int equilibria) {
    vain_ += std::max(0L, counters_.newton - before_ - equilibria * each_);
    begin();
  }
  /// Whether the attempt that goes on, and those before it, took all that may be taken.
  bool is_spent() const { return vain_ + counters_.newton - before_ >= most_; }
  std::string in_words() const {
    return "given up after " + std::to_string(vain_) +
           " iterations in vain, of parts of the step too: no equilibrium may lead on from the last, as where nodes of "
           "a slave are further apart than those of its master; try the other side as the slave, or a smooth master";
  }

 private:
  /// What was seen to succeed at last took the iterations of 20; those of 50 take minutes of 8000 displacements.
  static constexpr long equilibria_in_vain = 50;
  static constexpr long least_each = 100;  // (of a smaller max_iterations, which is there to have steps cut)
  const Counters& counters_;
  long each_, most_ = 0, vain_ = 0, before_ = 0;
};

}  // namespace stickslip
