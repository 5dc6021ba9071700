/// Thin increments (methods/stepping/checkpoints.hpp) solved again, in the same way as the first time.
#pragma once

#include <stdexcept>

#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/step.hpp"

namespace stickslip {

namespace detail {

/// Whether two states agree, bit for bit, in what a thin one holds.
template <class T>
bool same_contact(const State<T>& a, const State<T>& b) {
  return a.contact.state == b.contact.state && a.contact.gap == b.contact.gap &&
         a.contact.traction == b.contact.traction && a.history.placement == b.history.placement;
}

/// The stretch that contains the thin increment n, as the run left it. The engine is restored afterwards. Throws
/// std::logic_error if the stretch differs from that of the run.
template <class T>
Stretch<T> solve_again(const Method& method, const Model& model, const Slots<T>& slots, Engine<T>& engine,
                       const Checkpoints<T>& checkpoints, const Trajectory<T>& trajectory, std::size_t n,
                       Counters& counters) {
  const auto& start = checkpoints.start_of(n);
  const auto own = engine.memory();
  engine.restore(start.engine, counters);
  Run<T> run{.method = method,
             .model = model,
             .slots = slots,
             .engine = engine,
             .account = start.account,
             .uniqueness = checkpoints.uniqueness(),
             .condensation = checkpoints.condensation()};
  Stretch<T> stretch{checkpoints.end(start.step), {}};
  Trajectory<T> part;
  part.initial = trajectory.initial;
  const std::size_t before = stretch.first > 0 ? 1 : 0;  // number of increments before the stretch that it needs
  if (before > 0) part.increments.push_back(trajectory.increments[stretch.first - 1]);
  const std::size_t last = checkpoints.last_step(start);
  for (std::size_t step = start.step + 1; step <= last; ++step)
    advance(run, part, checkpoints.times()[step - 1], checkpoints.steps());
  counters += run.account.counters;
  engine.restore(own, counters);
  part.increments.erase(part.increments.begin(), part.increments.begin() + static_cast<std::ptrdiff_t>(before));
  stretch.increments = std::move(part.increments);
  bool same = stretch.first + stretch.increments.size() == checkpoints.end(last);
  for (std::size_t k = 0; same && k < stretch.increments.size(); ++k)
    same = same_contact(stretch.increments[k].state, trajectory.increments[stretch.first + k].state);
  if (!same) throw std::logic_error("increments that were solved again came out otherwise");
  return stretch;
}

}  // namespace detail

}  // namespace stickslip
