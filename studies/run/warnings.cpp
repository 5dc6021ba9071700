#include "studies/run/warnings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/stencil.hpp"
#include "methods/newton/residuals.hpp"
#include "methods/stepping/free_bodies.hpp"
#include "studies/io/wording.hpp"
#include "studies/run/contact_start.hpp"
#include "studies/run/contact_warnings.hpp"
#include "studies/run/locking_warnings.hpp"
#include "studies/run/solution_warnings.hpp"
#include "studies/run/strains.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr double degree = M_PI / 180;

/// Largest strain and rotation in the elements of a body.
BodyMeasures deformation_of(const Problem& problem, const State<double>& state, std::size_t b) {
  BodyMeasures largest;
  for_each_strain(problem, state, b, [&](int, const auto& H, double, const double*) {
    const auto all = H.full();
    largest.strain = std::max(largest.strain, (all + all.transpose()).cwiseAbs().maxCoeff() / 2);
    largest.rotation = std::max(largest.rotation, std::abs(H(1, 0) - H(0, 1)) / 2);
  });
  return largest;
}

/// Traction of a point up to which it may be rounding. `reach`: largest displacement.
double rounding_of_traction(const Problem& problem, std::size_t p, double reach) {
  constexpr double rounding = 2e-12;  // of the motion: what its stiffness makes of less is right to 1e-4 at most
  return rounding * reach * problem.slots.stiffness[p] / problem.slots.geometry[p].area;
}

/// Whether a contact presses on a body at the end of a step.
bool is_pressed_at(const Problem& problem, const State<double>& state, std::size_t b) {
  const auto& model = problem.model;
  const double reach = largest_nodal_norm(state.displacement, model.dimension);
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto nodes = nodes_in(model, state.contact, p);
    if (-state.contact.traction[model.points[p].multiplier] > rounding_of_traction(problem, p, reach) &&
        std::any_of(nodes.begin(), nodes.end(), [&](int node) { return nodes_of_body(model, b).has(node); }))
      return true;
  }
  return false;
}

/// Whether a body that is pressed is strained by next to nothing, as where units are mixed.
bool is_hardly_strained(const CaseResult& result, std::size_t b, double strain) {
  constexpr double next_to_nothing = 1e-8;
  const auto steps = solved_steps(result);
  return strain < next_to_nothing && std::any_of(steps.begin(), steps.end(), [&](const StepResult& step) {
           return is_pressed_at(*result.problem, step.increment->state, b);
         });
}

void add_deformations(const CaseResult& result, std::vector<Warning>& warnings) {
  if (result.problem->model.scene.finite_strain) return;
  constexpr double most_strain = 0.05, absurd_strain = 1, most_rotation = 5 * degree;
  const auto& model = result.problem->model;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    BodyMeasures largest;
    for (const auto& step : solved_steps(result)) {
      const auto now = step.bodies.empty() ? deformation_of(*result.problem, step.increment->state, b) : step.bodies[b];
      largest = {std::max(largest.strain, now.strain), std::max(largest.rotation, now.rotation)};
    }
    const std::string& name = model.scene.bodies[b].name;
    constexpr const char* smaller = R"(apply less load or motion, or try "strain": "finite")";
    if (largest.strain > most_strain)
      warnings.push_back(
          {WarningCode::large_strain, name, largest.strain,
           largest.strain > absurd_strain ? "look at the units of stiffness, loads and motions" : smaller,
           fmt::format("{} is strained by up to {}; small strain holds below some 5 %", name,
                       in_percent(largest.strain))});
    if (largest.strain > 0 && is_hardly_strained(result, b, largest.strain))
      warnings.push_back({WarningCode::tiny_strain, name, largest.strain,
                          "look at whether its stiffness, the loads and the lengths are in units that go together",
                          fmt::format("{} is strained by no more than {:.2g}: it is some {:.2g} times as stiff as what "
                                      "presses on it",
                                      name, largest.strain, 1 / largest.strain)});
    const double degrees = largest.rotation / degree;
    if (largest.rotation > most_rotation)
      warnings.push_back({WarningCode::large_rotation, name, degrees, smaller,
                          fmt::format("{} rotates by up to {:.{}f} degrees; small strain holds below some 5", name,
                                      degrees, degrees < 10 ? 1 : 0)});
  }
}

/// Whether sliding along it changes the geometry of the contact.
bool is_flat(const Model& model, const ContactPoint& point) {
  return point.obstacle >= 0 && is_flat(model.scene.obstacles[point.obstacle].shape);
}

/// The number of a law that has no influence where no point slips.
struct IdleNumber {
  double value;
  std::string words;
};

IdleNumber idle_number(const FrictionLaw<double>& friction) {
  const auto words = std::visit([](const auto& law) { return law.idle; }, friction.law);
  const double first = friction.first_number();
  return {first, fmt::format(fmt::runtime(words), first)};
}

void add_slips(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double most = 0.5;  // of a slave element
  const auto& model = result.problem->model;
  const auto& contacts = model.scene.contacts;
  std::vector<double> farthest(contacts.size(), 0);
  std::vector<char> closed(contacts.size(), 0), slipped(contacts.size(), 0);
  for (const auto& step : solved_steps(result)) {
    const auto& field = step.increment->state.contact;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& point = model.points[p];
      if (field.state[p] == ContactState::open) continue;
      closed[point.contact] = 1;
      if (point.tangents == 0) continue;
      if (is_slipping(field.state[p])) slipped[point.contact] = 1;
      const auto offset = tangential_offset(model, static_cast<int>(p));
      const double placement = step.increment->state.history.placement.segment(offset, point.tangents).norm();
      if (point.mesh_size > 0 && !is_flat(model, point) && !model.effects.current_geometry)
        farthest[point.contact] = std::max(farthest[point.contact], placement / point.mesh_size);
    }
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const std::string& name = contacts[c].name;
    if (farthest[c] > most)
      warnings.push_back({WarningCode::large_sliding, name, farthest[c],
                          "slide less, or put a flat obstacle in the place of a stiff master",
                          fmt::format("{}: a point slides by {:.2g} elements of the slave; the contact geometry is "
                                      "that of the start, which holds below some half of one",
                                      name, farthest[c])});
    const auto& law = result.problem->slots.friction[c];
    if (!has_ended(result) || !contacts[c].friction || law.bears_nothing() || !closed[c] || slipped[c]) continue;
    if (steps_with(result, c, &StepResult::undetermined) > 0) continue;  // (friction decides which forces may be)
    const IdleNumber idle = idle_number(law);
    warnings.push_back(
        {WarningCode::idle_friction, name, idle.value, "lower the friction, or pull harder",
         fmt::format("{}: no point slipped in any step, so that the {} has no influence", name, idle.words)});
  }
}

void add_cut_steps(const CaseResult& result, std::vector<Warning>& warnings) {
  if (!result.problem->model.effects.friction) return;
  const auto steps = solved_steps(result);
  const auto cut =
      std::count_if(steps.begin(), steps.end(), [](const StepResult& step) { return step.increment->cutbacks > 0; });
  if (cut > 0)
    warnings.push_back(
        {WarningCode::cut_steps, "", static_cast<double>(cut), "ask for more steps",
         fmt::format("{} of {} steps were cut into smaller ones: friction depends on the path, and this is another "
                     "one than whole steps would take",
                     cut, steps.size())});
}

/// The motion that a body is free to make where only what presses holds it. `reach`: largest displacement of the run.
std::string motion_of_floating_body(const Problem& problem, const State<double>& state, std::size_t b, double reach) {
  constexpr double pressing = 1e-6;  // of the largest traction: less is a touch without force
  const auto& [model, slots, unused] = problem;
  const auto& points = model.points;
  auto states = state.contact.state;
  double largest = 0;
  for (const auto& point : points) largest = larger(largest, -state.contact.traction[point.multiplier]);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double least = std::max(pressing * largest, rounding_of_traction(problem, p, reach));
    if (!(-state.contact.traction[points[p].multiplier] > least)) states[p] = ContactState::open;
  }
  return free_motion(model, slots, b, state, states);
}

void add_floating_bodies(const CaseResult& result, std::vector<Warning>& warnings) {
  for (const FloatingBody& body : bodies_that_float(result))
    warnings.push_back(
        {WarningCode::floating_body, body.name, static_cast<double>(body.steps),
         "hold it by a support, or end the run while something presses on it",
         fmt::format("{} floats at the end of {} of {} steps, first at t = {:.6g}: it is free to move {}, as neither "
                     "supports nor a contact that presses hold it, and its place is not determined",
                     body.name, body.steps, solved_steps(result).size(), body.first, body.motion)});
}

/// Share of the force of contact c that one node carries, and its force, at a step; nothing where it does not press.
struct Share {
  double of_one = 0, force = 0;
  int points = 0;
};
Share share_of(const Problem& problem, const ContactField<double>& field, int c) {
  Share share;
  for (std::size_t p = 0; p < problem.model.points.size(); ++p) {
    const auto& point = problem.model.points[p];
    if (point.contact != c) continue;
    const double force = -area_in(field, problem.slots, p) * field.traction[point.multiplier];
    ++share.points;
    share.force += force;
    share.of_one = larger(share.of_one, force);
  }
  share.of_one = share.force > 0 ? share.of_one / share.force : 0;
  return share;
}

void add_single_nodes(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double nearly_all = 0.95;
  const auto& model = result.problem->model;
  std::vector<char> wide(model.scene.contacts.size(), 0);  // a side of a continuum
  for (const auto& point : model.points) wide[point.contact] = is_continuum(model.bodies[point.slave_body].mesh.shape);
  for (int c = 0; c < static_cast<int>(wide.size()); ++c) {
    if (!wide[c]) continue;
    Share hardest;  // pressed
    for (const auto& step : solved_steps(result)) {
      const Share now = share_of(*result.problem, step.increment->state.contact, c);
      if (now.force > hardest.force) hardest = now;
    }
    if (hardest.points < 2 || !(hardest.of_one > nearly_all)) continue;
    const std::string& name = model.scene.contacts[c].name;
    warnings.push_back(
        {WarningCode::single_node, name, hardest.of_one, "refine the slave's mesh towards the contact",
         fmt::format("{}: one of {} nodes carries {:.3g} % of the force; pressure and half width there are those of "
                     "the mesh",
                     name, hardest.points, 100 * hardest.of_one)});
  }
}

void add_shared_places(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& model = result.problem->model;
  for (std::size_t i = 0; i < model.response_places.size(); ++i) {
    const auto& bodies = model.response_places[i].bodies;
    if (bodies.size() < 2) continue;
    const std::string &name = model.scene.responses[i].name, &taken = model.scene.bodies[bodies[0]].name,
                      &other = model.scene.bodies[bodies[1]].name;
    warnings.push_back({WarningCode::shared_place, taken, static_cast<double>(bodies.size()),
                        fmt::format(R"(name the body, "on": "{}" or "on": "{}")", taken, other),
                        fmt::format("the response {} is of {}, but {} holds its point too", name, taken, other)});
  }
}

/// A path that used its steps up before it came to the full load.
void add_path_that_goes_on(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& model = result.problem->model;
  if (!model.scene.arc_length || result.steps.empty()) return;
  const double share = result.steps.back().increment->time / model.times.back();
  if (share == 1) return;
  warnings.push_back(
      {WarningCode::path_goes_on, "", share, "allow more steps (max), or longer ones (length)",
       fmt::format("the path goes on: after {} steps the load is {:.3g} of the full one", result.steps.size(), share)});
}

}  // namespace

std::vector<FloatingBody> bodies_that_float(const CaseResult& result) {
  const auto& model = result.problem->model;
  std::vector<FloatingBody> floating;
  double reach = 0;
  for (const auto& step : solved_steps(result))
    reach = std::max(reach, largest_nodal_norm(step.increment->state.displacement, model.dimension));
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (&model.scene.bodies[b] == loose_body(model)) continue;  // (studies/run/solution_warnings.cpp names it)
    FloatingBody body{model.scene.bodies[b].name};
    for (const auto& step : solved_steps(result)) {
      const std::string now = step.bodies.empty()
                                  ? motion_of_floating_body(*result.problem, step.increment->state, b, reach)
                                  : step.bodies[b].free_motion;
      if (now.empty() || ++body.steps > 1) continue;
      body.motion = now;
      body.first = step.increment->time;
    }
    if (body.steps > 0) floating.push_back(std::move(body));
  }
  return floating;
}

BodyMeasures measures_of_body(const Problem& problem, const State<double>& state, std::size_t b) {
  BodyMeasures measures;
  if (!problem.model.scene.finite_strain) measures = deformation_of(problem, state, b);
  measures.spurious_pressure = watched_pressure(problem, state, b);
  measures.parasitic_shear = parasitic_shear(problem, state, b);
  measures.free_motion =
      motion_of_floating_body(problem, state, b, largest_nodal_norm(state.displacement, problem.model.dimension));
  return measures;
}

long steps_with(const CaseResult& result, std::size_t contact, std::vector<char> StepResult::*marks) {
  const auto steps = solved_steps(result);
  return std::count_if(steps.begin(), steps.end(),
                       [&](const StepResult& step) { return !(step.*marks).empty() && (step.*marks)[contact] != 0; });
}

std::vector<Warning> warnings_of(const CaseResult& result) {
  std::vector<Warning> warnings = overlaps_at_start(*result.problem);
  for (auto& warning : contacts_never_closed(result)) warnings.push_back(std::move(warning));
  add_deformations(result, warnings);
  add_slips(result, warnings);
  add_cut_steps(result, warnings);
  add_locking_warnings(result, warnings);
  add_single_nodes(result, warnings);
  add_contact_warnings(result, warnings);
  add_floating_bodies(result, warnings);
  add_shared_places(result, warnings);
  add_solution_warnings(result, warnings);
  if (has_ended(result)) add_path_that_goes_on(result, warnings);
  return warnings;
}

json warnings_json(const CaseResult& result) {
  json out = json::array();
  for (const auto& warning : warnings_of(result))
    out.push_back({{"code", name_of(warning.code)},
                   {"where", warning.where},
                   {"value", warning.value},
                   {"remedy", warning.remedy},
                   {"text", warning.text}});
  return out;
}

}  // namespace stickslip
