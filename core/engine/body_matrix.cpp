#include "core/engine/body_matrix.hpp"

#include "core/model/slots_impl.hpp"

namespace stickslip {

STICKSLIP_TANGENTS(, double);

}  // namespace stickslip
