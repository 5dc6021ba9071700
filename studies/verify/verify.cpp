#include "studies/verify/verify.hpp"

#include <fmt/format.h>

#include "studies/verify/responses.hpp"

namespace stickslip::verify {
namespace {

struct Law {
  const char* name;
  double allowed;
  const char* why;
};

// Errors are relative to the largest force F, motion L and traction T of the run so far.
constexpr Law elements{"elements", 0, "an element may not be turned inside out"},
    supports{"supports", 1e-8, "of L: what is prescribed is exact, to the rounding of turns"},
    equilibrium{"equilibrium", 1e-8,
                "of F: Newton's methods end at 1e-9 and less; and what springs make of rounded gaps"},
    forces{"balance of forces", 1e-8, "of all forces, times the root of the number of nodes: a sum of their errors"},
    moments{"balance of moments", 1e-8, "of all forces times the size, likewise"},
    place{"place of contact", 0, "a traction needs a point that faces its master"},
    overlap{"gap", 1e-6, "of L, beside what the springs of a penalty yield: Uzawa's updates end at 1e-6 of it"},
    tension{"tension", 1e-8, "of T: nothing pulls"},
    complementarity{"complementarity", 1e-6, "of L: what presses is closed, as gaps are"},
    cone{"cone", 1e-6, "of T: friction within its bound, to Uzawa's updates"},
    stick{"stick", 1e-5, "of L: below the bound nothing slides; slips are differences of motions, each as a gap"},
    direction{"slip direction", 1e-6, "1 + cos of the angle between friction and slip, which oppose one another"},
    dissipation{"dissipation", 1e-6, "of T L: friction takes energy, it gives none"},
    energy{
        "energy", 1e-6,
        "of all work, and half of each force's change times its motion: the work in a step is that of the mean force, "
        "which more steps make exact; and what springs make of rounded gaps"},
    flow{"plastic strain", 1e-6, "of the largest: the path of displacements decides it, by the law's own bound"},
    responses{"responses", 1e-7, "of the largest of their kind: the same formula of the same numbers"},
    steps{"steps", 0, "every state that the scene asks for, and that the result holds, is there"};

constexpr double noted = 1e-4;         ///< of forces times arms: a moment between two sides that is remarked on
constexpr double share = 1e-6;         ///< of a bound within which a traction is on it
constexpr double least_strain = 1e-9;  ///< plastic strains that count
constexpr double rounding = 1e-6;  ///< of a stiffness times a motion: the least force that counts, for those of a rigid
                                   ///< motion are 1e-16 of it, 1e-10 of this scale

constexpr double rounding_of_motion = 1e-15;  ///< of the largest, or of a coordinate: springs make a traction of it

/// Notes a violation, of which the worst is kept, by what is allowed.
void note(Step& step, const Law& law, double value, const std::string& where, double allowed = -1) {
  const Finding next{law.name, where, std::isfinite(value) ? std::max(value, 0.0) : infinity,
                     allowed < 0 ? law.allowed : allowed, law.why};
  const auto found = std::ranges::find(step.findings, next.law, &Finding::law);
  if (found == step.findings.end())
    step.findings.push_back(next);
  else if (found->share() < next.share())
    *found = next;
}

/// Directions in which supports hold a node, each with the motion that it prescribes.
using Held = std::vector<std::pair<Vec3, double>>;

/// The part of nodal forces that supports take.
Field taken(const std::map<int, Held>& held, const Field& forces) {
  Field all = Field::Zero(3, forces.cols());
  for (const auto& [node, holds] : held) {
    std::vector<Vec3> across;  // one another, of the directions so far
    for (const auto& [direction, motion] : holds) {
      Vec3 rest = direction.normalized();
      for (int twice = 0; twice < 2; ++twice)  // (once leaves what rounding makes of directions nearly alike)
        for (const Vec3& other : across) rest -= other.dot(rest) * other;
      if (rest.norm() > 1e-9) across.push_back(rest.normalized());
    }
    for (const Vec3& direction : across) all.col(node) += direction.dot(forces.col(node)) * direction;
  }
  return all;
}

std::map<int, Held> supports_at(const Scene& scene, double time) {
  std::map<int, Held> held;
  for (const auto& support : part(scene.json, "supports")) {
    const Motion motion(support);
    for (const int node : scene.side(support.at("on")).nodes) {
      const Vec3 u = motion.displacement(scene.points.col(node), time, scene.finite);
      if (support.contains("along"))
        held[node].emplace_back(vec3(support["along"]).normalized(), value_at(support.value("value", Json(0.0)), time));
      for (int i = 0; i < scene.dimension; ++i)
        if (motion.prescribes(i)) held[node].emplace_back(Vec3::Unit(i), u[i]);
    }
  }
  for (const auto& body : scene.bodies)
    for (int i = 0; body.spring() && i < scene.dimension; ++i) {
      Held& anchor = held[body.sides.at("anchor")[0]];
      if (std::ranges::count(anchor, Vec3(Vec3::Unit(i)), &Held::value_type::first) == 0)
        anchor.emplace_back(Vec3::Unit(i), 0);
    }
  for (int n = 0; n < scene.points.cols(); ++n)
    if (scene.on_axis(n)) held[n].emplace_back(Vec3::UnitX(), 0);
  return held;
}

/// Numbers that stand one after the other, as vectors of `size` of them; NaN where one is no number.
Field vectors(const Json& given, Eigen::Index size, std::size_t count, const std::string& what) {
  if (given.size() != size * count)
    throw BadFile(fmt::format("a {} has {} numbers; the mesh has {}", what, given.size(), size * count));
  Field all = Field::Zero(3, count);
  for (std::size_t k = 0; k < given.size(); ++k)
    all(k % size, k / size) = given[k].is_number() ? given[k].get<double>() : NAN;
  return all;
}

/// Bound of friction at a pressure.
double bound(const Json& contact, double pressure) {
  const Json& friction = contact.contains("friction") ? contact["friction"] : Json(0.0);
  if (friction.is_number()) return friction.get<double>() * pressure;
  if (friction.contains("tresca")) return pressure > 0 ? friction["tresca"].get<double>() : 0;
  return std::min(friction.at("coulomb").get<double>() * pressure, friction.value("limit", infinity));
}

/// Checks increment after increment, and remembers what the next needs.
class Judge : State {
 public:
  using State::State;

  /// `given`: the responses of the increment as whoever solved it measured them; null: none.
  Step read(const Json& increment, const Json& given) {
    Step step{increment.at("time"), {}};
    const Json& given_u = increment.at("displacement");
    const Field before = std::exchange(u, vectors(given_u, scene.dimension, u.cols(), "displacement"));
    bodies.deform(scene, u);
    note(step, elements, bodies.inverted, "of a body");
    const Field loads = load_forces(scene, u, step.time);
    L_ = std::max({L_, u.cwiseAbs().maxCoeff(), loads.colwise().norm().maxCoeff() * over(bodies.stiffness)});
    const auto supports = supports_at(scene, step.time);
    const Field inner = bodies.forces - loads;
    advance(part(increment, "contacts"), inner - taken(supports, inner), step);
    Field pushed = Field::Zero(3, u.cols());
    rounded_ = Eigen::VectorXd::Zero(u.cols());
    for (auto& contact : contacts) {
      Field forces = Field::Zero(3, u.cols());
      for (auto& [node, touch] : contact.touches) {
        check_place(contact, touch, step);
        step.tractions[contact.name][node] = {touch.pressure(), touch.friction().dot(touch.e())};
        for (const auto& [n, weight] : touch.weights) {
          forces.col(n) += weight * touch.area * touch.traction;
          rounded_[n] += std::abs(weight) * rounded_force(touch);
        }
      }
      measure_moment(contact, forces);
      pushed += forces;
    }
    F_ = std::max({F_, bodies.largest, loads.colwise().norm().maxCoeff(), pushed.colwise().norm().maxCoeff(),
                   rounding * bodies.stiffness * L_});
    held = taken(supports, inner - pushed);
    check_nodes(supports, inner - pushed - held, step);
    check_balance(loads + held, pushed, step);
    check_energy(loads + held, pushed, u - before, step);
    check_responses(given, step);
    check_flow(part(increment, "plastic_strain"), step);
    return step;
  }

  std::map<std::string, double> moments_left;  ///< by contact of two bodies: the largest of its forces on both
  std::set<std::string> unmeasured;            ///< names of responses that were not measured again

 private:
  std::string at(int node) const {
    if (node < 0 || node >= u.cols()) throw BadFile(fmt::format("the mesh has no node {}", node));
    return fmt::format("node {}, ({:.6g}, {:.6g}) at the start", node, scene.points(0, node), scene.points(1, node));
  }
  static double over(double scale) { return scale > 0 ? 1 / scale : 1; }

  /// Moves the contacts, with the tractions that are given, or with those that balance the forces `free` of nodes.
  void advance(const Json& given, const Field& free, Step& step) {
    for (auto& contact : contacts) {
      contact.advance(u, step.time);
      const Json& of = part(given, contact.name);
      const Nodes nodes = of.empty() ? Nodes{} : of.at("nodes").get<Nodes>();
      const Field tractions = vectors(part(of, "traction"), scene.dimension, nodes.size(), "traction"),
                  compliances = vectors(part(of, "compliance"), 2, of.contains("compliance") * nodes.size(), "spring");
      for (std::size_t k = 0; k < nodes.size(); ++k) {
        Touch& touch = contact.touches[nodes[k]];  // (it faces nothing where the contact has no such node)
        touch.node = nodes[k];
        touch.traction = tractions.col(k);
        if (compliances.cols() > 0) touch.compliance = compliances.col(k).head<2>();
      }
      for (auto& [node, touch] : contact.touches) {
        if (of.empty() && touch.faces) touch.traction = free.col(node) / touch.area;
        if (touch.area > 0) T_ = std::max({T_, touch.traction.norm(), least_force(touch) / touch.area});
        F_ = std::max(F_, least_force(touch));
        size_ = std::max(size_, least_force(touch) * rounded_gap(touch));
      }
    }
  }

  /// The least force that counts at a place: a share of what its motion makes, and where coordinates are part of its
  /// gap, what their rounding does.
  double least_force(const Touch& touch) const {
    return bodies.stiffness * std::max(rounding * L_, rounded_gap(touch) / equilibrium.allowed);
  }
  /// What the rounding of coordinates leaves of a gap; 0 where displacements alone are part of it.
  double rounded_gap(const Touch& touch) const {
    const bool rounds = touch.faces && (scene.finite || touch.gap != touch.normal.dot(touch.relative));
    return rounds ? 4 * rounding_of_motion * scene.points.col(touch.node).norm() : 0;
  }

  /// What the springs of a penalty make of that: a state whose gaps are rounded balances no better. Springs are some
  /// 1e3 times as stiff as bodies; where next to nothing presses, this is more than a share of the forces.
  double rounded_force(const Touch& touch) const {
    constexpr double stiffest =
        1e4;  // of bodies: ten times the usual; a file may call its springs as stiff as it likes
    double stiffness = 0;
    for (const double compliance : touch.compliance)
      if (compliance > 0 && touch.pressure() > 0)
        stiffness += std::min(touch.area / compliance, stiffest * bodies.stiffness);
    return stiffness * (scene.finite ? rounded_gap(touch) : 4 * rounding_of_motion * L_);  // (small: of motions alone)
  }

  /// Signorini's conditions of a place; then its friction, and its work.
  void check_place(Contact& contact, Touch& touch, Step& step) {
    const std::string where = contact.name + ", " + at(touch.node);
    const double p = touch.pressure(), gap = touch.gap + touch.compliance[0] * std::max(p, 0.0);
    if (!touch.faces) return note(step, place, touch.traction.norm() * over(T_), where + ", which faces nothing");
    if (!contact.itself || p != 0) note(step, overlap, -gap * over(L_), where);
    const double spring = touch.compliance[0] > 0 ? rounding_of_motion * L_ / touch.compliance[0] : 0;
    note(step, tension, (-p - spring) * over(T_), where);
    if (p > overlap.allowed * T_) note(step, complementarity, gap * over(L_), where);
    const Touch& last = contact.last.at(touch.node);
    const Touch past = last.faces ? last : Touch{};
    const Vec3 e = touch.e();
    touch.slid = past.slid + touch.slip.dot(e);
    const Vec3 rubbed = touch.turned * past.friction();
    check_friction(contact, touch, rubbed, where, step);
    add_work(touch, touch.area * touch.traction, past.area * (rubbed + past.pressure() * touch.normal));
  }

  void check_friction(Contact& contact, const Touch& touch, const Vec3& last, const std::string& where, Step& step) {
    const Vec3 s = touch.friction(), slid = touch.slip + touch.compliance[1] * (s - last);  // less what springs yield
    const double most = bound(contact.given, std::max(touch.pressure(), 0.0));
    const bool has_friction = contact.given.contains("friction");
    note(step, cone, (s.norm() - most) * over(T_), where, has_friction ? cone.allowed : tension.allowed);
    if (!has_friction || s.isZero()) return;
    if (!touch.slip_known) {
      contact.heat = NAN;
      return;
    }
    note(step, dissipation, s.dot(slid) * over(T_ * L_), where);
    if (s.norm() < most * (1 - share) - cone.allowed * T_) return note(step, stick, slid.norm() * over(L_), where);
    if (slid.norm() > stick.allowed * L_ && s.norm() > cone.allowed * T_)
      note(step, direction, 1 + s.dot(slid) / (s.norm() * slid.norm()), where);
    contact.heat -= touch.area * s.dot(slid);
  }

  Field arms() const { return scene.places(u).colwise() - scene.points.rowwise().mean(); }
  double moment(const Field& of) const {
    const Mat3 m = arms() * of.transpose();
    return (m - m.transpose()).norm() / std::sqrt(2.0);
  }

  /// Forces on two bodies act where each side is, so that they balance, and their moments only as far as sides meet.
  void measure_moment(const Contact& contact, const Field& forces) {
    const double all = forces.colwise().norm().sum(), left = moment(forces);
    const bool is_of_two = !scene.axisymmetric && forces.rowwise().sum().norm() <= equilibrium.allowed * all;
    if (!is_of_two || !(left > noted * all * arms().colwise().norm().maxCoeff())) return;
    moments_left[contact.name] = std::max(moments_left[contact.name], left);
  }

  /// Work of a place in the increment, by the mean of the forces at its ends: of friction, and of pressure.
  void add_work(const Touch& touch, const Vec3& now, const Vec3& before) {
    const Vec3 mean = (now + before) / 2, change = now - before, pressed = change.dot(touch.normal) * touch.normal;
    const double opened = mean.dot(touch.normal) * touch.opening, carried = mean.dot(touch.carried),
                 slid = mean.dot(touch.slip);
    work_ += carried + opened;
    spent_ -= slid;
    size_ += std::abs(carried) + std::abs(opened) + std::abs(slid);
    slack_ += (pressed.norm() + (change - pressed).norm()) / 2 *
              (touch.carried.norm() + std::abs(touch.opening) + touch.slip.norm());
  }

  /// Supports and equilibrium; `residual`: f_int - loads - contact, less what supports take.
  void check_nodes(const std::map<int, Held>& held, const Field& residual, Step& step) {
    for (const auto& [node, holds] : held)
      for (const auto& [direction, value] : holds)
        note(step, supports, std::abs(direction.dot(u.col(node)) - value) * over(L_), at(node));
    Eigen::Index worst = 0;
    const double off = residual.colwise().norm().maxCoeff(&worst);
    note(step, equilibrium, residual.allFinite() ? off * over(F_) : infinity, at(static_cast<int>(worst)),
         equilibrium.allowed + rounded_.maxCoeff() * over(F_));  // (a body that springs hold may show it anywhere)
  }

  void check_balance(const Field& outer, const Field& contact, Step& step) {
    const Field forces_of = outer + contact;
    Vec3 sum = forces_of.rowwise().sum();
    if (scene.axisymmetric) sum[0] = 0;
    const double all = F_ + forces_of.colwise().norm().sum(), many = std::sqrt(static_cast<double>(u.cols()));
    const std::string what = "of loads, supports and contacts";
    const double rounded = rounded_.sum() * over(all);  // (errors of springs, which all may have one sign)
    note(step, forces, sum.norm() * over(all), what, many * forces.allowed + rounded);
    const bool springs = std::ranges::any_of(scene.bodies, &Body::spring);
    if (scene.axisymmetric || (scene.finite && springs)) return;  // (a spring at its anchor has a moment of its own)
    note(step, moments, moment(forces_of) * over(all * arms().colwise().norm().maxCoeff()), what,
         many * moments.allowed + rounded);
  }

  /// work = stored + dissipated, from the start.
  void check_energy(const Field& outer, const Field& contact, const Field& moved, Step& step) {
    const double done = (outer + outer_).cwiseProduct(moved).sum() / 2;
    for (const Field& change : {Field(outer - outer_), Field(contact - contact_)})
      slack_ += change.cwiseProduct(moved).colwise().sum().cwiseAbs().sum() / 2;
    slack_ += rounded_.sum() * moved.colwise().norm().maxCoeff();
    outer_ = outer;
    contact_ = contact;
    work_ += done;
    spent_ += bodies.plastic_work;
    size_ += std::abs(done) + bodies.plastic_work;
    const double scale = std::max({size_, bodies.energy, equilibrium.allowed * bodies.stiffness * L_ * L_});
    note(step, energy, std::abs(work_ - bodies.energy - spent_) * over(scale),
         fmt::format("work {:.6g}, stored {:.6g}, dissipated {:.6g}", work_, bodies.energy, spent_),
         std::min(1.0, slack_ * over(scale) + energy.allowed));
  }

  /// Measures the responses, and compares them with those that are `given`.
  void check_responses(const Json& given, Step& step) {
    for (const auto& [name, what] : part(scene.json, "responses").items()) {
      const std::string kind = what.begin().key();
      const double again = measure(*this, what).value_or(NAN);
      if (std::isnan(again)) unmeasured.insert(name);
      if (!std::isnan(again)) step.responses[name] = again;
      std::map<std::string, double> natural{
          {"reaction", F_}, {"contact_force", F_},          {"displacement", L_},
          {"gap", L_},      {"contact_pressure", T_},       {"plastic_strain", least_strain},
          {"slip", L_},     {"dissipation", 1e-3 * F_ * L_}};  // (updates leave 1e-10 of F L)
      double& scale = largest_[kind];
      scale = std::max({scale, std::abs(again), natural.emplace(kind, size_ * rounding).first->second});
      if (std::isnan(again) || !given.contains(name)) continue;
      const double known = given[name].is_number() ? given[name].get<double>() : NAN;
      note(step, responses, std::abs(known - again) * over(scale),
           fmt::format("\"{}\" is {:.9g}, not {:.9g}", name, again, known));
    }
  }

  /// Plastic strains that are given, a mean of each element.
  void check_flow(const Json& given, Step& step) {
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const Json& means = part(given, scene.bodies[b].name);
      const auto& points = bodies.points[b];
      double largest = least_strain;
      for (const auto& element : points)
        for (const auto& point : element) largest = std::max(largest, point.equivalent);
      for (std::size_t e = 0; e < means.size(); ++e) {
        Vec2 sum(0, 0);
        for (const auto& point : points.at(e)) sum += point.volume * Vec2(point.equivalent, 1);
        note(step, flow, std::abs(means[e].get<double>() - sum[0] / sum[1]) / largest,
             fmt::format("{}, element {}", scene.bodies[b].name, e));
      }
    }
  }

  Field outer_ = u, contact_ = u;                       ///< forces from outside and of contact
  Eigen::VectorXd rounded_;                             ///< of nodes: what springs make of rounded gaps
  std::map<std::string, double> largest_;               ///< of kinds of responses
  double F_ = 0, L_ = 0, T_ = 0;                        ///< largest force, motion, traction
  double work_ = 0, spent_ = 0, slack_ = 0, size_ = 0;  ///< energies: done, dissipated, not known, of all parts
};

}  // namespace

std::vector<double> asked_times(const Json& scene) {
  const Json& time = scene.at("time");
  std::vector<std::array<double, 2>> legs = time.value("legs", std::vector<std::array<double, 2>>{});
  if (legs.empty() && !time.contains("control")) legs = {{time.at("end"), time.at("steps")}};
  std::vector<double> times;
  double start = 0;
  for (const auto& [end, steps] : legs) {
    for (int k = 1; k <= steps; ++k) times.push_back(start + (end - start) * k / steps);
    start = end;
  }
  return times;
}

const Finding& Step::worst() const { return *std::ranges::max_element(findings, {}, &Finding::share); }

bool Certificate::holds() const { return !steps.empty() && std::ranges::all_of(steps, &Step::holds); }

Certificate certify(const Json& scene, const Json& mesh, const Json& solution, const Json& result) {
  Certificate certificate;
  Judge judge(scene, mesh);
  std::map<double, Json> measured;
  std::vector<double> asked = asked_times(scene);
  for (const auto& step : result.value("steps", Json::array())) {
    asked.push_back(step.at("time"));
    measured[asked.back()] = step.value("responses", Json());
  }
  std::set<double> there{-infinity};
  for (const auto& increment : solution.at("increments")) {
    const double time = increment.at("time");
    if (!(time > *there.rbegin()) && !scene.at("time").contains("control"))
      throw BadFile("times of increments do not increase");
    there.insert(time);
    certificate.steps.push_back(judge.read(increment, measured[time]));
  }
  if (certificate.steps.empty()) note(certificate.steps.emplace_back(), steps, 1, "none at all");
  Step& last = certificate.steps.back();
  for (const double time : asked) {
    const auto near = there.lower_bound(time - 1e-9 * std::abs(time));
    note(last, steps, near == there.end() || *near > time + 1e-9 * std::abs(time),
         fmt::format("none at t = {:.9g}", time));
  }
  if (const std::string status = result.value("status", "converged"); !status.starts_with("converged"))
    note(last, steps, 1, "the run ended as " + status);
  for (const auto& [name, moment] : judge.moments_left)
    certificate.remarks.push_back(
        fmt::format("moments of the forces of {} on its two sides differ by up to {:.3g}", name, moment));
  if (!judge.unmeasured.empty())
    certificate.remarks.push_back(
        fmt::format("responses that are not measured again: {}", fmt::join(judge.unmeasured, ", ")));
  return certificate;
}

}  // namespace stickslip::verify
