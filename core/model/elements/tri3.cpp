/// Triangles of three nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Tri3);

}  // namespace stickslip
