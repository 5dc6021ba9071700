/// Triangles of six nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Tri6);

}  // namespace stickslip
