/// Quadrilaterals of four nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Quad4);

}  // namespace stickslip
