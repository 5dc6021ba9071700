#include "core/model/element_kernels_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, Dual<1>);
STICKSLIP_ELEMENTS(Dual<1>);

}  // namespace stickslip
