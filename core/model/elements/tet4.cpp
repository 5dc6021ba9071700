/// Tetrahedra of four nodes.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, Tet4);

}  // namespace stickslip
