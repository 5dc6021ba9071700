/// Tetrahedra of ten nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Tet10);

}  // namespace stickslip
