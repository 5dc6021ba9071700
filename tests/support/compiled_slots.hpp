/// The slots, bodies and contact points in the scalars of tests, compiled once: complex numbers, in which the oracle
/// runs; and the scalar of direct differentiation, as it is in the program.
#pragma once

#include <complex>

#include "core/engine/body_matrix.hpp"
#include "core/model/point_tangent.hpp"
#include "sensitivity/direction.hpp"

namespace stickslip {

/// Tangents at a motion are those of its real part: Newton's method needs no more, and finds the same equilibrium.
template <>
void for_each_element_tangent(const Model& model, const Slots<std::complex<double>>& slots, int b,
                              const std::vector<int>* only, const ElementSink<std::complex<double>>& sink,
                              const BodyMotion<std::complex<double>>* at);

STICKSLIP_SLOTS(extern, std::complex<double>);
STICKSLIP_TANGENTS(extern, std::complex<double>);
STICKSLIP_CONTACT(extern, std::complex<double>);
STICKSLIP_POINT_TANGENT(extern, std::complex<double>);

}  // namespace stickslip
