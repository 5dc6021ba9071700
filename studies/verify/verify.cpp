#include "studies/verify/verify.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "studies/verify/state.hpp"

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
    equilibrium{"equilibrium", 1e-8, "of F: Newton's methods end at 1e-9 and less"},
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
    energy{"energy", 1e-6, "of all work, and half of what forces change by times motions: the step's own error"},
    flow{"plastic strain", 1e-6, "of the largest: the path of displacements decides it, by the law's own bound"},
    responses{"responses", 1e-7, "of the largest of their kind: the same formula of the same numbers"},
    steps{"steps", 0, "every state that the scene asks for, and that the result tells of, is there"};

constexpr double share = 1e-6;         ///< of a bound within which a traction is on it
constexpr double least_strain = 1e-9;  ///< plastic strains that count
constexpr double rounding = 1e-6;  ///< of a stiffness times a motion: the least force that counts, for those of a rigid
                                   ///< motion are 1e-16 of it, 1e-10 of this scale

constexpr double rounding_of_motion = 1e-15;  ///< of the largest: springs of a penalty make a traction of it

/// Notes a violation, of which the worst is kept.
void note(Step& step, const Law& law, double value, const std::string& where, double allowed = -1) {
  auto found = std::find_if(step.findings.begin(), step.findings.end(), [&](auto& f) { return f.law == law.name; });
  if (found == step.findings.end()) found = step.findings.insert(found, {law.name, where, -infinity, 0, law.why});
  if (!std::isfinite(value)) value = infinity;
  if (found->value < value)
    *found = {law.name, where, std::max(value, 0.0), allowed < 0 ? law.allowed : allowed, law.why};
}

/// Directions in which supports hold a node, each with the motion that it prescribes.
using Held = std::vector<std::pair<Vec3, double>>;

/// The part of a force that supports take.
Vec3 taken(const Held& held, const Vec3& force) {
  Field N(3, held.size());
  for (std::size_t k = 0; k < held.size(); ++k) N.col(k) = held[k].first;
  return N * N.completeOrthogonalDecomposition().solve(force);
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
    for (int i = 0; body.element == "point" && i < scene.dimension; ++i) {
      Held& anchor = held[body.sides.at("anchor")[0]];
      if (std::ranges::count(anchor, Vec3(Vec3::Unit(i)), &Held::value_type::first) == 0)
        anchor.emplace_back(Vec3::Unit(i), 0);
    }
  for (int n = 0; n < scene.points.cols(); ++n)
    if (scene.on_axis(n)) held[n].emplace_back(Vec3::UnitX(), 0);
  return held;
}

/// Bound of friction at a pressure.
double bound(const Json& contact, double pressure) {
  const Json& friction = contact.contains("friction") ? contact["friction"] : Json(0.0);
  if (friction.is_number()) return friction.get<double>() * pressure;
  if (friction.contains("tresca")) return pressure > 0 ? friction["tresca"].get<double>() : 0;
  return std::min(friction.at("coulomb").get<double>() * pressure, friction.value("limit", infinity));
}

/// Checks increment after increment, and remembers what the next needs.
class Judge {
 public:
  Judge(const Json& scene, const Json& mesh) : scene_(scene, mesh) {
    for (const auto& [name, sides] : part(mesh, "contacts").items()) contacts_.emplace_back(scene_, name, sides);
    u_ = outer_ = contact_ = Field::Zero(3, scene_.points.cols());
  }

  /// `given`: the responses of the increment as whoever solved it measured them; null: none.
  Step read(const Json& increment, const Json& given) {
    Step step{increment.at("time"), {}};
    const Field before = std::exchange(u_, displacements(increment.at("displacement")));
    bodies_ = deform(scene_, u_, bodies_);
    note(step, elements, bodies_.inverted, "of a body");
    const Field loads = load_forces(scene_, u_, step.time);
    L_ = std::max({L_, u_.cwiseAbs().maxCoeff(), loads.colwise().norm().maxCoeff() * over(bodies_.stiffness)});
    const auto held = supports_at(scene_, step.time);
    State state{scene_, u_, bodies_, places(part(increment, "contacts"), bodies_.forces - loads, held, step)};
    Field contact = Field::Zero(3, u_.cols());
    for (auto& placed : state.placed) {
      check_place(placed, step);
      step.tractions[placed.contact->name][placed.touch.node] = {placed.pressure(), placed.friction().dot(placed.e())};
      for (const auto& [node, weight] : placed.touch.weights)
        contact.col(node) += weight * placed.touch.area * placed.traction;
    }
    F_ = std::max({F_, bodies_.largest, loads.colwise().norm().maxCoeff(), contact.colwise().norm().maxCoeff(),
                   rounding * bodies_.stiffness * L_});
    check_nodes(held, bodies_.forces - loads - contact, state, step);
    check_balance(loads + state.held, contact, step);
    check_energy(loads + state.held, contact, u_ - before, step);
    state.heat = heat_;
    check_responses(state, given, step);
    check_flow(part(increment, "plastic_strain"), step);
    return step;
  }

  std::set<std::string> unmeasured;  ///< names of responses that were not measured again

 private:
  std::string at(int node) const {
    if (node < 0 || node >= u_.cols()) throw BadFile(fmt::format("the mesh has no node {}", node));
    return fmt::format("node {}, ({:.6g}, {:.6g}) at the start", node, scene_.points(0, node), scene_.points(1, node));
  }
  static double over(double scale) { return scale > 0 ? 1 / scale : 1; }

  Field displacements(const Json& given) const {
    const Eigen::Index D = scene_.dimension, numbers = u_.cols() * D;
    if (static_cast<Eigen::Index>(given.size()) != numbers)
      throw BadFile(fmt::format("a displacement has {} numbers; the mesh has {}", given.size(), numbers));
    Field u = Field::Zero(3, u_.cols());
    for (Eigen::Index k = 0; k < numbers; ++k) u(k % D, k / D) = given[k].is_number() ? given[k].get<double>() : NAN;
    return u;
  }

  /// All places with the tractions that are given, or with those that balance `residual`, f_int - loads.
  std::vector<Placed> places(const Json& given, const Field& residual, const std::map<int, Held>& held, Step& step) {
    std::vector<Placed> all;
    for (auto& contact : contacts_) {
      const Json& of = part(given, contact.name);
      std::map<int, Placed> index;
      for (std::size_t k = 0; !of.empty() && k < of.at("nodes").size(); ++k) {
        Placed& placed = index[of["nodes"][k]];
        for (int i = 0; i < scene_.dimension; ++i) placed.traction[i] = of.at("traction").at(k * scene_.dimension + i);
        for (int i = 0; i < 2 && of.contains("compliance"); ++i) placed.compliance[i] = of["compliance"].at(2 * k + i);
      }
      for (const auto& touch : contact.advance(u_, step.time)) {
        Placed& placed = index[touch.node];
        placed.contact = &contact;
        placed.touch = touch;
        if (of.empty() && touch.faces) {
          const Vec3 force = residual.col(touch.node);
          const Vec3 free = held.contains(touch.node) ? Vec3(force - taken(held.at(touch.node), force)) : force;
          placed.traction = free / touch.area;
        }
        const double least = touch.area > 0 ? rounding * bodies_.stiffness * L_ / touch.area : 0;
        T_ = std::max({T_, placed.traction.norm(), least});
        all.push_back(placed);
        index.erase(touch.node);
      }
      for (const auto& [node, placed] : index)
        note(step, place, placed.traction.norm(), contact.name + ", " + at(node));
    }
    return all;
  }

  /// Signorini's conditions of a place; then its friction, and its work.
  void check_place(Placed& placed, Step& step) {
    const Touch& touch = placed.touch;
    const std::string where = placed.contact->name + ", " + at(touch.node);
    const double p = placed.pressure(), gap = touch.gap + placed.compliance[0] * std::max(p, 0.0);
    Placed& past = past_[{placed.contact->name, touch.node}];
    if (!touch.faces) {
      note(step, place, placed.traction.norm() * over(T_), where + ", which faces nothing");
      past = {};
      return;
    }
    if (!placed.contact->itself || p != 0) note(step, overlap, -gap * over(L_), where);
    const double spring = placed.compliance[0] > 0 ? rounding_of_motion * L_ / placed.compliance[0] : 0;
    note(step, tension, (-p - spring) * over(T_), where);
    if (p > overlap.allowed * T_) note(step, complementarity, gap * over(L_), where);
    const Vec3 e = placed.e();
    placed.slid = past.slid + touch.slip.dot(e);
    Vec3 last = past.friction();  // its component along the tangent is carried on
    if (scene_.finite && scene_.dimension == 2) last = std::copysign(last.norm(), last.dot(e)) * e;
    check_friction(placed, last, where, step);
    add_work(touch, touch.area * placed.friction(), past.touch.area * last, touch.area * p,
             past.touch.area * past.pressure());
    past = placed;
  }

  void check_friction(const Placed& placed, const Vec3& last, const std::string& where, Step& step) {
    const Touch& touch = placed.touch;
    const Vec3 s = placed.friction(), slid = touch.slip + placed.compliance[1] * (s - last);  // less what springs yield
    const double most = bound(placed.contact->given, std::max(placed.pressure(), 0.0));
    const bool has_friction = placed.contact->given.contains("friction");
    note(step, cone, (s.norm() - most) * over(T_), where, has_friction ? cone.allowed : tension.allowed);
    if (!has_friction || s.isZero()) return;
    const std::set<std::string> names{placed.contact->name, placed.contact->group};
    if (!touch.slip_known) {
      for (const auto& name : names) heat_[name] = NAN;
      return;
    }
    note(step, dissipation, s.dot(slid) * over(T_ * L_), where);
    if (s.norm() < most * (1 - share) - cone.allowed * T_) return note(step, stick, slid.norm() * over(L_), where);
    if (slid.norm() > stick.allowed * L_ && s.norm() > cone.allowed * T_)
      note(step, direction, 1 + s.dot(slid) / (s.norm() * slid.norm()), where);
    for (const auto& name : names) heat_[name] -= touch.area * s.dot(slid);
  }

  /// Work of a place in the increment, by the mean of the forces at its ends: of friction, and of pressure.
  void add_work(const Touch& touch, const Vec3& rubbing, const Vec3& rubbed, double pressing, double pressed) {
    const Vec3 friction = (rubbing + rubbed) / 2;
    const double pressure = (pressing + pressed) / 2, opened = pressure * touch.opening,
                 carried = (friction + pressure * touch.normal).dot(touch.carried), slid = friction.dot(touch.slip);
    work_ += carried + opened;
    spent_ -= slid;
    size_ += std::abs(carried) + std::abs(opened) + std::abs(slid);
    slack_ += (std::abs(pressing - pressed) + (rubbing - rubbed).norm()) / 2 *
              (touch.carried.norm() + std::abs(touch.opening) + touch.slip.norm());
  }

  /// Supports and equilibrium; `residual`: f_int - loads - contact, of which supports take their part.
  void check_nodes(const std::map<int, Held>& held, const Field& residual, State& state, Step& step) {
    state.held = Field::Zero(3, u_.cols());
    for (const auto& [node, holds] : held) {
      state.held.col(node) = taken(holds, residual.col(node));
      for (const auto& [direction, value] : holds)
        note(step, supports, std::abs(direction.dot(u_.col(node)) - value) * over(L_), at(node));
    }
    Eigen::Index worst = 0;
    const double off = (residual - state.held).colwise().norm().maxCoeff(&worst);
    note(step, equilibrium, residual.allFinite() ? off * over(F_) : infinity, at(static_cast<int>(worst)));
  }

  void check_balance(const Field& outer, const Field& contact, Step& step) {
    const Field forces_of = outer + contact, arms = scene_.places(u_).colwise() - scene_.points.rowwise().mean();
    Vec3 sum = forces_of.rowwise().sum(), moment = Vec3::Zero();
    for (Eigen::Index n = 0; n < u_.cols(); ++n) moment += arms.col(n).cross(forces_of.col(n));
    if (scene_.axisymmetric) sum[0] = 0;
    const double all = F_ + forces_of.colwise().norm().sum(), many = std::sqrt(static_cast<double>(u_.cols()));
    const std::string what = "of loads, supports and contacts";
    note(step, forces, sum.norm() * over(all), what, many * forces.allowed);
    const bool springs = std::ranges::count(scene_.bodies, "point", &Body::element) > 0;
    if (scene_.axisymmetric || (scene_.finite && springs)) return;  // (a spring at its anchor has a moment of its own)
    note(step, moments, moment.norm() * over(all * arms.colwise().norm().maxCoeff()), what, many * moments.allowed);
  }

  /// work = stored + dissipated, from the start.
  void check_energy(const Field& outer, const Field& contact, const Field& moved, Step& step) {
    const double done = (outer + outer_).cwiseProduct(moved).sum() / 2;
    for (const Field& change : {Field(outer - outer_), Field(contact - contact_)})
      slack_ += change.cwiseProduct(moved).colwise().sum().cwiseAbs().sum() / 2;
    outer_ = outer;
    contact_ = contact;
    work_ += done;
    spent_ += bodies_.plastic_work;
    size_ += std::abs(done) + bodies_.plastic_work;
    const double scale = std::max({size_, bodies_.energy, equilibrium.allowed * bodies_.stiffness * L_ * L_});
    note(step, energy, std::abs(work_ - bodies_.energy - spent_) * over(scale),
         fmt::format("work {:.6g}, stored {:.6g}, dissipated {:.6g}", work_, bodies_.energy, spent_),
         std::min(1.0, slack_ * over(scale) + energy.allowed));
  }

  /// Measures the responses, and compares them with those that are `given`.
  void check_responses(const State& state, const Json& given, Step& step) {
    for (const auto& [name, what] : part(scene_.json, "responses").items()) {
      const std::string kind = what.begin().key();
      const double again = measure(state, what).value_or(NAN);
      if (std::isnan(again)) {
        unmeasured.insert(name);
        continue;
      }
      step.responses[name] = again;
      std::map<std::string, double> natural{
          {"reaction", F_}, {"contact_force", F_},          {"displacement", L_},
          {"gap", L_},      {"contact_pressure", T_},       {"plastic_strain", least_strain},
          {"slip", L_},     {"dissipation", 1e-3 * F_ * L_}};  // (updates leave 1e-10 of F L)
      double& scale = largest_[kind];
      scale = std::max({scale, std::abs(again), natural.emplace(kind, size_ * rounding).first->second});
      if (!given.contains(name)) continue;
      const double known = given[name].is_number() ? given[name].get<double>() : NAN;
      note(step, responses, std::abs(known - again) * over(scale),
           fmt::format("\"{}\" is {:.9g}, not {:.9g}", name, again, known));
    }
  }

  /// Plastic strains that are given, a mean of each element.
  void check_flow(const Json& given, Step& step) {
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const Json& means = part(given, scene_.bodies[b].name);
      auto particle = bodies_.particles[b].begin();
      double largest = least_strain;
      for (const auto& one : bodies_.particles[b]) largest = std::max(largest, one.equivalent);
      for (std::size_t e = 0; e < means.size(); ++e) {
        double sum = 0, volume = 0;
        for (std::size_t q = 0; q < bodies_.particles[b].size() / means.size(); ++q, ++particle) {
          sum += particle->equivalent * particle->volume;
          volume += particle->volume;
        }
        note(step, flow, std::abs(means[e].get<double>() - sum / volume) / largest,
             fmt::format("{}, element {}", scene_.bodies[b].name, e));
      }
    }
  }

  Scene scene_;
  std::vector<Contact> contacts_;
  Bodies bodies_;
  Field u_, outer_, contact_;                           ///< displacements, forces from outside and of contact
  std::map<std::pair<std::string, int>, Placed> past_;  ///< of the last increment
  std::map<std::string, double> heat_, largest_;        ///< of contacts; of kinds of responses
  double F_ = 0, L_ = 0, T_ = 0;                        ///< largest force, motion, traction
  double work_ = 0, spent_ = 0, slack_ = 0, size_ = 0;  ///< energies: done, dissipated, not known, of all parts
};

}  // namespace

std::vector<double> asked_times(const Json& scene) {
  const Json& time = scene.at("time");
  std::vector<double> times;
  const auto add = [&](double end, double count) {
    const double start = times.empty() ? 0 : times.back();
    for (int k = 1; k <= count; ++k) times.push_back(start + (end - start) * k / count);
  };
  if (time.contains("legs"))
    for (const auto& leg : time["legs"]) add(leg[0], leg[1]);
  else if (!time.contains("control"))
    add(time.at("end"), time.at("steps"));
  return times;
}

const Finding& Step::worst() const {
  return *std::ranges::max_element(findings, {}, [](const Finding& f) {
    return f.allowed > 0 ? f.value / f.allowed : f.value > 0 ? infinity : 0;
  });
}

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
  if (certificate.steps.empty()) certificate.steps.push_back({0, {}});
  Step& last = certificate.steps.back();
  for (const double time : asked) {
    const auto near = there.lower_bound(time - 1e-9 * std::abs(time));
    note(last, steps, near == there.end() || *near > time + 1e-9 * std::abs(time),
         fmt::format("none at t = {:.9g}", time));
  }
  if (const std::string status = result.value("status", "converged"); !status.starts_with("converged"))
    note(last, steps, 1, "the run ended as " + status);
  if (!judge.unmeasured.empty())
    certificate.remarks.push_back(
        fmt::format("responses that are not measured again: {}", fmt::join(judge.unmeasured, ", ")));
  return certificate;
}

}  // namespace stickslip::verify
