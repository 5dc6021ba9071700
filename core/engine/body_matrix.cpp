#include "core/engine/body_matrix.hpp"

namespace stickslip {

STICKSLIP_TANGENTS(, double);

}  // namespace stickslip
