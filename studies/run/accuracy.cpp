#include "studies/run/accuracy.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "methods/newton/regularisation.hpp"
#include "methods/stepping/prescribed.hpp"

namespace stickslip {
namespace {

/// What a method leaves by its options: shares of the largest force, and of the largest length and traction.
struct Tolerances {
  double force, contact;
};
template <WholeMethod M>
Tolerances tolerances(const M& m) {
  return {m.newton.tolerance, m.contact_tolerance()};
}

/// The scales that a method measures its residuals by are those of its own iterates and of condensed forces.
constexpr double headroom = 10;

/// Where multipliers prevent penetration, points are on the cone of the last one but for the tolerance.
template <WholeMethod M>
ElasticLayer layer_of(const M& m, const RegularisationField<double>& rho) {
  if constexpr (M::prevents_penetration) return {{}, {}, headroom * m.contact_tolerance()};
  ElasticLayer layer;
  for (const auto& r : rho) {
    layer.normal.push_back(1 / r.normal);
    layer.tangential.push_back(1 / r.tangential);
  }
  return layer;
}

/// What is explained of the defects of one increment.
struct Allowance {
  double force = 0, length = 0, traction = 0;
  bool drowned = false;  ///< forces of the bodies round by more than is accepted
};

/// A share of a scale: what the tolerance leaves, and what rounding does, which counts up to `most`.
double share(double tolerance, double rounding, double scale, double most) {
  return headroom * tolerance + (scale > 0 ? std::min(rounding / scale, most) : 0);
}

Allowance allowance(const Model& model, const Slots<double>& slots, const Tolerances& tolerance,
                    const RegularisationField<double>& rho, const KktScales& scales) {
  // Where nothing presses (KktScales), errors are relative to what is next to nothing itself.
  const double most = scales.traction > scales.least_traction ? most_rounding : 100 * most_rounding;
  // Hundreds of terms meet in a row, and each rounds once; Uzawa's updates end at ten times that.
  constexpr double terms = 1e3;
  double stiffest = 0, softest = std::numeric_limits<double>::infinity(), contact = 0, tie = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const double largest = std::max(rho[p].normal, rho[p].tangential);
    stiffest = std::max({stiffest, largest, slots.stiffness[p] / slots.geometry[p].area});
    softest = std::min({softest, rho[p].normal, rho[p].tangential});
    contact = std::max(contact, slots.geometry[p].area * largest);
    tie = std::max(tie, tie_length(model.points[p], slots.geometry[p]));
  }
  const double yield = 10 * unit_roundoff * scales.traction / softest;  // a gap is seen as a traction over rho
  const double displacement = terms * unit_roundoff * (scales.reach + scales.length) + tie;
  // what rounding leaves of the forces, Uzawa's updates turn into tractions, and into gaps through the local stiffness
  const double in_bodies = scales.force > 0 ? scales.stiffness * displacement / scales.force : 0;
  const double passed_on = std::min(in_bodies, most);
  return {scales.force * share(tolerance.force, (scales.stiffness + contact) * displacement, scales.force, most),
          scales.length * (share(tolerance.contact, displacement + yield, scales.length, most) + passed_on),
          scales.traction * (share(tolerance.contact, stiffest * displacement, scales.traction, most) + passed_on),
          in_bodies > most};
}

/// A defect of an increment, as its component of the method-blind error, and how it compares with what is explained.
struct Finding {
  double excess = 0;  ///< defect / allowed
  double value = 0;
  const char* component = "";
  std::string where;
};

std::string name_of_node(const Model& model, const Slots<double>& slots, int node) {
  std::size_t body = 0;
  while (body + 1 < model.bodies.size() && model.bodies[body + 1].first_node <= node) ++body;
  std::string place;
  for (int i = 0; i < model.dimension; ++i) place += (i ? ", " : "") + short_number(slots.points(i, node));
  return "the node of " + model.scene.bodies[body].name + " at (" + place + ")";
}

/// The defect that exceeds by most what is explained of it. `count`: increments so far, each of which may leave creep.
Finding worst(const Model& model, const Slots<double>& slots, const RegularisationField<double>& rho,
              const KktDefects& defects, const std::vector<PointDefects>& points, const Allowance& allowed,
              std::size_t count) {
  Finding found;
  int place = -1;
  const auto compare = [&](const char* component, double defect, double most, double value, int point) {
    if (!(defect > most) || defect / most <= found.excess) return;
    found = {defect / most, value, component, ""};
    place = point;
  };
  const auto& scales = defects.scales;
  compare("equilibrium", defects.imbalance, allowed.force, defects.imbalance / scales.force, -1);
  for (int p = 0; p < static_cast<int>(points.size()); ++p) {
    const auto& d = points[p];
    const double elastic = slots.stiffness[p] / slots.geometry[p].area;
    const double friction = slots.friction[model.points[p].contact].slope_at_apex();
    const double most = std::max(allowed.traction, most_rounding * scales.traction);
    // a gap within what is allowed of gaps is as much of a traction as it would take to close it
    const double complementarity = std::min(allowed.traction + elastic * allowed.length, most);
    compare("gap", d.penetration, allowed.length, d.penetration / scales.length, p);
    compare("complementarity", d.complementarity, complementarity, d.complementarity / scales.traction, p);
    compare("cone", d.cone, (1 + friction) * allowed.traction, d.cone / scales.traction, p);
    compare("stick", d.creep, static_cast<double>(count) * allowed.length, d.creep / scales.length, p);
    if (d.pull > allowed.traction)
      compare("slip_direction", d.astray, allowed.length + allowed.traction / rho[p].tangential, d.turn, p);
  }
  if (found.excess > 0)
    found.where = place < 0 ? name_of_node(model, slots, defects.node) : name_of_point(model, slots, place);
  return found;
}

}  // namespace

AccuracyReader::AccuracyReader(const Model& model, const Slots<double>& slots, const Method& method)
    : model_(model),
      slots_(slots),
      method_(method),
      initial_(std::visit([&](const auto& m) { return initial_regularisation(slots, m); }, method)),
      defects_(model, slots) {}

void AccuracyReader::read(const State<double>& before, const Increment<double>& increment) {
  const auto rho = adapted(initial_, increment.rho_factor);
  const ElasticLayer layer = std::visit([&](const auto& m) { return layer_of(m, rho); }, method_);
  defects_.read(before, increment, &layer);
  const KktDefects& defects = defects_.defects();
  accuracy_.errors.push_back(relative(defects));
  accuracy_.scales = defects.scales;
  const auto tolerance = std::visit([](const auto& m) { return tolerances(m); }, method_);
  const auto allowed = allowance(model_, slots_, tolerance, rho, defects.scales);
  const auto found = worst(model_, slots_, rho, defects, defects_.with_layer(), allowed, accuracy_.errors.size());
  accuracy_.faults.emplace_back();
  if (found.excess == 0) return;
  const auto name = std::visit([](const auto& m) { return std::string(m.regularisation_name); }, method_);
  const std::string smaller = model_.points.empty() ? "" : "try a smaller " + name;
  const auto after = [&](const char* words) { return smaller.empty() ? "" : words + smaller; };
  const std::string why = allowed.drowned ? "forces of the stiffest body, as far as it moves, round by more than is "
                                            "accepted; hold it by supports, make it an obstacle" +
                                                after(", or ")
                                          : "which neither the method nor rounding explains" + after("; ");
  accuracy_.faults.back() = "the method-blind error \"" + std::string(found.component) + "\" is " +
                            short_number(found.value) + " at " + found.where + ", " + why;
}

Accuracy assess(const Model& model, const Slots<double>& slots, const Method& method,
                const Trajectory<double>& trajectory) {
  AccuracyReader reader(model, slots, method);
  const State<double>* before = &trajectory.initial;
  for (const auto& increment : trajectory.increments) {
    reader.read(*before, increment);
    before = &increment.state;
  }
  return reader.accuracy();
}

void mark_inaccurate(const Accuracy& accuracy, Trajectory<double>& trajectory) {
  const Increment<double>* failed = nullptr;  // within the present step
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
    auto& increment = trajectory.increments[n];
    const bool finite = std::isfinite(accuracy.errors[n].largest());
    if (is_converged(increment.status) && (!finite || !accuracy.faults[n].empty())) {
      increment.status = finite ? Status::inaccurate : Status::not_finite;
      increment.message = finite ? accuracy.faults[n] : "forces or displacements overflow: the error is not finite";
      failed = &increment;
    } else if (failed && is_converged(increment.status)) {  // a later part of the same step
      increment.status = failed->status;
      increment.message = failed->message;
    }
    if (failed && is_converged(trajectory.status)) {
      trajectory.status = failed->status;
      trajectory.message = failed->message;
    }
    if (increment.requested) failed = nullptr;
  }
}

std::vector<KktError> check_accuracy(const Model& model, const Slots<double>& slots, const Method& method,
                                     Trajectory<double>& trajectory) {
  auto accuracy = assess(model, slots, method, trajectory);
  mark_inaccurate(accuracy, trajectory);
  return std::move(accuracy.errors);
}

}  // namespace stickslip
