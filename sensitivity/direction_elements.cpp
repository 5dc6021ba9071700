/// Elements in the scalar of direct differentiation.
#include "core/model/element_kernels_impl.hpp"
#include "sensitivity/differentiation.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS(, Direction);

}  // namespace stickslip
