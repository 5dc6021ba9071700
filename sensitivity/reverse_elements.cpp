/// Elements on the tape of the adjoint mode.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS(Reverse);

}  // namespace stickslip
