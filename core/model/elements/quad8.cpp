/// Quadrilaterals of eight nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Quad8);

}  // namespace stickslip
