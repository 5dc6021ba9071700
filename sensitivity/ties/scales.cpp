#include "sensitivity/ties/scales.hpp"

#include "sensitivity/differentiation.hpp"

namespace stickslip {

double elastic_traction(const Slots<double>& slots, int p) { return slots.stiffness[p] / slots.geometry[p].area; }

double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state) {
  // A motion leaves errors of 1e-12 of itself in a gap. Without a pressure nothing else gives the gaps and slips of a
  // state their size. A body that comes from afar has moved a thousand times as far as its pressure would move it.
  constexpr double of_motion = 1e-12 / weak_margin;
  double largest = 0;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const double elastic = elastic_traction(slots, p);
    const auto moved = state.history.placement.segment(tangential_offset(model, p), model.points[p].tangents);
    largest = std::max({largest, -state.contact.traction[model.points[p].multiplier],
                        of_motion * elastic * std::abs(state.contact.gap[p] - slots.geometry[p].gap),
                        of_motion * elastic * norm(moved)});
  }
  return largest;
}

RateScales::RateScales(const Model& model, const Slots<double>& slots, const ParameterBlock& block,
                       const State<Direction>& at, const ByDirection& per_size, double largest)
    : per_parameter(per_size), of_bodies(ByDirection::Zero()), of_tractions(ByDirection::Zero()) {
  // What a rigid motion may leave of strains, of bodies a thousand times as long as wide.
  constexpr double rigid = 1e-3;
  for (const auto& u : at.displacement) of_bodies = of_bodies.max(u.d.abs());
  of_mesh = of_bodies;
  for (const auto& x : block.slots.points.reshaped()) of_mesh = of_mesh.max(x.d.abs());
  of_bodies *= rigid;
  of_mesh *= rigid;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const double elastic = elastic_traction(slots, p);
    const int offset = tangential_offset(model, p);
    auto& size = of_tractions;
    size = size.max(elastic * at.contact.gap[p].d.abs()).max(elastic * of_bodies);
    for (int c = 0; c < point.components(); ++c) size = size.max(at.contact.traction[point.multiplier + c].d.abs());
    for (int a = 0; a < point.tangents; ++a) size = size.max(elastic * at.history.placement[offset + a].d.abs());
  }
  of_tractions = of_tractions.max(largest * per_parameter);
}

}  // namespace stickslip
