/// The traction of a contact point as a vector.
#pragma once

#include "tests/support/solved.hpp"

namespace stickslip::scenes {

/// Traction of point p on the slave at the end of the run, D components, force per area.
inline Eigen::VectorXd contact_traction(const Solved& s, std::size_t p) {
  const auto& g = s.slots.geometry[p];
  const auto& point = s.model.points[p];
  const auto& all = s.trajectory.increments.back().state.contact.traction;
  Eigen::VectorXd t = all[point.multiplier] * Eigen::VectorXd(g.normal);
  if (point.tangents > 0)
    t += Eigen::MatrixXd(g.tangents) * Eigen::VectorXd(all.segment(point.multiplier + 1, point.tangents));
  return t;
}

}  // namespace stickslip::scenes
