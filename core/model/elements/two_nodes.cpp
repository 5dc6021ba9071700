/// Bars and springs.
#include "core/model/element_kernels_impl.hpp"

namespace stickslip {

STICKSLIP_ELEMENTS_OF(, double, TwoNodes<2>);
STICKSLIP_ELEMENTS_OF(, double, TwoNodes<3>);

}  // namespace stickslip
