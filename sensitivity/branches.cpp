#include "sensitivity/branches.hpp"

#include <limits>

#include "sensitivity/one_sided.hpp"

namespace stickslip {
namespace {

using Tie = WeakPoint::Tie;

/// k / A of a point: traction per displacement of its node.
double elastic_traction(const Slots<double>& slots, std::size_t p) {
  return slots.stiffness[p] / slots.geometry[p].area;
}

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

/// Size of a derivative of a traction up to which it counts as zero: 1e-10 of the largest of
///
///   traction_rates()
///   the largest traction of the run, over the size of the parameter
///
/// `multiple`: rho over k / A, which magnifies the rounding of a motion.
double negligible(const Model& model, const Slots<double>& slots, const ParameterBlock& block, double multiple,
                  const SideDirection& along) {
  constexpr double share = 1e-10, roundings = 64;
  const double of_traction = along.parameter > 0 ? along.largest_so_far / along.parameter : 0;
  return std::max(share, roundings * unit_roundoff * multiple) *
         std::max(of_traction, traction_rates(model, slots, block.current)[0]);
}

/// Derivative s Dz of a trial traction along one side, and the size up to which it counts as zero. `kinematic_normal`,
/// `kinematic`: k / A over rho, normal and tangential; they turn a rate of rho g into that of k / A times g.
struct TrialRates {
  double normal;
  Vector<double> tangential;
  double negligible, kinematic_normal, kinematic;
};

/// Slip in the direction of the trial's derivative, with normal part `normal`.
Branch slip_along(const TrialRates& d, double normal, ContactState piece) {
  Branch branch{piece, Vector<double>(1 + d.tangential.size())};
  branch.ray << normal, d.tangential;
  branch.ray /= branch.ray.cwiseAbs().maxCoeff();
  return branch;
}

Verdict contradicted(Branch by_branch, double by) { return {true, std::move(by_branch), by}; }

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
Verdict apex_verdict(const TrialRates& d, double bound, ContactState piece, const Branch& now) {
  const Branch stick{ContactState::stick, {}};
  const double length = d.tangential.norm(), excess = length - bound;
  const Branch slip = length > 0 ? slip_along(d, std::min(d.normal, 0.0), piece) : stick;
  if (now.state == ContactState::open) return contradicted(excess <= 0 ? stick : slip, 0);
  if (now.state == ContactState::stick)
    return excess <= d.negligible ? Verdict{} : contradicted(slip, excess / d.negligible);
  if (excess * d.kinematic < -d.negligible) return contradicted(stick, -excess * d.kinematic / d.negligible);
  if (bound <= d.negligible) return {};
  if (now.ray.size() == 0 || length == 0) return contradicted(slip, bound / d.negligible);
  const Vector<double> was = now.ray.tail(d.tangential.size());
  const double turned = (d.tangential / length - was / was.norm()).norm() * bound;
  return turned <= d.negligible ? Verdict{} : contradicted(slip, turned / d.negligible);
}

}  // namespace

double traction_scale(const Model& model, const Slots<double>& slots, const State<double>& state) {
  double largest = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const double elastic = elastic_traction(slots, p);
    largest = std::max({largest, -state.contact.traction[model.points[p].multiplier],
                        elastic * std::abs(state.contact.gap[p] - slots.geometry[p].gap)});
    const int offset = tangential_offset(model, static_cast<int>(p));
    largest = std::max(largest, elastic * norm(state.history.placement.segment(offset, model.points[p].tangents)));
  }
  return largest;
}

Direction::Gradient traction_rates(const Model& model, const Slots<double>& slots, const State<Direction>& at) {
  constexpr double rigid = 1e-3;
  Direction::Gradient size = Direction::Gradient::Zero(), largest_motion = size;
  for (const auto& u : at.displacement) largest_motion = largest_motion.max(u.d.abs());
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const double elastic = elastic_traction(slots, p);
    const int offset = tangential_offset(model, p);
    size = size.max(elastic * at.contact.gap[p].d.abs()).max(rigid * elastic * largest_motion);
    for (int c = 0; c < point.components(); ++c) size = size.max(at.contact.traction[point.multiplier + c].d.abs());
    for (int a = 0; a < point.tangents; ++a) size = size.max(elastic * at.history.placement[offset + a].d.abs());
  }
  return size;
}

std::vector<WeakPoint> weak_points(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   const RegularisationField<double>& rho, ConeRadius cone, double largest) {
  std::vector<WeakPoint> weak;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const double elastic = elastic_traction(slots, p);
    const double negligible = std::max(weak_margin * largest, elastic * tie_length(point, slots.geometry[p]));
    const Vector<double> z = trial(model, state, rho[p], p);
    const double tangential = norm(z.tail(point.tangents));
    const bool open = state.contact.state[p] == ContactState::open;
    const bool at_apex = point.tangents > 0 && elastic / rho[p].tangential * tangential <= negligible;
    const auto& law = slots.friction[point.contact];
    if (open ? elastic / rho[p].normal * z[0] <= negligible : -z[0] <= negligible) {
      weak.push_back({p, at_apex && law.slope_at_apex() > 0 && !law.bears_nothing() ? Tie::apex : Tie::opens});
      continue;
    }
    if (open || point.tangents == 0) continue;
    const double pressure = -(cone == ConeRadius::augmented ? z[0] : state.multiplier[point.multiplier]);
    const double bound = law.bound(pressure);
    if (!(bound > 0)) {
      if (at_apex) weak.push_back({p, Tie::line});
      continue;
    }
    const double excess = tangential - bound;
    // At a small rho, (|z_T| - bound) / rho is rounding although the slip itself is not.
    const double slip = norm(state.contact.slip.segment(tangential_offset(model, p), point.tangents));
    const double beyond = elastic * std::min(excess / rho[p].tangential, slip), inside = -excess;
    if ((excess > 0 ? beyond : inside) <= weak_margin * bound)
      weak.push_back({p, Tie::slips});
    else if (excess > 0 && is_at_corner(law, pressure))
      weak.push_back({p, Tie::corner});
  }
  return weak;
}

Branch branch_of(const Model& model, const State<double>& at, int point) {
  Branch branch{at.contact.state[point], {}};
  const auto& of = model.points[point];
  if (has_ray(model, at.contact.ray, point)) branch.ray = at.contact.ray.segment(of.multiplier, of.components());
  return branch;
}

void set_branch(const Model& model, int point, const Branch& branch, State<double>& at) {
  at.contact.state[point] = branch.state;
  auto& ray = at.contact.ray;
  if (ray.size() == 0 && branch.ray.size() == 0) return;
  if (ray.size() == 0) ray = Vector<double>::Zero(model.multiplier_count);
  auto of_point = ray.segment(model.points[point].multiplier, model.points[point].components());
  if (branch.ray.size() == 0)
    of_point.setZero();
  else
    of_point = branch.ray;
}

std::vector<Branch> branches_of(const Model& model, const WeakPoint& weak) {
  const Branch open{ContactState::open, {}}, stick{ContactState::stick, {}}, slip{ContactState::slip, {}},
      limited{ContactState::limited, {}};
  const auto& law = model.scene.contacts[model.points[weak.point].contact].friction;
  if (weak.tie == Tie::opens && (!law || law->has(ContactState::slip))) return {slip, open};
  if (weak.tie == Tie::opens) return {stick, limited, open};
  std::vector<Branch> slips;
  for (const Branch& piece : {slip, limited})
    if (law->has(piece.state)) slips.push_back(piece);
  if (weak.tie == Tie::corner) return slips;
  std::vector<Branch> all{stick};
  if (weak.tie == Tie::slips) {
    all.insert(all.end(), slips.begin(), slips.end());
    return all;
  }
  if (weak.tie == Tie::apex) all.push_back(open);
  if (model.points[weak.point].tangents == 1)
    for (double direction : {-1.0, 1.0}) {
      all.push_back(slips.front());
      all.back().ray = Vector<double>(2);
      all.back().ray << (weak.tie == Tie::apex ? -1.0 : 0.0), direction;
    }
  return all;
}

Verdict branch_verdict(const Model& model, const Slots<double>& slots, const ParameterBlock& block,
                       const RegularisationField<Direction>& rho, const RegularisationField<double>& own,
                       ConeRadius cone, const WeakPoint& weak, const State<double>& at,
                       const SideDirection& direction) {
  const int p = weak.point;
  const double side = direction.side;
  const auto& point = model.points[p];
  const double elastic = elastic_traction(slots, p);
  const Vector<Direction> z = trial(model, block.current, rho[p], p);
  TrialRates d{side * z[0].d[0], Vector<double>(point.tangents), 0, elastic / rho[p].normal.v,
               elastic / rho[p].tangential.v};
  for (int a = 0; a < point.tangents; ++a) d.tangential[a] = side * z[1 + a].d[0];
  d.negligible = negligible(model, slots, block, rho[p].normal.v / elastic, direction);
  const Branch now = branch_of(model, at, p);
  const bool open = now.state == ContactState::open;
  const auto& law = block.slots.friction[point.contact];
  const Vector<double> found = trial(model, at, own[p], p);
  if (weak.tie == Tie::opens || weak.tie == Tie::apex) {
    const bool jumps = weak.tie == Tie::opens && point.tangents > 0 && !law.has_apex();
    const bool bears =
        elastic / own[p].tangential * norm(found.tail(point.tangents)) > weak_margin * direction.largest_so_far;
    if (!open && d.normal > d.negligible) {
      Verdict verdict = contradicted({ContactState::open, {}}, d.normal / d.negligible);
      verdict.possible = !(jumps && bears);
      return verdict;
    }
    const double closing = -d.normal * d.kinematic_normal / d.negligible;
    if (open && !(closing > 1)) return {};
    Verdict verdict;
    if (weak.tie == Tie::apex)
      verdict = apex_verdict(d, -law.slope_at_apex().v * std::min(d.normal, 0.0), ContactState::slip, now);
    else if (jumps && open)
      verdict = contradicted({ContactState::stick, {}}, 0);
    else if (!jumps && now.state != ContactState::slip)
      verdict = contradicted({ContactState::slip, {}}, 0);
    verdict.possible = !(jumps && bears && open);
    if (open) verdict.severity = closing;
    return verdict;
  }
  const bool augmented = cone == ConeRadius::augmented;
  const double pressure = augmented ? -found[0] : -at.multiplier[point.multiplier];
  const double pressure_rate = augmented ? -z[0].d[0] : -block.current.multiplier[point.multiplier].d[0];
  const auto [bound, piece] = bound_rate(law, pressure, pressure_rate, side);
  if (weak.tie == Tie::line) {
    Verdict verdict = apex_verdict(d, std::max(bound, 0.0), piece, now);
    verdict.possible = bound >= 0;
    return verdict;
  }
  if (is_slipping(now.state) && now.state != piece) {
    const double other = bound_rate(law, pressure, pressure_rate, -side).rate;
    const double apart = std::abs(bound + other) / d.negligible;
    if (apart > 1) return contradicted({piece, {}}, apart);
  }
  if (weak.tie == Tie::corner) return {};
  const auto along = found.tail(point.tangents);
  const double excess = along.dot(d.tangential) / norm(along) - bound;
  const bool sticks = now.state == ContactState::stick;
  const double by = (sticks ? excess : -excess * d.kinematic) / d.negligible;
  if (!(by > 1)) return {};
  return contradicted({sticks ? piece : ContactState::stick, {}}, by);
}

}  // namespace stickslip
