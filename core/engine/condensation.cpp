#include "core/engine/condensation_impl.hpp"

namespace stickslip {

template class Condensation<double>;

}  // namespace stickslip
