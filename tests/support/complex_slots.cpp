#include "core/model/element_kernels_impl.hpp"
#include "core/model/point_tangent_impl.hpp"
#include "core/model/slots_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

STICKSLIP_SLOTS(, std::complex<double>);
STICKSLIP_ELEMENTS(std::complex<double>);
STICKSLIP_TANGENTS(, std::complex<double>);
STICKSLIP_CONTACT(, std::complex<double>);
STICKSLIP_POINT_TANGENT(, std::complex<double>);
namespace detail {
STICKSLIP_FACINGS(, std::complex<double>);
}

}  // namespace stickslip
