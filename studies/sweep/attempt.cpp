#include "studies/sweep/attempt.hpp"

#include <new>
#include <stdexcept>

#include "core/algebra/memory.hpp"

namespace stickslip {

std::optional<Breakdown> attempt(const std::function<void()>& work) {
  try {
    work();
    return std::nullopt;
  } catch (const NoWorkSpace& error) {
    return Breakdown{"cap", error.what()};
  } catch (const std::bad_alloc&) {
    return Breakdown{"cap", "there is not enough memory; a coarser mesh or fewer steps need less"};
  } catch (const std::length_error&) {  // a container beyond all memory
    return Breakdown{"cap", "there is not enough memory; a coarser mesh or fewer steps need less"};
  } catch (const std::exception& error) {
    return Breakdown{"failed", std::string("the program broke down, please report it with the scene: ") + error.what()};
  } catch (...) {
    return Breakdown{"failed", "the program broke down, please report it with the scene"};
  }
}

}  // namespace stickslip
