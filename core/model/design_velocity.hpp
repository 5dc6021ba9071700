/// Design velocities: how the nodes of a body move with a shape parameter whose value is the distance that a side (or
/// one node of it) moves along a direction. The motion is extended into the body by Laplace's equation,
///
///   div grad w = 0,   w = 1 where it moves,   w = 0 where the body stays,   x <- x + w d phi
///
/// discretised on the mesh itself, so that neighbouring nodes move alike and elements keep their shape.
#pragma once

#include <vector>

#include "core/mesh/mesh.hpp"
#include "core/model/scene.hpp"

namespace stickslip {

/// Of one shape motion of the scene: what each node of the body moves along the direction, per unit of the parameter.
struct DesignVelocity {
  int body = 0;
  int slot = 0;  ///< of the parameter in Scene::numbers; its value is 0
  Vector<double> share;
  std::vector<double> direction;
};

/// Design velocities of the shape motions of one body, in their order; one factorisation for all. `points`: of the
/// body.
std::vector<DesignVelocity> design_velocities(const Scene& scene, int body, const Mesh& mesh,
                                              const Points<double>& points);

}  // namespace stickslip
