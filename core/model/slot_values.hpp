/// Slots: every number that a residual reads, in the scalar T: nodal coordinates, material numbers, initial contact
/// geometry, friction, loads. T is double in the solver, Dual<N> for derivatives by parameters (pseudo-loads), complex
/// in the oracle.
#pragma once

#include <vector>

#include "core/contact/contact_point.hpp"
#include "core/mesh/mesh.hpp"
#include "core/model/model.hpp"
#include "core/solids/edges.hpp"
#include "core/solids/materials.hpp"

namespace stickslip {

/// Nodal forces of a load at history = 1, on the dofs on which it acts.
template <class T>
struct NodalLoad {
  std::vector<int> dofs;  ///< ascending
  std::vector<T> forces;

  explicit NodalLoad(const Vector<T>& all) {
    for (int dof = 0; dof < all.size(); ++dof)
      if (!vanishes(all[dof])) {
        dofs.push_back(dof);
        forces.push_back(all[dof]);
      }
  }
  Vector<T> all(int dof_count) const {
    Vector<T> spread = Vector<T>::Constant(dof_count, T(0));
    for (std::size_t k = 0; k < dofs.size(); ++k) spread[dofs[k]] = forces[k];
    return spread;
  }
};

template <class T>
struct Slots {
  Numbers<T> numbers;
  Points<T> points;                        ///< D x nodes
  std::vector<Law<T>> laws;                ///< per body
  std::vector<Depth<T>> depths;            ///< per body
  std::vector<PointGeometry<T>> geometry;  ///< per contact point
  std::vector<T> stiffness;                ///< per contact point: local nodal stiffness k_i (force per length)
  std::vector<FrictionLaw<T>> friction;    ///< per contact; not read if frictionless
  std::vector<NodalLoad<T>> loads;         ///< per load
  std::vector<Matrix<T>> frames;           ///< per framed node: D x D, frame vectors as columns
  std::vector<Vector<T>> spins;            ///< per contact point: displacement of its obstacle per degree of rotation,
                                           ///< length; empty: no obstacle rotates
  std::vector<Vector<T>> arcs;  ///< per curve that is integrated: initial arc length along it to the beginning
                                ///< of each facet, and of all; empty for another; no entry: none is
  bool normals_turn = false;    ///< of the model's effects
};

/// Gap of a point, length, up to which it counts as zero. If the initial gap is not exactly zero: the rounding of the
/// coordinates. If it is: the rounding of the displacements alone, so a contact that begins closed has the same
/// branches under every load, however small. `largest_displacement`: of the point's nodes, length.
template <class T>
double tie_length(const ContactPoint& point, const PointGeometry<T>& geometry, double largest_displacement = 0) {
  constexpr double terms = 256;  // terms summed in a displacement, times some condition number
  return value(geometry.gap) == 0 ? terms * unit_roundoff * largest_displacement : point.tie_length;
}

namespace detail {

template <class T>
Vec<T, 2> point2(const Points<T>& points, int node) {
  return {points(0, node), points(1, node)};
}

/// Cross-section of bars, area.
template <class T>
T area_of(const Law<T>& bars) {
  if (const auto* plastic = std::get_if<PlasticBarLaw<T>>(&bars)) return plastic->elastic.area;
  return std::get<BarLaw<T>>(bars).area;
}

}  // namespace detail

}  // namespace stickslip
