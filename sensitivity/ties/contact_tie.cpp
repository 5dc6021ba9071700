#include <limits>

#include "sensitivity/rays.hpp"
#include "sensitivity/ties/tie.hpp"

namespace stickslip {
namespace {

Choice choice_of(ContactState state) { return {static_cast<int>(state)}; }
ContactState state_of(const Choice& choice) { return static_cast<ContactState>(choice.branch); }

/// Trial traction lambda + rho g of point p, 1 + tangents components, force per area.
template <class T>
Vector<T> trial(const Model& model, const State<T>& state, const PointRegularisation<T>& rho, int p) {
  const auto& point = model.points[p];
  const int offset = tangential_offset(model, p);
  Vector<T> z(point.components());
  z[0] = state.multiplier[point.multiplier] + rho.normal * state.contact.gap[p];
  for (int a = 0; a < point.tangents; ++a)
    z[1 + a] = state.multiplier[point.multiplier + 1 + a] + rho.tangential * state.contact.slip[offset + a];
  return z;
}

/// Derivative s Dz of a trial traction along one side, and the size up to which it counts as zero. `kinematic_normal`,
/// `kinematic`: k / A over rho, normal and tangential; they turn a rate of rho g into that of k / A times g.
struct TrialRates {
  double normal;
  Vector<double> tangential;
  double negligible, kinematic_normal, kinematic;
};

TrialRates trial_rates(const SidedDerivative& derivative, int p) {
  constexpr double roundings = 64;
  const auto& [of, block, rho, side, scales, flows] = derivative;
  const double elastic = elastic_traction(of.slots, p);
  const Vector<Direction> z = trial(of.model, block.current, rho[p], p);
  TrialRates d{derivative.rate(z[0]), Vector<double>(z.size() - 1), 0, elastic / rho[p].normal.v,
               elastic / rho[p].tangential.v};
  for (Eigen::Index a = 0; a < d.tangential.size(); ++a) d.tangential[a] = derivative.rate(z[1 + a]);
  // (rho over k / A magnifies the rounding of a motion)
  d.negligible =
      std::max(rounding_share, roundings * unit_roundoff * (rho[p].normal.v / elastic)) * scales.of_tractions[0];
  return d;
}

Verdict contradicted(Choice by_choice, double by) { return {true, std::move(by_choice), by}; }

/// Slip in the direction of the trial's derivative, with normal part `normal`.
Choice slip_along(const TrialRates& d, double normal, ContactState piece) {
  Choice choice{static_cast<int>(piece), Vector<double>(1 + d.tangential.size())};
  choice.ray << normal, d.tangential;
  choice.ray /= choice.ray.cwiseAbs().maxCoeff();
  return choice;
}

/// Derivative s D bound of the friction bound, and the piece that it belongs to. At a corner: the lesser derivative.
struct BoundRate {
  double rate;
  ContactState piece;
};

bool is_at_corner(const FrictionLaw<double>& law, double pressure) {
  return law.corner() && law.distance_to_corner(pressure) <= weak_margin * law.bound(pressure, ContactState::limited);
}

/// `pressure_rate`: derivative of the pressure along the parameter.
BoundRate bound_rate(const FrictionLaw<Direction>& law, double pressure, double pressure_rate, double side) {
  constexpr double none = std::numeric_limits<double>::infinity();
  Direction p(pressure);
  p.d[0] = pressure_rate;
  const auto rate_on = [&](ContactState piece) {
    return BoundRate{law.has(piece) ? side * law.bound(p, piece).d[0] : none, piece};
  };
  const BoundRate sloping = rate_on(ContactState::slip), level = rate_on(ContactState::limited);
  if (is_at_corner(law.as<double>([](const Direction& x) { return x.v; }), pressure))
    return sloping.rate <= level.rate ? sloping : level;
  return law.piece(pressure) == ContactState::slip ? sloping : level;
}

/// Verdict on a closed point whose tangential trial is zero. `bound`: derivative of its bound, on `piece`; `now`: its
/// branch.
Verdict apex_verdict(const TrialRates& d, double bound, ContactState piece, const Choice& now) {
  const Choice stick = choice_of(ContactState::stick);
  const double length = d.tangential.norm(), excess = length - bound;
  const Choice slip = length > 0 ? slip_along(d, std::min(d.normal, 0.0), piece) : stick;
  if (state_of(now) == ContactState::open) return contradicted(excess <= 0 ? stick : slip, 0);
  if (state_of(now) == ContactState::stick)
    return excess <= d.negligible ? Verdict{} : contradicted(slip, excess / d.negligible);
  if (excess * d.kinematic < -d.negligible) return contradicted(stick, -excess * d.kinematic / d.negligible);
  if (bound <= d.negligible) return {};
  if (now.ray.size() == 0 || length == 0) return contradicted(slip, bound / d.negligible);
  const Vector<double> was = now.ray.tail(d.tangential.size());
  const double turned = (d.tangential / length - was / was.norm()).norm() * bound;
  return turned <= d.negligible ? Verdict{} : contradicted(slip, turned / d.negligible);
}

/// Verdict on a point whose normal trial is zero. `found`: its trial; `now`: its branch.
Verdict opening_verdict(const SidedDerivative& derivative, const ContactTie& tie, const TrialRates& d,
                        const Vector<double>& found, const Choice& now) {
  const SolvedState& of = derivative.of;
  const auto& law = derivative.block.slots.friction[of.model.points[tie.point].contact];
  const bool has_apex = tie.kind == ContactTie::Kind::apex;
  const bool jumps = !has_apex && d.tangential.size() > 0 && !law.has_apex();
  const double pull =
      elastic_traction(of.slots, tie.point) / of.rho[tie.point].tangential * norm(found.tail(d.tangential.size()));
  const bool bears = pull > weak_margin * of.largest;
  const bool open = state_of(now) == ContactState::open;
  if (!open && d.normal > d.negligible) {
    Verdict verdict = contradicted(choice_of(ContactState::open), d.normal / d.negligible);
    verdict.possible = !(jumps && bears);
    return verdict;
  }
  const double closing = -d.normal * d.kinematic_normal / d.negligible;
  if (open && !(closing > 1)) return {};
  Verdict verdict;
  if (has_apex)
    verdict = apex_verdict(d, -law.slope_at_apex().v * std::min(d.normal, 0.0), ContactState::slip, now);
  else if (jumps && open)
    verdict = contradicted(choice_of(ContactState::stick), 0);
  else if (!jumps && state_of(now) != ContactState::slip)
    verdict = contradicted(choice_of(ContactState::slip), 0);
  verdict.possible = !(jumps && bears && open);
  if (open) verdict.severity = closing;
  return verdict;
}

}  // namespace

void ContactTie::find(const SolvedState& of, std::vector<Tie>& ties) {
  const auto& [model, slots, state, memory, rho, cone, time, largest] = of;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const auto add = [&](Kind kind) { ties.emplace_back(ContactTie{p, kind}); };
    const double elastic = elastic_traction(slots, p);
    const double negligible = std::max(weak_margin * largest, elastic * tie_length(point, slots.geometry[p]));
    const Vector<double> z = trial(model, state, rho[p], p);
    const double tangential = norm(z.tail(point.tangents));
    const bool open = state.contact.state[p] == ContactState::open;
    const bool at_apex = point.tangents > 0 && elastic / rho[p].tangential * tangential <= negligible;
    const auto& law = slots.friction[point.contact];
    if (open ? elastic / rho[p].normal * z[0] <= negligible : -z[0] <= negligible) {
      add(at_apex && law.slope_at_apex() > 0 && !law.bears_nothing() ? Kind::apex : Kind::opens);
      continue;
    }
    if (open || point.tangents == 0) continue;
    const double pressure = -(cone == ConeRadius::augmented ? z[0] : state.multiplier[point.multiplier]);
    const double bound = law.bound(pressure);
    if (!(bound > 0)) {
      if (at_apex) add(Kind::line);
      continue;
    }
    const double excess = tangential - bound;
    // At a small rho, (|z_T| - bound) / rho is rounding although the slip itself is not.
    const double slip = norm(state.contact.slip.segment(tangential_offset(model, p), point.tangents));
    const double beyond = elastic * std::min(excess / rho[p].tangential, slip), inside = -excess;
    if ((excess > 0 ? beyond : inside) <= weak_margin * bound)
      add(Kind::slips);
    else if (excess > 0 && is_at_corner(law, pressure))
      add(Kind::corner);
  }
}

std::vector<Choice> ContactTie::choices(const Model& model) const {
  const Choice open = choice_of(ContactState::open), stick = choice_of(ContactState::stick),
               slip = choice_of(ContactState::slip), limited = choice_of(ContactState::limited);
  const auto& law = model.scene.contacts[model.points[point].contact].friction;
  if (kind == Kind::opens && (!law || law->has(ContactState::slip))) return {slip, open};
  if (kind == Kind::opens) return {stick, limited, open};
  std::vector<Choice> slips;
  for (const Choice& piece : {slip, limited})
    if (law->has(state_of(piece))) slips.push_back(piece);
  if (kind == Kind::corner) return slips;
  std::vector<Choice> all{stick};
  if (kind == Kind::slips) {
    all.insert(all.end(), slips.begin(), slips.end());
    return all;
  }
  if (kind == Kind::apex) all.push_back(open);
  if (model.points[point].tangents == 1)
    for (double direction : {-1.0, 1.0}) {
      all.push_back(slips.front());
      all.back().ray = Vector<double>(2);
      all.back().ray << (kind == Kind::apex ? -1.0 : 0.0), direction;
    }
  return all;
}

Choice ContactTie::now(const Model& model, const State<double>& at) const {
  Choice choice = choice_of(at.contact.state[point]);
  const auto& of = model.points[point];
  if (has_ray(model, at.contact.ray, point)) choice.ray = at.contact.ray.segment(of.multiplier, of.components());
  return choice;
}

void ContactTie::set(const Model& model, const Choice& choice, State<double>& at) const {
  at.contact.state[point] = state_of(choice);
  auto& ray = at.contact.ray;
  if (ray.size() == 0 && choice.ray.size() == 0) return;
  if (ray.size() == 0) ray = Vector<double>::Zero(model.multiplier_count);
  auto of_point = ray.segment(model.points[point].multiplier, model.points[point].components());
  if (choice.ray.size() == 0)
    of_point.setZero();
  else
    of_point = choice.ray;
}

Verdict ContactTie::verdict(const SidedDerivative& derivative) const {
  const SolvedState& of = derivative.of;
  const auto& at = of.model.points[point];
  const auto& law = derivative.block.slots.friction[at.contact];
  const TrialRates d = trial_rates(derivative, point);
  const Choice branch = now(of.model, of.at);
  const Vector<double> found = trial(of.model, of.at, of.rho[point], point);
  if (kind == Kind::opens || kind == Kind::apex) return opening_verdict(derivative, *this, d, found, branch);
  const bool augmented = of.cone == ConeRadius::augmented;
  const double pressure = augmented ? -found[0] : -of.at.multiplier[at.multiplier];
  const double pressure_rate =
      augmented ? -derivative.side * d.normal : -derivative.block.current.multiplier[at.multiplier].d[0];
  const auto [bound, piece] = bound_rate(law, pressure, pressure_rate, derivative.side);
  if (kind == Kind::line) {
    Verdict verdict = apex_verdict(d, std::max(bound, 0.0), piece, branch);
    verdict.possible = bound >= 0;
    return verdict;
  }
  const ContactState state = state_of(branch);
  if (is_slipping(state) && state != piece) {
    const double other = bound_rate(law, pressure, pressure_rate, -derivative.side).rate;
    const double apart = std::abs(bound + other) / d.negligible;
    if (apart > 1) return contradicted(choice_of(piece), apart);
  }
  if (kind == Kind::corner) return {};
  const auto tangential = found.tail(at.tangents);
  const double excess = tangential.dot(d.tangential) / norm(tangential) - bound;
  const bool sticks = state == ContactState::stick;
  const double by = (sticks ? excess : -excess * d.kinematic) / d.negligible;
  if (!(by > 1)) return {};
  return contradicted(choice_of(sticks ? piece : ContactState::stick), by);
}

}  // namespace stickslip
