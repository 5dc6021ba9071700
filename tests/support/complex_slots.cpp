#include "core/model/element_kernels_impl.hpp"
#include "core/model/point_tangent_impl.hpp"
#include "core/model/slots_impl.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip {

using Complex = std::complex<double>;

template <>
void for_each_element_tangent(const Model& model, const Slots<Complex>& slots, int b, const std::vector<int>* only,
                              const ElementSink<Complex>& sink, const BodyMotion<Complex>* at) {
  if (!at) return kernels_of<Complex>(model, b).tangents({model, slots, b, only}, nullptr, sink);
  Numbers<double> numbers;
  for (const auto& number : slots.numbers.at_slot) numbers.at_slot.push_back(number.real());
  const auto real = make_body_slots<double>(model, numbers, slots.points.real());
  const Vector<double> displacement = at->displacement.real(), last_memory = at->last_memory.real();
  const BodyMotion<double> motion{displacement, last_memory, at->time, at->branches};
  const auto as_complex = [&](const auto& nodes, const auto& K) { sink(nodes, K.template cast<Complex>()); };
  for_each_element_tangent<double>(model, real, b, only, as_complex, &motion);
}

STICKSLIP_SLOTS(, Complex);
STICKSLIP_ELEMENTS(, Complex);
STICKSLIP_TANGENTS(, Complex);
STICKSLIP_CONTACT(, Complex);
STICKSLIP_POINT_TANGENT(, Complex);
namespace detail {
STICKSLIP_FACINGS(, Complex);
}

}  // namespace stickslip
