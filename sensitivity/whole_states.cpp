#include "sensitivity/whole_states.hpp"

#include "core/model/storage.hpp"

namespace stickslip {

const Increment<double>& WholeStates::increment(std::size_t n) {
  const auto& kept = trajectory_.increments[n];
  if (is_whole(kept.state)) return kept;
  if (n < stretch_.first || n >= stretch_.first + stretch_.increments.size()) {
    stretch_ = {};  // (its memory is for the next)
    stretch_ = solve_again(model_, slots_, method_, trajectory_, n, workspace_, counters_);
    repeated_ += static_cast<long>(stretch_.increments.size());
    long bytes = 0;
    for (const auto& increment : stretch_.increments) {
      bytes += state_bytes(increment.state).all();
      for (const auto& sweep : increment.augmented) bytes += state_bytes(sweep.state).all();
    }
    bytes_ = std::max(bytes_, bytes);
  }
  return stretch_.increments[n - stretch_.first];
}

}  // namespace stickslip
