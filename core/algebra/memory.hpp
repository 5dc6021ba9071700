/// Memory of the process.
#pragma once

#include <cstddef>
#include <new>

namespace stickslip {

/// There is no room for the work space of the BLAS.
struct NoWorkSpace : std::bad_alloc {
  static constexpr std::size_t bytes = (128UL << 20) + (1UL << 20);  ///< of OpenBLAS on x86-64, and what is beside it
  const char* what() const noexcept override {
    return "there is not enough memory: the BLAS needs 135 MB of address space for its work; allow the process more "
           "(ulimit -v)";
  }
};

/// Has the C library keep memory that is freed, for what is allocated next. Increments free and allocate the same large
/// arrays again and again. Pages that go back to the system in between are handed out anew one by one, and zeroed: on a
/// virtual machine that took half the time of a frictionless step of 103 000 dofs. For programs: a library leaves the
/// choice to its host. Of glibc alone; elsewhere nothing happens.
void keep_freed_memory();

}  // namespace stickslip
