/// Slots, elements and contact points on the tape of the adjoint mode.
#include "core/model/contact_assembly_impl.hpp"
#include "core/model/element_kernels_impl.hpp"
#include "core/model/slots_impl.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, Reverse);
STICKSLIP_ELEMENTS(, Reverse);
STICKSLIP_CONTACT(, Reverse);

}  // namespace stickslip
