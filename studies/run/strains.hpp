/// Strains and stresses of a solution at quadrature points, for pictures and checks.
#pragma once

#include <Eigen/LU>

#include "core/model/element_nodes.hpp"
#include "core/solids/materials.hpp"
#include "core/solids/mean_dilatation.hpp"
#include "studies/run/case.hpp"

namespace stickslip {

/// Calls f(e, H, volume, memory) at each quadrature point of each element of body b; not for bodies that are no
/// continuum.
///
///   H       displacement gradient, a Tensor (with mean dilatation the averaged one)
///   volume  of the point at unit thickness
///   memory  of the point; nullptr: it has none
template <class F>
void for_each_strain(const Problem& problem, const State<double>& state, std::size_t b, F&& f) {
  const auto& body = problem.model.bodies[b];
  if (!is_continuum(body.mesh.shape)) return;
  const int count = memory_of(problem.model.scene.bodies[b].material, layout_of(body.kinematics));
  const double* const first = count > 0 ? state.history.bodies.data() + body.first_memory : nullptr;
  detail::with_element(body, [&]<class Shape, Kinematics kinematics>() {
    for (int e = 0; e < body.mesh.element_count(); ++e) {
      const auto nodes = detail::element_nodes(body, e);
      const auto X = detail::gather_coordinates<double, Shape>(problem.slots.points, nodes.data());
      const auto u = detail::gather_displacements<double, Shape>(state.displacement, nodes.data());
      int point = 0;
      for_each_strain_in<double, Shape, kinematics>(
          problem.model.scene.finite_strain, X, 1, u, [&](const auto& H, double volume) {
            f(e, H, volume, first ? first + e * body.memory + point * count : nullptr);
            ++point;
          });
    }
  });
}

/// Stress (xx, yy, zz, xy, yz, xz) at a displacement gradient and the memory of its point; Cauchy stress at finite
/// strain.
template <TensorLayout layout>
std::array<double, 6> stress_of(const Law<double>& law, const Tensor<double, layout>& H, const double* memory) {
  return std::visit(
      [&]<class L>(const L& of) -> std::array<double, 6> {
        if constexpr (ContinuumLaw<L>) {
          constexpr int rows = Tensor<double, layout>::rows;
          Mat<double, rows> s;
          double across = 0, stretch = 1;  // out of the plane
          const auto take = [&](const auto&... remembered) {
            s = of.stress(H, remembered...).full();
            if constexpr (layout == TensorLayout::plane4) {
              across = of.stress_across(H, remembered...);
              stretch = of.stretch_across(H, remembered...);
            }
          };
          if constexpr (Remembers<L>) {
            constexpr int count = L::memory_in(layout);
            take(Vec<double, count>(Eigen::Map<const Vec<double, count>>(memory)));
          } else {
            take();
          }
          if (of.is_finite) {
            const Mat<double, rows> F = Mat<double, rows>::Identity() + H.full();
            s = s * F.transpose() / (F.determinant() * stretch);
          }
          if constexpr (Tensor<double, layout>::in_space) return {s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2)};
          if constexpr (rows == 3) across = s(2, 2);
          return {s(0, 0), s(1, 1), across, s(0, 1), 0, 0};
        }
        return {};
      },
      law);
}

/// Stretch of the thickness at an in-plane displacement gradient and the memory of its point.
inline double thickness_stretch(const Law<double>& law, const PlaneGradient<double>& H, const double* memory) {
  return std::visit(
      [&]<class L>(const L& of) -> double {
        if constexpr (ContinuumLaw<L>) {
          if constexpr (Remembers<L>)
            return of.stretch_across(H, Vec<double, L::memory>(Eigen::Map<const Vec<double, L::memory>>(memory)));
          else
            return of.stretch_across(H);
        }
        return 1;
      },
      law);
}

}  // namespace stickslip
