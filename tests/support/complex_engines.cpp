/// The engines in the oracle's scalar.
#include "core/engine/condensation_impl.hpp"
#include "core/engine/engine_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

template class Condensation<std::complex<double>>;
STICKSLIP_ENGINES(, std::complex<double>);

}  // namespace stickslip
