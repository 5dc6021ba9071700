#include "tests/support/compiled_slots.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, Dual<1>);

}  // namespace stickslip
