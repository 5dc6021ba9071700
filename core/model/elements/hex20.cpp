/// Hexahedra of twenty nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Hex20);

}  // namespace stickslip
