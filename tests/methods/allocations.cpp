// A file of its own: where the compiler sees both sides, it takes free() of what this operator new gave for a mistake.
#include "tests/support/allocations.hpp"

#include <cstdlib>
#include <new>

namespace {
long count = 0;
}

long stickslip::allocations() { return count; }

void* operator new(std::size_t size) {
  ++count;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++count;
  return std::malloc(size ? size : 1);
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
