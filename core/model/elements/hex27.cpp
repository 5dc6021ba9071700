/// Hexahedra of twenty-seven nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Hex27);

}  // namespace stickslip
