#include "studies/metrics.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/response.hpp"
#include "methods/newton.hpp"

namespace stickslip {
namespace {

/// A point on the cone to within this share of its bound counts as on it.
constexpr double on_cone = 1e-6;

/// Relative rounding that some hundred terms leave.
constexpr double rounding = 1e-13;

/// Tangential parts of a point: traction, slip of the increment.
struct Tangential {
  Eigen::VectorXd traction, slip;
};

Tangential tangential(const Model& model, const State<double>& state, int p) {
  const auto& point = model.points[p];
  return {state.contact.traction.segment(point.multiplier + 1, point.tangents),
          state.contact.slip.segment(tangential_offset(model, p), point.tangents)};
}

struct Scales {
  double length = 0, traction = 0, force = 0;
};

/// Largest stiffness of an element against the displacement of one of its nodes.
double largest_stiffness(const Model& model, const Slots<double>& slots) {
  double largest = 0;
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_element_tangent(model, slots, b, nullptr, [&](const auto&, const auto& tangent) {
      largest = std::max(largest, tangent.diagonal().maxCoeff());
    });
  return largest;
}

/// Largest relative displacement (or elastic displacement of the tractions), traction and nodal force of a state.
void enlarge(const Model& model, const Slots<double>& slots, double stiffness, const State<double>& state, double time,
             Scales& scales) {
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const double traction = state.contact.traction.segment(point.multiplier, point.components()).norm();
    const double normal = state.contact.gap[p] - slots.geometry[p].gap;
    const double along =
        state.contact.placement.segment(tangential_offset(model, static_cast<int>(p)), point.tangents).norm();
    scales.traction = std::max(scales.traction, traction);
    scales.length =
        std::max({scales.length, std::hypot(normal, along), slots.geometry[p].area * traction / slots.stiffness[p]});
    // where nothing presses, what rounding of the displacements makes of tractions, and forces, is no scale for them
    scales.traction = std::max(scales.traction, rounding * slots.stiffness[p] / slots.geometry[p].area * scales.length);
  }
  const int D = model.dimension;
  scales.force = std::max({scales.force, rounding * stiffness * largest_nodal_norm(state.displacement, D),
                           largest_nodal_norm(bulk_forces(model, slots, state.displacement), D),
                           largest_nodal_norm(external_forces(model, slots, time), D),
                           largest_nodal_norm(contact_forces(model, slots, state.contact.traction), D)});
}

}  // namespace

double KktError::largest() const {
  double worst = equilibrium;
  for (double error : {gap, complementarity, cone, stick, slip_direction}) worst = larger(worst, error);
  return worst;
}

std::vector<KktError> kkt_errors(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory) {
  std::vector<KktError> errors;
  Scales scales;
  const double stiffness = largest_stiffness(model, slots);
  std::vector<Eigen::VectorXd> creep;
  for (const auto& point : model.points) creep.push_back(Eigen::VectorXd::Zero(point.tangents));
  for (const auto& increment : trajectory.increments) {
    const auto& state = increment.state;
    enlarge(model, slots, stiffness, state, increment.time, scales);
    KktError e;
    Vector<double> balance = nodal_balance(model, slots, state, increment.time);
    balance -= support_forces(model, slots, balance);
    e.equilibrium = detail::ratio(largest_nodal_norm(balance, model.dimension), scales.force);
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      const auto& point = model.points[p];
      const double gap = state.contact.gap[p], pressure = -state.contact.traction[point.multiplier];
      const double elastic = slots.stiffness[p] / slots.geometry[p].area;
      e.gap = larger(e.gap, detail::ratio(larger(0.0, -gap), scales.length));
      e.complementarity =
          larger(e.complementarity, detail::ratio(std::abs(std::min(gap * elastic, pressure)), scales.traction));
      if (point.tangents == 0) continue;
      const auto [traction, slip] = tangential(model, state, p);
      const double bound = slots.friction[point.contact] * std::max(0.0, pressure), size = traction.norm();
      e.cone = larger(e.cone, detail::ratio(larger(0.0, size - bound), scales.traction));
      const bool inside = pressure > 0 && size < bound * (1 - on_cone);
      creep[p] = inside ? Eigen::VectorXd(creep[p] + slip) : Eigen::VectorXd::Zero(point.tangents);
      e.stick = larger(e.stick, detail::ratio(creep[p].norm(), scales.length));
      const double moved = slip.norm();
      if (!inside && size > rounding * scales.traction && moved > 1e-9 * scales.length)
        e.slip_direction = larger(e.slip_direction, 1 - traction.dot(slip) / (size * moved));
    }
    errors.push_back(e);
  }
  return errors;
}

std::vector<ContactSummary> summarise(const Model& model, const Slots<double>& slots, const State<double>& state) {
  std::vector<ContactSummary> all(model.scene.contacts.size());
  for (auto& summary : all) summary.tangential_force.assign(model.dimension, 0.0);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    auto& summary = all[point.contact];
    const ContactState s = state.contact.state[p];
    ++(s == ContactState::open ? summary.open : s == ContactState::stick ? summary.stick : summary.slip);
    summary.penetration = std::max(summary.penetration, -state.contact.gap[p]);
    summary.normal_force -= slots.geometry[p].area * state.contact.traction[point.multiplier];
    for (int i = 0; i < model.dimension; ++i)
      for (int a = 0; a < point.tangents; ++a)
        summary.tangential_force[i] -= slots.geometry[p].area * state.contact.traction[point.multiplier + 1 + a] *
                                       slots.geometry[p].tangents(i, a);
  }
  return all;
}

}  // namespace stickslip
