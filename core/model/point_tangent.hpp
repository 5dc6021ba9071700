/// Tangents of contact points, by dual numbers through the kernel of the residual.
#pragma once

#include "core/model/contact_input.hpp"

namespace stickslip {

/// Tangent of one point by displacements and by its scaled multiplier l = lambda / rho. The displacements are
///
///   initial geometry                        w, the relative displacement
///   present geometry against an obstacle    that of the slave node, which also turns normal and tangents
///   along a curve, or segment-integrated    those of all nodes in `places`, node-major
template <class T>
struct PointTangent {
  Matrix<T> force_w, force_l;    ///< force: D x D, D x components; with `places` D is the number of their dofs
  Matrix<T> row_w, row_l;        ///< rows A (t - lambda): components x D, components x components
  std::vector<int> places = {};  ///< indices in Model::contact_nodes; empty: those of the weights
  bool has_potential = true;     ///< as that of PlacedPoint
};

/// Tangent of point p in the branch `state`. `facing`: per point; not read if no point slides along a curve.
template <class T>
PointTangent<T> point_tangent(const ContactInput<T>& input, int p, const Vector<T>& compact,
                              const Vector<T>& multiplier, ContactState state, const std::vector<Facing>& facing = {});

/// In a scalar that is solved in, as STICKSLIP_SLOTS; the source includes core/model/point_tangent_impl.hpp.
#define STICKSLIP_POINT_TANGENT(EXTERN, T)                                                                       \
  EXTERN template PointTangent<T> point_tangent(const ContactInput<T>&, int, const Vector<T>&, const Vector<T>&, \
                                                ContactState, const std::vector<Facing>&)

STICKSLIP_POINT_TANGENT(extern, double);

}  // namespace stickslip
