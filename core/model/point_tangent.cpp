#include "core/model/point_tangent_impl.hpp"

namespace stickslip {

STICKSLIP_POINT_TANGENT(, double);

}  // namespace stickslip
