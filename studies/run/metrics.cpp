#include "studies/run/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/model/response.hpp"
#include "methods/newton/residuals.hpp"

namespace stickslip {
namespace {

/// A point on the cone to within this share of its bound counts as on it.
constexpr double on_cone = 1e-6;

/// Relative rounding that some hundred terms leave.
constexpr double rounding = 1e-13;

/// Forces, tractions and relative displacements below this share of what the displacements would make of them by the
/// stiffness alone have lost more than half of their digits to cancellation, and a free body with such forces counts as
/// adrift (methods/newton/residuals.hpp): where nothing presses, they are no scale.
constexpr double significant = 1e-9;

/// Tangential parts of a point: traction, slip of the increment.
struct Tangential {
  Eigen::VectorXd traction, slip;
};

Tangential tangential(const Model& model, const State<double>& state, int p) {
  const auto& point = model.points[p];
  return {state.contact.traction.segment(point.multiplier + 1, point.tangents),
          state.contact.slip.segment(tangential_offset(model, p), point.tangents)};
}

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
void enlarge(const Model& model, const Slots<double>& slots, const State<double>& state, double time,
             KktScales& scales) {
  const int D = model.dimension;
  scales.reach = larger(scales.reach, largest_nodal_norm(state.displacement, D));
  scales.length = larger(scales.length, significant * scales.reach);
  double stiffest = 0;  // k / A
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const double traction = norm(state.contact.traction.segment(point.multiplier, point.components()));
    const double normal = state.contact.gap[p] - slots.geometry[p].gap;
    const double along =
        norm(state.history.placement.segment(tangential_offset(model, static_cast<int>(p)), point.tangents));
    const double elastic = slots.stiffness[p] / slots.geometry[p].area;
    stiffest = larger(stiffest, elastic);
    scales.traction = larger(scales.traction, traction);
    scales.length = larger(scales.length, larger(std::hypot(normal, along), traction / elastic));
  }
  scales.least_traction = significant * stiffest * (scales.reach + scales.length);
  scales.traction = larger(scales.traction, scales.least_traction);
  const Vector<double> loads = external_forces(model, slots, time, state.displacement);
  // A load is exact: above the rounding of the bodies' forces it shows how large forces are, be it ever so small.
  const double rounding = 10 * unit_roundoff * scales.stiffness * scales.reach;
  if (!(largest_nodal_norm(loads, D) > rounding))
    scales.force = larger(scales.force, significant * scales.stiffness * (scales.reach + scales.length));
  for (const auto& forces : {bulk_forces(model, slots, state.displacement, state.history.bodies), loads,
                             contact_forces(model, slots, state.contact)})
    scales.force = larger(scales.force, largest_nodal_norm(forces, D));
}

/// Share of a scale, as no number where that has overflowed.
double share(double x, double scale) {
  return std::isfinite(scale) ? detail::ratio(x, scale) : std::numeric_limits<double>::quiet_NaN();
}

PointDefects defects_of(const Model& model, const Slots<double>& slots, const State<double>& previous,
                        const State<double>& state, const KktScales& scales, const ElasticLayer& layer, int p,
                        Eigen::VectorXd& creep) {
  const auto& point = model.points[p];
  PointDefects d;
  const double pressure = -state.contact.traction[point.multiplier];
  double gap = state.contact.gap[p];
  if (!layer.normal.empty()) gap += layer.normal[p] * pressure;
  d.penetration = larger(0.0, -gap);
  d.complementarity = std::abs(larger(-gap * slots.stiffness[p] / slots.geometry[p].area, -pressure));
  if (point.tangents == 0) return d;
  auto [traction, slip] = tangential(model, state, p);
  if (!layer.tangential.empty()) slip -= layer.tangential[p] * (traction - tangential(model, previous, p).traction);
  const double bound = slots.friction[point.contact].bound(larger(0.0, pressure)), size = norm(traction);
  d.cone = larger(0.0, size - bound);
  const double nothing = 1e-4 * scales.least_traction;  // what rounding makes of displacements
  const bool inside = pressure > nothing && size < bound - std::max(on_cone * bound, layer.band * scales.traction);
  creep = inside ? Eigen::VectorXd(creep + slip) : Eigen::VectorXd::Zero(point.tangents);
  d.creep = norm(creep);
  const double moved = norm(slip);
  if (inside || size <= std::max(nothing, rounding * scales.traction) || moved <= 1e-9 * scales.length) return d;
  const int exponent = std::ilogb(size);  // a power of two rounds nothing, and products do not underflow
  const Eigen::VectorXd scaled = traction.unaryExpr([&](double t) { return std::ldexp(t, -exponent); });
  const double length = std::ldexp(size, -exponent), along = scaled.dot(slip) / length;
  d.pull = size;
  d.turn = 1 - along / moved;
  d.astray = norm(slip - larger(0.0, along) / length * scaled);
  return d;
}

std::vector<PointDefects> point_defects(const Model& model, const Slots<double>& slots, const State<double>& previous,
                                        const State<double>& state, const KktScales& scales, const ElasticLayer& layer,
                                        std::vector<Eigen::VectorXd>& creep) {
  std::vector<PointDefects> defects;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
    defects.push_back(defects_of(model, slots, previous, state, scales, layer, p, creep[p]));
  return defects;
}

/// Largest Euclidean norm of the nodal vectors, NaN where one is, and the node.
std::pair<double, int> largest_at(const Vector<double>& nodal, int D) {
  std::pair<double, int> worst{0, 0};
  for (int node = 0; node * D < nodal.size(); ++node) {
    const double norm = largest_nodal_norm(Vector<double>(nodal.segment(node * D, D)), D);
    if (!(norm <= worst.first)) worst = {norm, node};
    if (std::isnan(norm)) break;
  }
  return worst;
}

}  // namespace

double KktError::largest() const {
  double worst = equilibrium;
  for (double error : {gap, complementarity, cone, stick, slip_direction}) worst = larger(worst, error);
  return worst;
}

DefectReader::DefectReader(const Model& model, const Slots<double>& slots) : model_(model), slots_(slots) {
  plain_.scales.stiffness = largest_stiffness(model, slots);
  for (const auto& point : model.points) creep_.emplace_back(Eigen::VectorXd::Zero(point.tangents));
  creep_with_layer_ = creep_;
}

void DefectReader::read(const State<double>& before, const Increment<double>& increment, const ElasticLayer* layer) {
  enlarge(model_, slots_, increment.state, increment.time, plain_.scales);
  Vector<double> balance = nodal_balance(model_, slots_, increment.state, increment.time);
  balance -= support_forces(model_, slots_, balance);
  std::tie(plain_.imbalance, plain_.node) = largest_at(balance, model_.dimension);
  plain_.points = point_defects(model_, slots_, before, increment.state, plain_.scales, {}, creep_);
  with_layer_ = layer ? point_defects(model_, slots_, before, increment.state, plain_.scales, *layer, creep_with_layer_)
                      : plain_.points;
}

void visit_defects(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
                   const std::function<ElasticLayer(const Increment<double>&)>& layer,
                   const std::function<void(std::size_t, const KktDefects&, const std::vector<PointDefects>&)>& f) {
  DefectReader reader(model, slots);
  const State<double>* before = &trajectory.initial;
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    const ElasticLayer given = layer ? layer(increment) : ElasticLayer{};
    reader.read(*before, increment, layer ? &given : nullptr);
    f(n, reader.defects(), reader.with_layer());
    before = &increment.state;
  }
}

KktError relative(const KktDefects& defects) {
  const auto& scales = defects.scales;
  KktError e;
  e.equilibrium = share(defects.imbalance, scales.force);
  for (const auto& point : defects.points) {
    e.gap = larger(e.gap, share(point.penetration, scales.length));
    e.complementarity = larger(e.complementarity, share(point.complementarity, scales.traction));
    e.cone = larger(e.cone, share(point.cone, scales.traction));
    e.stick = larger(e.stick, share(point.creep, scales.length));
    e.slip_direction = larger(e.slip_direction, point.turn);
  }
  return e;
}

std::vector<KktError> kkt_errors(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory) {
  std::vector<KktError> errors;
  visit_defects(model, slots, trajectory, nullptr,
                [&](std::size_t, const KktDefects& defects, const auto&) { errors.push_back(relative(defects)); });
  return errors;
}

bool ContactSummary::is_finite() const {
  return std::isfinite(penetration) && std::isfinite(normal_force) &&
         std::all_of(tangential_force.begin(), tangential_force.end(), [](double f) { return std::isfinite(f); });
}

ContactSummary& ContactSummary::operator+=(const ContactSummary& other) {
  open += other.open;
  stick += other.stick;
  slip += other.slip;
  penetration = larger(penetration, other.penetration);
  normal_force += other.normal_force;
  tangential_force.resize(other.tangential_force.size(), 0.0);
  for (std::size_t i = 0; i < tangential_force.size(); ++i) tangential_force[i] += other.tangential_force[i];
  return *this;
}

std::vector<ContactSummary> summarise(const Model& model, const Slots<double>& slots, const State<double>& state) {
  std::vector<ContactSummary> all(model.scene.contacts.size());
  for (auto& summary : all) summary.tangential_force.assign(model.dimension, 0.0);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    auto& summary = all[point.contact];
    const ContactState s = state.contact.state[p];
    ++(s == ContactState::open ? summary.open : s == ContactState::stick ? summary.stick : summary.slip);
    summary.penetration = larger(summary.penetration, -state.contact.gap[p]);
    summary.normal_force -= area_in(state.contact, slots, p) * state.contact.traction[point.multiplier];
    for (int i = 0; i < model.dimension; ++i)
      for (int a = 0; a < point.tangents; ++a)
        summary.tangential_force[i] -= area_in(state.contact, slots, p) *
                                       state.contact.traction[point.multiplier + 1 + a] *
                                       geometry_in(state.contact, slots, p).tangents(i, a);
  }
  return all;
}

}  // namespace stickslip
