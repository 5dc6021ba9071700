#include "core/model/element_kernels_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, std::complex<double>);
STICKSLIP_ELEMENTS(std::complex<double>);
STICKSLIP_TANGENTS(, std::complex<double>);

}  // namespace stickslip
