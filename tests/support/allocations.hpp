/// Counts what operator new gives out, in test programs that have tests/methods/allocations.cpp in them.
#pragma once

namespace stickslip {

/// Calls of operator new since the start of the program.
long allocations();

}  // namespace stickslip
