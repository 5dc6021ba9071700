/// From what a body has at run time to the types of its law, its shape and its kinematics.
#pragma once

#include "core/model/slots.hpp"
#include "core/solids/elements.hpp"
#include "core/solids/materials.hpp"

namespace stickslip::detail {

/// Calls f.template operator()<kinematics>(law) with the law of a body, which is a continuum of this shape, and its
/// kinematics.
template <class Shape, class T, class F>
void with_continuum(const BodyMesh& body, const Law<T>& law, F&& f) {
  const auto with = [&]<class L>(const L& of) {
    if constexpr (requires { L::is_finite; })
      with_kinematics<Shape>(body.kinematics, [&]<Kinematics kinematics>() {
        if constexpr (L::is_made_for(kinematics, Strains::small) || L::is_made_for(kinematics, Strains::finite))
          f.template operator()<kinematics>(of);
      });
  };
  std::visit(with, law);
}

/// Calls f(law) with the law of a body of elements of two nodes.
template <class T, class F>
void with_two_nodes(const Law<T>& law, F&& f) {
  std::visit(
      [&]<class L>(const L& of) {
        if constexpr (!requires { L::is_finite; }) f(of);
      },
      law);
}

/// Calls continuum.template operator()<Shape, kinematics>(law) with the law of body b and what its elements are, or,
/// where they are of two nodes, two_nodes.template operator()<D>(law).
template <class T, class Continuum, class TwoNodes>
void with_law(const Model& model, const Slots<T>& slots, int b, Continuum&& continuum, TwoNodes&& two_nodes) {
  const auto& body = model.bodies[b];
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    with_continuum<Shape>(body, slots.laws[b].law, [&]<Kinematics kinematics>(const auto& law) {
      continuum.template operator()<Shape, kinematics>(law);
    });
  });
  with_dimension(model.dimension, [&]<int D>() {
    with_two_nodes(slots.laws[b].law, [&](const auto& law) { two_nodes.template operator()<D>(law); });
  });
}

}  // namespace stickslip::detail
