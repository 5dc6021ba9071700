/// Scenes of the tests, solved and differentiated.
#pragma once

#include <string>

#include "sensitivity/differentiate.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::scenes {

/// A solved scene with its derivatives.
struct Solved {
  Model model;
  Slots<double> slots;
  Trajectory<double> trajectory;
  Gradients gradients;
  double condition = 0;  ///< estimate, of the last tangent of the solver

  /// Value of a response, and its derivative, at increment n (negative: from the end).
  double value(const std::string& name, int n = -1) const;
  double derivative(const std::string& name, const std::string& of, int n = -1) const;
  int response(const std::string& name) const;
  std::size_t index(int n) const;
};

Solved run(const Scene& scene, const Method& method, const RunOptions& options = {});

Regularisation relative(double multiple);
Regularisation absolute(double value);

}  // namespace stickslip::scenes
