/// The pace of the overdamped motion (methods/rescue/motion.hpp), whoever makes its steps: the method itself, or the
/// enumeration of all branches (methods/rescue/solutions.hpp).
///
/// alpha is the share of the local stiffness that damps a step. It starts at 1, falls to a fifth after each step, and
/// grows eightfold where a step fails. A solution farther away than all the way so far could as well belong to another
/// branch of solutions: no step but the first, and not the rest at the end, may lead there.
#pragma once

namespace stickslip {

class MotionPace {
 public:
  /// `negligible`: a way up to this length counts as none.
  explicit MotionPace(double negligible = 0) : negligible_(negligible) {}

  double alpha() const { return alpha_; }
  /// Whether another step may be tried. Below the least alpha the damping is rounding; at the largest nothing moves.
  bool goes_on() const { return tried_ < most_steps && alpha_ >= fastest && alpha_ <= slowest; }
  /// Whether a step of a length stays on the branch of solutions.
  bool allows(double length) const { return way_ == 0 || is_near(length); }
  /// Whether a distance is no longer than the way so far.
  bool is_near(double distance) const { return distance <= negligible_ + way_; }

  void fail() {
    ++tried_;
    alpha_ *= slower;
  }
  void move(double length) {
    ++tried_;
    way_ += length;
  }
  void hasten() { alpha_ *= faster; }

 private:
  static constexpr double slower = 8, faster = 0.2, slowest = 1e9, fastest = 1e-15;
  static constexpr int most_steps = 300;
  double negligible_, alpha_ = 1, way_ = 0;
  int tried_ = 0;
};

}  // namespace stickslip
