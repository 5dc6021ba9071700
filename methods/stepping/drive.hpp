/// What drives bodies from outside: the motion that supports and obstacles prescribe. Bodies that move much faster than
/// what drives them may have jumped (methods/stepping/jumps.hpp).
#pragma once

#include "core/model/loading.hpp"
#include "core/model/supports.hpp"

namespace stickslip {

/// Displacements at a time: of all dofs, zero where no support prescribes them, and behind these, of obstacles where
/// the slave nodes of contact points face them at the start. Lengths, in the axes.
template <class T>
Vector<double> driven_motion(const Model& model, const Slots<T>& slots, double time) {
  Vector<T> prescribed = Vector<T>::Constant(model.dof_count(), T(0));
  prescribe(model, slots, time, prescribed);
  std::vector<double> motion(model.dof_count());
  for (Eigen::Index i = 0; i < prescribed.size(); ++i) motion[i] = value(prescribed[i]);
  for (const auto& point : model.points) {
    if (point.obstacle < 0) continue;
    const auto& obstacle = model.scene.obstacles[point.obstacle];
    Vector<double> moved = Vector<double>::Zero(model.dimension);
    for (const auto& [axis, table] : obstacle.move) moved[axis - 'x'] = value(evaluate(table, time, slots.numbers));
    if (const auto& rotate = obstacle.rotate)
      moved += values(rotated<T>(*rotate, slots.points.col(point.nodes[0]),
                                 evaluate(rotate->angle, time, slots.numbers), Strains::finite, slots.numbers));
    motion.insert(motion.end(), moved.begin(), moved.end());
  }
  return Eigen::Map<Vector<double>>(motion.data(), static_cast<Eigen::Index>(motion.size()));
}

}  // namespace stickslip
