/// The slots and bodies in the scalars of tests, compiled once: complex numbers, in which the oracle runs, and a dual
/// number of one derivative.
#pragma once

#include <complex>

#include "core/engine/body_matrix.hpp"

namespace stickslip {

STICKSLIP_SLOTS(extern, Dual<1>);
STICKSLIP_SLOTS(extern, std::complex<double>);
STICKSLIP_TANGENTS(extern, std::complex<double>);

}  // namespace stickslip
