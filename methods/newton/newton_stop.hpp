/// What ends Newton's method.
#pragma once

#include <optional>
#include <unordered_map>

#include "methods/newton/residuals.hpp"

namespace stickslip {

/// Why Newton's method ends at an iterate.
struct NewtonEnd {
  Status status = Status::converged;
  std::string message = "";
  bool inexact = false;  ///< short of the tolerance, as `forcing` allows
};

/// How the iterations end:
///
///   converged               all residuals within the tolerance, and no state changed since the last tangent; or no
///                           force is left but rounding, as of bodies that move without touching anything
///   converged_at_roundoff   residuals stop falling at the level of their own rounding
///   stagnated               residuals stop falling above that level, but close to the solution
///   cycle                   a set of states is met again, with more than half of its residual left
///
/// Why a cycle: in 2D a step depends on the set of states alone, so that all would repeat. (Where a step depends on the
/// place too, letting sets repeat made the path chaotic, and the penalty no faster.) [AC91], [HSW08]
class NewtonStop {
 public:
  /// `extra`: iterations that follow the one that has converged, for a derivative that rides on the scalar.
  /// `rests`: the start values count as solved if their residuals are rounding.
  NewtonStop(const NewtonOptions& options, double forcing, int extra, bool rests)
      : options_(options), forcing_(forcing), extra_(extra), rests_(rests) {}

  /// Takes in an iterate, whose record is the last of the history; nothing where the method goes on.
  template <class T>
  std::optional<NewtonEnd> judge(const detail::Residuals& residuals, const ContactField<T>& field,
                                 const std::vector<IterationRecord>& history) {
    if (!residuals.finite()) return NewtonEnd{Status::not_finite, "the residual is not finite"};
    take_states(residuals, signature(field), history);
    const int iteration = static_cast<int>(history.size()) - 1;
    if (auto end = solved(residuals, history)) {
      if (extra_-- == 0) return end;
    } else if (iteration > 0 && !residuals.within(options_.tolerance) &&
               residuals.within(forcing_ * history[0].residual)) {  // (within it, one more iteration is exact)
      return NewtonEnd{Status::converged, "", true};
    } else if (repeats_) {
      return NewtonEnd{Status::cycle, "the active set repeats"};
    }
    const bool close = residuals.within(std::sqrt(options_.tolerance));  // where a step should square the residual
    if (steady_ >= patience && 2 * residuals.largest() > history[iteration - patience].residual)
      return NewtonEnd{close ? Status::stagnated : Status::cycle, "no step lowers the residual any more"};
    if (iteration >= options_.max_iterations)
      return NewtonEnd{Status::cap, "Newton's method reached max_iterations; try more steps"};
    return std::nullopt;
  }

  /// Goes on from a cycle that was broken.
  void forget() {
    least_residual_.clear();
    steady_ = 0;
  }

 private:
  static constexpr int patience = 10;  // iterations in one active set that leave more than half of the residual

  void take_states(const detail::Residuals& residuals, std::size_t states,
                   const std::vector<IterationRecord>& history) {
    const bool first = history.size() == 1;
    unchanged_ = first || history.back().changed == 0;
    steady_ = unchanged_ && !first ? steady_ + 1 : 0;
    repeats_ = false;
    if (unchanged_) return;
    const auto [entry, fresh] = least_residual_.try_emplace(states, residuals.largest());
    repeats_ = !fresh && residuals.largest() > 0.5 * entry->second;
    entry->second = std::min(entry->second, residuals.largest());
  }

  /// (Sets that repeat although nothing is left of the residuals are those of a tie. Of residuals that are zero nothing
  /// is left, whatever changed.)
  std::optional<NewtonEnd> solved(const detail::Residuals& residuals,
                                  const std::vector<IterationRecord>& history) const {
    const bool settled = unchanged_ || repeats_ || residuals.largest() == 0;
    if (settled && residuals.within(options_.tolerance)) return NewtonEnd{};
    if (!residuals.within_rounding(options_.tolerance)) return std::nullopt;
    if (rests_ && history.size() == 1) return NewtonEnd{Status::converged_at_roundoff, "nothing but rounding moves it"};
    const auto fell = [&] { return 2 * residuals.largest() <= history[history.size() - 2].residual; };
    if (!repeats_ && (steady_ < 2 || fell())) return std::nullopt;
    if (residuals.forces_are_rounding()) return NewtonEnd{};
    return NewtonEnd{Status::converged_at_roundoff, "the residual stopped falling at the level of rounding"};
  }

  /// Of the states, and of the patches that closed points face.
  template <class T>
  static std::size_t signature(const ContactField<T>& field) {
    std::size_t hash = 1469598103934665603ull;
    for (ContactState s : field.state) hash = (hash ^ static_cast<std::size_t>(s)) * 1099511628211ull;
    for (std::size_t p = 0; p < field.facing.size(); ++p)
      if (field.state[p] != ContactState::open && field.facing[p].pieces.empty())
        hash = (hash ^ static_cast<std::size_t>(field.facing[p].patch)) * 1099511628211ull;
    return hash;
  }

  const NewtonOptions& options_;
  double forcing_;
  int extra_;
  bool rests_;
  bool unchanged_ = true, repeats_ = false;  ///< since the last tangent; a set of states that was met before
  int steady_ = 0;                           ///< iterations in a row without a change
  std::unordered_map<std::size_t, double> least_residual_;  ///< per set of states
};

}  // namespace stickslip
