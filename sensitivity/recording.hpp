/// What an adjoint records once for a run: the slots of its scene on a tape.
#pragma once

#include "sensitivity/pull_back.hpp"

namespace stickslip {

/// The slots of a scene on a tape, as functions of the numbers that are parameters. Nodal coordinates of bodies that
/// these shape are variables of their own, so that thousands of shape parameters share one transposed extension. The
/// stiffness of contact nodes, which many elements make, is variables too: recorded as a whole it would take a
/// megabyte an element of space.
class Recording {
 public:
  /// `values`: the same slots in double. `reads_stiffness`: whether the scheme does; the stiffness of the points is
  /// constant otherwise.
  Recording(const Model& model, const Slots<double>& values, bool reads_stiffness);

  Tape& tape() { return tape_; }
  const Slots<Reverse>& slots() const { return slots_; }
  /// Derivatives by all numbers of the scene out of those by what is on the tape, which are moved.
  Vector<double> by_numbers(std::vector<double>& by);

 private:
  void pull_back_stiffness(std::vector<double>& by);

  const Model& model_;
  Tape tape_;
  Numbers<Reverse> numbers_;
  Points<Reverse> made_, points_;        ///< by the generators; the same as variables
  int points_end_ = 0;                   ///< on the tape
  std::vector<Matrix<Reverse>> blocks_;  ///< of nodal_stiffness(), as variables; empty where it is not read
  Slots<Reverse> slots_;
};

}  // namespace stickslip
