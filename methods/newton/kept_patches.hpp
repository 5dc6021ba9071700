/// Points that go to and fro between two patches at a corner, each kept on one of them until the equilibrium is found.
///
/// Why: at a corner the two normals push a point to either side for ever. If the states of Newton's method cycle, such
/// points are kept on the patch that they face then. Where the solution of that is wrong, as a kept point faces another
/// patch, they are let go there: from it there may be a way to a solution in which all points face what they are on.
#pragma once

#include <algorithm>
#include <vector>

#include "core/model/facings.hpp"

namespace stickslip {

namespace detail {

/// Whether a point has come to face another patch of its surface. Never for segment-integrated points, which have no
/// kink between patches.
inline bool has_crossed(const Facing& before, const Facing& after) {
  return before.pieces.empty() && after.pieces.empty() && before.patch != after.patch;
}

/// Number of closed points that face another patch than in `last`.
template <class T>
int count_crossings(const ContactField<T>& field, const std::vector<Facing>& last) {
  int crossed = 0;
  for (std::size_t p = 0; p < last.size(); ++p)
    crossed += field.state[p] != ContactState::open && has_crossed(last[p], field.facing[p]);
  return crossed;
}

}  // namespace detail

template <class T>
class KeptPatches {
 public:
  /// Takes in the next iterate. Returns the number of closed points that face another patch than before.
  int accept(const ContactField<T>& field) {
    const auto& facing = field.facing;
    int crossed = 0;
    for (std::size_t p = 0; p < facing.size() && !last_.empty(); ++p) {
      if (field.state[p] == ContactState::open || !detail::has_crossed(last_[p], facing[p])) continue;
      ++crossed;
      auto& visited = visited_[p];
      returned_[p] |= std::find(visited.begin(), visited.end(), facing[p].patch) != visited.end();
      visited.push_back(facing[p].patch);
    }
    if (last_.empty()) {
      for (const Facing& f : facing) visited_.push_back({f.patch});
      returned_.assign(facing.size(), 0);
    }
    last_ = facing;
    return crossed;
  }

  /// Keeps points that came back to a patch on their present one. False if there is no such point.
  bool keep(const Model& model) {
    bool any = false;
    for (std::size_t p = 0; p < last_.size(); ++p) {
      if (!returned_[p] || last_[p].patch == no_patch || (!kept_.empty() && kept_[p] != no_patch)) continue;
      if (model.surfaces[model.points[p].surface].goes_on_around(last_[p].patch)) continue;
      kept_.resize(last_.size(), no_patch);
      kept_[p] = last_[p].patch;
      any = true;
    }
    return any;
  }

  /// Whether a closed point is kept on a patch that it does not face. `compact`: displacements of the contact nodes.
  bool is_wrong(const ContactInput<T>& input, const Vector<T>& compact, const ContactField<T>& field) const {
    const auto free = detail::facings(input, compact);
    for (std::size_t p = 0; p < kept_.size(); ++p)
      if (kept_[p] != no_patch && field.state[p] != ContactState::open && free[p].patch != kept_[p]) return true;
    return false;
  }

  void release() {
    kept_.clear();
    last_.clear();
    visited_.clear();
  }

  /// Per point: the patch that it is kept on, or no_patch; empty: no point is kept.
  const std::vector<int>& kept() const { return kept_; }

 private:
  std::vector<Facing> last_;               ///< of the last iterate; empty: no point slides along a curve
  std::vector<std::vector<int>> visited_;  ///< per point: the patches that it has faced
  std::vector<char> returned_;             ///< per point: whether it came back to one of them
  std::vector<int> kept_;
};

}  // namespace stickslip
