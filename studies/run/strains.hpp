/// Strains of a solution, where a picture or a check wants them.
#pragma once

#include "studies/run/case.hpp"

namespace stickslip {

/// Calls f(e, H, volume) at each quadrature point of each element of body b; nothing where it is no continuum. H:
/// displacement gradient, 2 x 2, or 3 x 3 where a component out of the plane matters. `volume`: of a unit thickness.
template <class F>
void for_each_strain(const Problem& problem, const Vector<double>& displacement, std::size_t b, F&& f) {
  const auto& body = problem.model.bodies[b];
  if (!is_continuum(body.mesh.shape)) return;
  detail::with_element(body, [&]<class Shape, Kinematics kinematics>() {
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const auto nodes = detail::element_nodes(body, e);
      const auto X = detail::gather_coordinates<double, Shape>(problem.slots.points, nodes.data());
      const auto u = detail::gather_displacements<double, Shape>(displacement, nodes.data());
      for_each_gradient<double, Shape, kinematics>(
          X, 1, [&](const auto& gradient) { f(e, gradient.of(u), gradient.volume); });
    }
  });
}

}  // namespace stickslip
