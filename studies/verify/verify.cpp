#include "studies/verify/verify.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

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

constexpr double share = 1e-6;     ///< of a bound within which a traction is on it
constexpr double rounding = 1e-6;  ///< of a stiffness times a motion: the least force that counts, for those of a rigid
                                   ///< motion are 1e-16 of it, 1e-10 of this scale

/// Notes a violation, of which the worst is kept.
void note(Step& step, const Law& law, double value, const std::string& where, double allowed = -1) {
  if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
  const auto found =
      std::find_if(step.findings.begin(), step.findings.end(), [&](const Finding& f) { return f.law == law.name; });
  if (found == step.findings.end())
    step.findings.push_back({law.name, where, std::max(value, 0.0), allowed < 0 ? law.allowed : allowed, law.why});
  else if (value > found->value)
    found->value = value, found->where = where;
}

/// Directions in which supports hold a node, and the motions that they prescribe.
struct Held {
  std::vector<Vec3> directions;
  std::vector<double> values;
  /// The part of a force that supports take.
  Vec3 taken(const Vec3& force) const {
    Eigen::Matrix3Xd N(3, static_cast<Eigen::Index>(directions.size()));
    for (std::size_t k = 0; k < directions.size(); ++k) N.col(static_cast<Eigen::Index>(k)) = directions[k];
    return N * N.completeOrthogonalDecomposition().solve(force);
  }
};

std::map<int, Held> supports_at(const Scene& scene, double time) {
  std::map<int, Held> held;
  std::set<std::pair<int, int>> axes;
  const auto hold = [&](int node, const Vec3& direction, double value) {
    held[node].directions.push_back(direction.normalized());
    held[node].values.push_back(value);
  };
  for (const auto& support : part(scene.json, "supports")) {
    const Motion motion(support);
    for (const int node : scene.side(support.at("on")).nodes) {
      const Vec3 u = motion.displacement(scene.points.col(node), time, scene.finite);
      if (support.contains("along"))
        hold(node, vec3(support["along"]), support.contains("value") ? Value(support["value"]).at(time) : 0);
      for (int i = 0; i < scene.dimension; ++i)
        if ((motion.move[i] || motion.angle) && axes.emplace(node, i).second) hold(node, Vec3::Unit(i), u[i]);
    }
  }
  const auto hold_still = [&](int node, int i) {
    if (axes.emplace(node, i).second) hold(node, Vec3::Unit(i), 0);
  };
  for (const auto& body : scene.bodies)
    for (int i = 0; body.element == "point" && i < scene.dimension; ++i) hold_still(body.sides.at("anchor")[0], i);
  for (int n = 0; n < scene.points.cols(); ++n)
    if (scene.on_axis(n)) hold_still(n, 0);
  return held;
}

/// Bound of friction at a pressure.
double bound(const Json& contact, double pressure) {
  if (!contact.contains("friction")) return 0;
  const Json& friction = contact["friction"];
  if (friction.is_number()) return friction.get<double>() * pressure;
  if (friction.contains("tresca")) return pressure > 0 ? friction["tresca"].get<double>() : 0;
  return std::min(friction.at("coulomb").get<double>() * pressure,
                  friction.value("limit", std::numeric_limits<double>::infinity()));
}

/// A stiffness of the scene, force per length: its largest modulus times a depth.
double stiffness_of(const Scene& scene) {
  double stiffness = 0;
  for (const auto& body : scene.bodies) {
    const Json& numbers = body.material.begin().value();
    const double depth = body.element == "bar" ? body.area
                         : scene.axisymmetric  ? scene.points.row(0).maxCoeff()
                                               : body.thickness;
    stiffness = std::max(stiffness, numbers.value("E", 0.0) * depth);
    for (const auto& row : part(numbers, "stiffness")) stiffness = std::max(stiffness, vec3(row).cwiseAbs().maxCoeff());
  }
  return stiffness;
}

/// Checks increment after increment, and remembers what the next needs.
class Judge {
 public:
  Judge(const Json& scene, const Json& mesh);
  /// `given`: the responses of the increment as whoever solved it measured them; null: none.
  Step read(const Json& increment, const Json& given);
  std::set<std::string> unmeasured;  ///< names of responses that were not measured again

 private:
  /// Of a place of contact, at the end of the last increment: forces of pressure and friction, and the friction alone.
  struct Past {
    double pressing = 0, slid = 0;
    Vec3 rubbing = Vec3::Zero(), friction = Vec3::Zero();
  };
  Field displacements(const Json& given) const;
  std::vector<Placed> places(const Json& given, const Field& residual, const std::map<int, Held>& held, Step& step);
  void check_place(Placed& placed, const Vec2& compliance, Step& step);
  void check_friction(const Placed& placed, const Vec2& compliance, const Vec3& last, Step& step);
  void add_work(const Placed& placed, Past& past);
  void check_nodes(const std::map<int, Held>& held, const Field& residual, State& state, Step& step);
  void check_balance(const Field& outer, const Field& contact, Step& step);
  void check_energy(const Field& outer, const Field& contact, const Field& moved, Step& step);
  void check_responses(const State& state, const Json& given, Step& step);
  void check_flow(const Json& given, Step& step);
  std::string at(int node) const;

  Scene scene_;
  std::vector<Contact> contacts_;
  Bodies bodies_;
  Field u_, outer_, contact_;  ///< displacements, forces from outside and of contact
  std::map<std::pair<std::string, int>, Past> past_;
  std::map<std::string, double> heat_, largest_;  ///< of contacts; of kinds of responses
  double F_ = 0, L_ = 0, T_ = 0, stiffness_ = 0;
  double work_ = 0, spent_ = 0, slack_ = 0, size_ = 0;  ///< energies: done, dissipated, not known, of all parts
};

Judge::Judge(const Json& scene, const Json& mesh) : scene_(scene, mesh), stiffness_(stiffness_of(scene_)) {
  for (const auto& [name, pair] : part(mesh, "contacts").items())
    contacts_.emplace_back(scene_, name, pair, scene.at("contacts").at(pair.at("of").get<std::string>()));
  u_ = outer_ = contact_ = Field::Zero(3, scene_.points.cols());
}

std::string Judge::at(int node) const {
  return fmt::format("node {}, ({:.6g}, {:.6g}) at the start", node, scene_.points(0, node), scene_.points(1, node));
}

Step Judge::read(const Json& increment, const Json& given) {
  Step step{increment.at("time"), {}};
  const Field before = u_;
  u_ = displacements(increment.at("displacement"));
  bodies_ = deform(scene_, u_, bodies_.memory);
  note(step, elements, bodies_.inverted, "of a body");
  L_ = std::max(L_, u_.cwiseAbs().maxCoeff());
  const Field loads = load_forces(scene_, u_, step.time);
  const auto held = supports_at(scene_, step.time);
  State state{scene_, u_, bodies_, places(part(increment, "contacts"), bodies_.forces - loads, held, step), {}, {}};
  Field contact = Field::Zero(3, u_.cols());
  for (const auto& [of, touch, traction, slid] : state.places)
    for (const auto& [node, weight] : touch.weights) contact.col(node) += weight * touch.area * traction;
  F_ = std::max({F_, bodies_.largest, loads.colwise().norm().maxCoeff(), contact.colwise().norm().maxCoeff(),
                 rounding * stiffness_ * L_});
  check_nodes(held, bodies_.forces - loads - contact, state, step);
  check_balance(loads + state.held, contact, step);
  check_energy(loads + state.held, contact, u_ - before, step);
  state.heat = heat_;
  if (given.is_object()) check_responses(state, given, step);
  check_flow(part(increment, "plastic_strain"), step);
  return step;
}

Field Judge::displacements(const Json& given) const {
  const auto D = static_cast<std::size_t>(scene_.dimension), nodes = static_cast<std::size_t>(u_.cols());
  if (given.size() != nodes * D)
    throw BadFile(fmt::format("a displacement has {} numbers; the mesh has {}", given.size(), nodes * D));
  Field u = Field::Zero(3, u_.cols());
  for (std::size_t k = 0; k < given.size(); ++k)
    u(static_cast<Eigen::Index>(k % D), static_cast<Eigen::Index>(k / D)) =
        given[k].is_number() ? given[k].get<double>() : NAN;
  return u;
}

/// The places of all contacts with the tractions that are given, or with those that balance `residual`, f_int - loads.
std::vector<Placed> Judge::places(const Json& given, const Field& residual, const std::map<int, Held>& held,
                                  Step& step) {
  std::vector<std::pair<Placed, Vec2>> all;
  const auto D = static_cast<std::size_t>(scene_.dimension);
  for (auto& contact : contacts_) {
    const Json& of = part(given, contact.name.c_str());
    std::map<int, std::size_t> index;
    for (std::size_t k = 0; of.contains("traction") && k < of.at("nodes").size(); ++k) index[of["nodes"][k]] = k;
    for (const auto& touch : contact.advance(u_, step.time)) {
      Placed placed{&contact, touch, Vec3::Zero()};
      Vec2 compliance = Vec2::Zero();
      if (const auto found = index.find(touch.node); found != index.end()) {
        const std::size_t k = found->second;
        for (std::size_t i = 0; i < D; ++i) placed.traction[i] = of["traction"].at(k * D + i);
        if (of.contains("compliance"))
          compliance = {of["compliance"].at(2 * k).get<double>(), of["compliance"].at(2 * k + 1).get<double>()};
        index.erase(found);
      } else if (of.empty() && touch.faces) {
        const auto holds = held.find(touch.node);
        const Vec3 force = residual.col(touch.node);
        placed.traction =
            (force - (holds == held.end() ? Vec3(Vec3::Zero()) : holds->second.taken(force))) / touch.area;
      }
      T_ = std::max(T_, placed.traction.norm());
      all.emplace_back(placed, compliance);
    }
    for (const auto& [node, k] : index)
      for (std::size_t i = 0; i < D; ++i)
        note(step, place, std::abs(of["traction"].at(k * D + i).get<double>()), contact.name + ", " + at(node));
  }
  std::vector<Placed> placed;
  for (auto& [one, compliance] : all) {
    check_place(one, compliance, step);
    placed.push_back(one);
  }
  return placed;
}

/// Signorini's conditions, and the friction, of one place.
void Judge::check_place(Placed& placed, const Vec2& compliance, Step& step) {
  const auto& [contact, touch, t, slid] = placed;
  const std::string where = contact->name + ", " + at(touch.node);
  const double L = L_ > 0 ? L_ : 1, T = T_ > 0 ? T_ : 1, p = placed.pressure();
  Past& past = past_[{contact->name, touch.node}];
  if (!touch.faces) {
    note(step, place, t.norm() / T, where + ", which faces nothing");
    past = {};
    return;
  }
  const double gap = touch.gap + compliance[0] * std::max(p, 0.0);  // less what springs explain
  if (!contact->itself || !t.isZero()) note(step, overlap, -gap / L, where);
  note(step, tension, -p / T, where);
  if (p > overlap.allowed * T) note(step, complementarity, gap / L, where);
  Vec3 last = past.friction;
  if (scene_.finite && scene_.dimension == 2) {  // its component along the tangent is carried on
    const Vec3 e(-touch.normal[1], touch.normal[0], 0);
    last = std::copysign(last.norm(), last.dot(e)) * e;
    past.rubbing = std::copysign(past.rubbing.norm(), past.rubbing.dot(e)) * e;
  }
  past.slid += touch.slip.dot(Vec3(-touch.normal[1], touch.normal[0], 0));
  placed.slid = past.slid;
  check_friction(placed, compliance, last, step);
  add_work(placed, past);
}

void Judge::check_friction(const Placed& placed, const Vec2& compliance, const Vec3& last, Step& step) {
  const auto& [contact, touch, t, slid_so_far] = placed;
  const std::string where = contact->name + ", " + at(touch.node);
  const double L = L_ > 0 ? L_ : 1, T = T_ > 0 ? T_ : 1, p = std::max(placed.pressure(), 0.0);
  const Vec3 s = t - placed.pressure() * touch.normal;
  const double most = bound(contact->given, p), near = most * (1 - share) - cone.allowed * T;
  note(step, cone, (s.norm() - most) / T, where);
  if (!touch.slip_known || !contact->given.contains("friction") || p == 0) return;
  const Vec3 slid = touch.slip + compliance[1] * (s - last);  // less what springs yield
  note(step, dissipation, s.dot(slid) / (T * L), where);
  if (s.norm() < near) return note(step, stick, slid.norm() / L, where);
  if (slid.norm() > stick.allowed * L && s.norm() > cone.allowed * T)
    note(step, direction, 1 + s.dot(slid) / (s.norm() * slid.norm()), where);
  for (const auto& name : std::set{contact->name, contact->group}) heat_[name] -= touch.area * s.dot(slid);
}

/// Work of a place in the increment, by the mean of the forces at its ends.
void Judge::add_work(const Placed& placed, Past& past) {
  const auto& [contact, touch, t, slid] = placed;
  const double pressing = touch.area * placed.pressure();
  const Vec3 friction = t - placed.pressure() * touch.normal, rubbing = touch.area * friction;
  const Vec3 carrying = (rubbing + past.rubbing + (pressing + past.pressing) * touch.normal) / 2;
  const double done = carrying.dot(touch.carried), opened = (pressing + past.pressing) / 2 * touch.opening,
               rubbed = -(rubbing + past.rubbing).dot(touch.slip) / 2;
  work_ += done + opened;
  spent_ += rubbed;
  size_ += std::abs(done) + std::abs(opened) + std::abs(rubbed);
  slack_ += (std::abs(pressing - past.pressing) + (rubbing - past.rubbing).norm()) *
            (touch.carried.norm() + std::abs(touch.opening) + touch.slip.norm()) / 2;
  past = {pressing, past.slid, rubbing, friction};
}

/// Supports and equilibrium; `residual`: f_int - loads - contact, of which supports take their part.
void Judge::check_nodes(const std::map<int, Held>& held, const Field& residual, State& state, Step& step) {
  state.held = Field::Zero(3, u_.cols());
  for (const auto& [node, holds] : held) {
    state.held.col(node) = holds.taken(residual.col(node));
    for (std::size_t k = 0; k < holds.values.size(); ++k)
      note(step, supports, std::abs(holds.directions[k].dot(u_.col(node)) - holds.values[k]) / (L_ > 0 ? L_ : 1),
           at(node));
  }
  for (Eigen::Index n = 0; n < u_.cols(); ++n)
    note(step, equilibrium, (residual.col(n) - state.held.col(n)).norm() / (F_ > 0 ? F_ : 1), at(static_cast<int>(n)));
}

void Judge::check_balance(const Field& outer, const Field& contact, Step& step) {
  const Vec3 middle = scene_.points.rowwise().mean();
  Vec3 sum = Vec3::Zero(), moment = sum;
  double all = F_ > 0 ? F_ : 1, arm = 1e-300;
  for (Eigen::Index n = 0; n < u_.cols(); ++n) {
    const Vec3 force = outer.col(n) + contact.col(n), x = scene_.place(static_cast<int>(n), u_) - middle;
    sum += force;
    moment += x.cross(force);
    all += force.norm();
    arm = std::max(arm, x.norm());
  }
  if (scene_.axisymmetric) sum[0] = 0;
  const double many = std::sqrt(static_cast<double>(u_.cols()));
  note(step, forces, sum.norm() / all, "of loads, supports and contacts", many * forces.allowed);
  const bool springs =
      std::any_of(scene_.bodies.begin(), scene_.bodies.end(), [](const Body& b) { return b.element == "point"; });
  if (!scene_.axisymmetric && !(scene_.finite && springs))
    note(step, moments, moment.norm() / (all * arm), "of loads, supports and contacts", many * moments.allowed);
}

/// work = stored + dissipated, from the start.
void Judge::check_energy(const Field& outer, const Field& contact, const Field& moved, Step& step) {
  const double done = (outer + outer_).cwiseProduct(moved).sum() / 2;
  for (Eigen::Index n = 0; n < u_.cols(); ++n)
    slack_ += (std::abs((outer - outer_).col(n).dot(moved.col(n))) +
               std::abs((contact - contact_).col(n).dot(moved.col(n)))) /
              2;
  outer_ = outer;
  contact_ = contact;
  work_ += done;
  spent_ += bodies_.plastic_work;
  size_ = std::max({size_ + std::abs(done) + bodies_.plastic_work, equilibrium.allowed * stiffness_ * L_ * L_, 1e-300});
  note(step, energy, std::abs(work_ - bodies_.energy - spent_) / size_,
       fmt::format("work {:.6g}, stored {:.6g}, dissipated {:.6g}", work_, bodies_.energy, spent_),
       std::min(1.0, slack_ / size_ + energy.allowed));
}

void Judge::check_responses(const State& state, const Json& given, Step& step) {
  for (const auto& [name, value] : given.items()) {
    const Json& what = scene_.json.at("responses").at(name);
    const std::string kind = what.begin().key();
    const auto again = value.is_number() ? measure(state, what) : std::nullopt;
    if (!again && value.is_number()) unmeasured.insert(name);
    if (!again) continue;
    const bool force = kind == "reaction" || kind == "contact_force",
               length = kind == "displacement" || kind == "gap" || kind == "slip";
    const double least = force                        ? F_
                         : length                     ? L_
                         : kind == "contact_pressure" ? T_
                         : kind == "plastic_strain"   ? 1e-9
                                                      : size_ * rounding;
    double& scale = largest_[kind];
    scale = std::max({scale, std::abs(*again), least});
    note(step, responses, std::abs(value.get<double>() - *again) / (scale > 0 ? scale : 1),
         fmt::format("\"{}\" is {:.9g}, not {:.9g}", name, *again, value.get<double>()));
  }
}

/// Plastic strains that are given, a mean of each element.
void Judge::check_flow(const Json& given, Step& step) {
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    const Json& means = part(given, scene_.bodies[b].name.c_str());
    const std::size_t elements = scene_.bodies[b].elements.size(), each = bodies_.memory[b].size() / elements;
    double largest = 1e-12;
    for (const auto& memory : bodies_.memory[b]) largest = std::max(largest, memory.equivalent);
    for (std::size_t e = 0; !means.empty() && e < elements; ++e) {
      double sum = 0, volume = 0;
      for (std::size_t q = e * each; q < (e + 1) * each; ++q) {
        sum += bodies_.memory[b][q].equivalent * bodies_.volumes[b][q];
        volume += bodies_.volumes[b][q];
      }
      note(step, flow, std::abs(means.at(e).get<double>() - sum / volume) / largest,
           fmt::format("{}, element {}", scene_.bodies[b].name, e));
    }
  }
}

/// Times at which a scene asks for a state; along a path by arc length none is known.
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

}  // namespace

const Finding& Step::worst() const {
  return *std::max_element(findings.begin(), findings.end(), [](const Finding& a, const Finding& b) {
    const auto over = [](const Finding& f) { return f.allowed > 0 ? f.value / f.allowed : f.value > 0 ? INFINITY : 0; };
    return over(a) < over(b);
  });
}

bool Certificate::holds() const {
  return !steps.empty() && std::all_of(steps.begin(), steps.end(), [](const Step& s) { return s.holds(); });
}

Certificate certify(const Json& scene, const Json& mesh, const Json& solution, const Json& result) {
  Certificate certificate;
  Judge judge(scene, mesh);
  std::map<double, Json> measured;
  std::vector<double> asked = asked_times(scene);
  for (const auto& step : result.value("steps", Json::array())) {
    measured[step.at("time")] = step.value("responses", Json());
    asked.push_back(step.at("time"));
  }
  std::set<double> there{-INFINITY};
  for (const auto& increment : solution.at("increments")) {
    const double time = increment.at("time");
    if (!(time > *there.rbegin()) && !scene.at("time").contains("control"))
      throw BadFile("times of increments do not increase");
    there.insert(time);
    const auto found = measured.find(time);
    certificate.steps.push_back(judge.read(increment, found == measured.end() ? Json() : found->second));
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
