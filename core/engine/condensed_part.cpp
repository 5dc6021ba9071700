#include "core/engine/condensed_part_impl.hpp"

namespace stickslip {

template class CondensedPart<double>;

}  // namespace stickslip
