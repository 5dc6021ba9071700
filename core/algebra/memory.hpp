/// Memory of the process.
#pragma once

namespace stickslip {

/// Has the C library keep memory that is freed, for what is allocated next. Increments free and allocate the same large
/// arrays again and again. Pages that go back to the system in between are handed out anew one by one, and zeroed: on a
/// virtual machine that took half the time of a frictionless step of 103 000 dofs. For programs: a library leaves the
/// choice to its host. Of glibc alone; elsewhere nothing happens.
void keep_freed_memory();

}  // namespace stickslip
