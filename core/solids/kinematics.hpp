/// Spaces, and how displacements become strains in them.
#pragma once

namespace stickslip {

/// How large strains may be: small, linear in the displacements, or finite.
enum class Strains { small, finite };
constexpr Strains strains_of(bool finite) { return finite ? Strains::finite : Strains::small; }

enum class Space { plane_strain, plane_stress, axisymmetric, solid };

/// How displacements become strains.
enum class Kinematics {
  plane,
  revolution,
  space,
  plane_mean_dilatation,
  revolution_mean_dilatation,
  space_mean_dilatation
};

constexpr bool is_of_revolution(Kinematics k) {
  return k == Kinematics::revolution || k == Kinematics::revolution_mean_dilatation;
}
constexpr bool has_mean_dilatation(Kinematics k) {
  return k == Kinematics::plane_mean_dilatation || k == Kinematics::revolution_mean_dilatation ||
         k == Kinematics::space_mean_dilatation;
}
constexpr bool is_in_space(Kinematics k) { return k == Kinematics::space || k == Kinematics::space_mean_dilatation; }
/// Components of a tensor that are not always zero (core/solids/tensor.hpp).
enum class TensorLayout { plane4, hoop5, full9 };

/// The layout of the displacement gradient and of the stress.
constexpr TensorLayout layout_of(Kinematics k) {
  if (is_in_space(k)) return TensorLayout::full9;
  return k == Kinematics::plane ? TensorLayout::plane4 : TensorLayout::hoop5;
}

/// The kinematics of a body in a space with or without mean dilatation.
constexpr Kinematics kinematics_of(Space space, bool mean_dilatation) {
  if (space == Space::solid) return mean_dilatation ? Kinematics::space_mean_dilatation : Kinematics::space;
  if (space == Space::axisymmetric)
    return mean_dilatation ? Kinematics::revolution_mean_dilatation : Kinematics::revolution;
  return mean_dilatation ? Kinematics::plane_mean_dilatation : Kinematics::plane;
}

}  // namespace stickslip
