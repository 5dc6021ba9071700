#include "core/model/contact_assembly_impl.hpp"

namespace stickslip {

namespace detail {

STICKSLIP_FACINGS(, double);

}  // namespace detail

STICKSLIP_CONTACT(, double);

}  // namespace stickslip
