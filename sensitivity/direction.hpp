/// The scalar of direct differentiation.
#pragma once

#include "core/model/contact_assembly.hpp"
#include "core/model/slots.hpp"

namespace stickslip {

/// Parameters differentiated in one sweep.
inline constexpr int directions = 4;
using Direction = Dual<directions>;

STICKSLIP_SLOTS(extern, Direction);  // compiled in directions.cpp
STICKSLIP_CONTACT(extern, Direction);

}  // namespace stickslip
