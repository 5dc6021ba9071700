#include "core/engine/contact_system_impl.hpp"

namespace stickslip {

template class ContactSystem<double>;

}  // namespace stickslip
