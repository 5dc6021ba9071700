/// The engines in the oracle's scalar.
#include "core/engine/condensation_impl.hpp"
#include "core/engine/condensed_engine_impl.hpp"
#include "core/engine/sparse_engine_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

template class Condensation<std::complex<double>>;
template class ContactSystem<std::complex<double>>;
template class CondensedTangent<std::complex<double>>;
template class SparseSystem<std::complex<double>>;
template class CondensedEngine<std::complex<double>>;
template class SparseEngine<std::complex<double>>;

}  // namespace stickslip
