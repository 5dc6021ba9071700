#include "core/engine/condensed_engine_impl.hpp"

namespace stickslip {

template class CondensedEngine<double>;

}  // namespace stickslip
