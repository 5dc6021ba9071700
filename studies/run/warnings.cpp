#include "studies/run/warnings.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <span>

#include "methods/diagnosis.hpp"
#include "methods/residuals.hpp"
#include "sensitivity/force_search.hpp"
#include "studies/run/contact_warnings.hpp"
#include "studies/run/strains.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr double degree = M_PI / 180;

/// Poisson's ratio from which locking is looked for, and spurious pressure that is told.
constexpr double nearly_incompressible = 0.45, most_spurious = 0.2;

/// Whether these are all. What says something of a whole run is not said of one that failed.
bool has_ended(const CaseResult& result) { return solved_steps(result).size() == result.steps.size(); }

/// Largest strain and rotation in the elements of a body.
BodyMeasures deformation_of(const Problem& problem, const State<double>& state, std::size_t b) {
  BodyMeasures largest;
  for_each_strain(problem, state, b, [&](int, const auto& H, double, const double*) {
    largest.strain = std::max(largest.strain, (H + H.transpose()).cwiseAbs().maxCoeff() / 2);
    largest.rotation = std::max(largest.rotation, std::abs(H(1, 0) - H(0, 1)) / 2);
  });
  return largest;
}

void add_deformations(const CaseResult& result, std::vector<Warning>& warnings) {
  if (result.problem->model.scene.finite_strain) return;
  constexpr double most_strain = 0.05, most_rotation = 5 * degree;
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
      warnings.push_back({WarningCode::large_strain, name, largest.strain, smaller,
                          fmt::format("{} is strained by up to {:.2g} %; small strain holds below some 5 %", name,
                                      100 * largest.strain)});
    if (largest.rotation > most_rotation)
      warnings.push_back({WarningCode::large_rotation, name, largest.rotation / degree, smaller,
                          fmt::format("{} rotates by up to {:.2g} degrees; small strain holds below some 5", name,
                                      largest.rotation / degree)});
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

/// How many steps have a mark of a contact.
long steps_with(const CaseResult& result, std::size_t contact, std::vector<char> StepResult::*marks) {
  const auto steps = solved_steps(result);
  return std::count_if(steps.begin(), steps.end(),
                       [&](const StepResult& step) { return !(step.*marks).empty() && (step.*marks)[contact] != 0; });
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

void add_held_points(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double negligible = 1e-6;  // of a facet: a free end reaches so far, and rounding does
  const auto& model = result.problem->model;
  std::vector<double> farthest(model.scene.contacts.size(), 0);
  std::vector<int> steps(farthest.size(), 0);
  for (const auto& step : solved_steps(result)) {
    const auto& field = step.increment->state.contact;
    std::vector<char> held(farthest.size(), 0);
    for (std::size_t p = 0; p < field.facing.size(); ++p) {
      const int contact = model.points[p].contact;
      const double beyond = std::max(-field.facing[p].xi, field.facing[p].xi - 1);
      if (field.state[p] == ContactState::open || !(beyond > negligible)) continue;
      farthest[contact] = std::max(farthest[contact], beyond);
      held[contact] = 1;
    }
    for (std::size_t c = 0; c < held.size(); ++c) steps[c] += held[c];
  }
  for (std::size_t c = 0; c < farthest.size(); ++c)
    if (farthest[c] > 0)
      warnings.push_back(
          {WarningCode::held_on_facet, model.scene.contacts[c].name, farthest[c],
           "smooth the master, or integrate over segments (\"discretization\": \"segment\")",
           fmt::format("{}: in {} of {} steps a point is held on a facet of the master beyond its end, "
                       "by {:.2g} of it: at the vertex neither facet has an equilibrium",
                       model.scene.contacts[c].name, steps[c], solved_steps(result).size(), farthest[c])});
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

/// Elements whose pressure locks where the material hardly changes its volume.
bool may_lock(const Problem& problem, std::size_t b) {
  const auto& body = problem.model.bodies[b];
  const ElementShape shape = body.mesh.shape;
  return problem.model.scene.space != Space::plane_stress && !has_mean_dilatation(body.kinematics) &&
         (shape == ElementShape::quad4 || shape == ElementShape::tri3);
}

/// What a body of small strain resists: of linear elasticity, or of a metal, whose flow keeps the volume.
struct Moduli {
  double lame, shear;
  bool flows;
  double nu() const { return lame / (2 * (lame + shear)); }
};
std::optional<Moduli> moduli_of(const Law<double>& law) {
  if (const auto* elastic = std::get_if<LinearElasticLaw<double>>(&law))
    return Moduli{elastic->lame, elastic->shear, false};
  if (const auto* metal = std::get_if<J2Law<double>>(&law); metal && !metal->is_finite)
    return Moduli{metal->lame, metal->shear, true};
  return std::nullopt;
}

/// Whether locking is looked for in a body.
bool is_watched_for_locking(const Problem& problem, std::size_t b) {
  const auto moduli = moduli_of(problem.slots.laws[b]);
  return moduli && may_lock(problem, b) && (moduli->flows || moduli->nu() >= nearly_incompressible);
}

void add_locking(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& problem = *result.problem;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    if (!is_watched_for_locking(problem, b)) continue;
    const auto moduli = moduli_of(problem.slots.laws[b]);
    double largest = 0;
    for (const auto& step : solved_steps(result))
      largest = larger(largest, step.bodies.empty() ? spurious_pressure(problem, step.increment->state, b)
                                                    : step.bodies[b].spurious_pressure);
    if (!(largest > most_spurious)) continue;
    const std::string& name = problem.model.scene.bodies[b].name;
    const bool quads = problem.model.bodies[b].mesh.shape == ElementShape::quad4;
    warnings.push_back(
        {WarningCode::locking, name, largest, quads ? "element Q4_mean_dilatation or Q8" : "element T6",
         fmt::format("{} locks: {} in {} elements, and {:.2g} of its stress is a pressure "
                     "that alternates from element to element",
                     name, moduli->flows ? "plastic flow keeps the volume" : fmt::format("nu = {:.6g}", moduli->nu()),
                     quads ? "Q4" : "T3", largest)});
  }
}

/// Nodes at the ends of an element's edge on the boundary of its body.
using BoundaryEdges = std::map<int, std::pair<int, int>>;  // by element

/// Per element with an edge on the boundary: one of these. Empty where some node is inside of the body: then it is more
/// than one element thick.
BoundaryEdges edges_of_thin_body(const Mesh& mesh) {
  const int nodes = nodes_of(mesh.shape);
  std::map<std::pair<int, int>, int> edges;  // as the elements have them; an inner one in both directions
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < nodes; ++k)
      edges[{mesh.connectivity[e * nodes + k], mesh.connectivity[e * nodes + (k + 1) % nodes]}] = e;
  BoundaryEdges found;
  std::set<int> on_boundary;
  for (const auto& [edge, element] : edges) {
    if (edges.count({edge.second, edge.first}) > 0) continue;
    found.emplace(element, edge);
    on_boundary.insert({edge.first, edge.second});
  }
  return static_cast<int>(on_boundary.size()) == mesh.node_count ? found : BoundaryEdges{};
}

bool may_lock_in_shear(const Problem& problem, std::size_t b) {
  const ElementShape shape = problem.model.bodies[b].mesh.shape;
  return shape == ElementShape::quad4 || shape == ElementShape::tri3;
}

void add_shear_locking(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double most = 0.2;  // squares, of which bending is more than half of the squared strain
  const auto& problem = *result.problem;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    if (!may_lock_in_shear(problem, b) || edges_of_thin_body(problem.model.bodies[b].mesh).empty()) continue;
    double largest = 0;
    for (const auto& step : solved_steps(result))
      largest = larger(largest, step.bodies.empty() ? parasitic_shear(problem, step.increment->state, b)
                                                    : step.bodies[b].parasitic_shear);
    if (!(largest > most)) continue;
    const std::string& name = problem.model.scene.bodies[b].name;
    const bool quads = problem.model.bodies[b].mesh.shape == ElementShape::quad4;
    warnings.push_back({WarningCode::shear_locking, name, largest,
                        quads ? "element Q8, or more elements through its thickness"
                              : "element T6, or more elements through its thickness",
                        fmt::format("{} bends, and is one {} thick: {:.2g} of its squared strain is a shear that "
                                    "bending has not, so that it is too stiff",
                                    name, quads ? "Q4" : "T3", largest)});
  }
}

/// The motion that a body is free to make where only what presses holds it. `reach`: largest displacement of the run.
std::string motion_of_floating_body(const Problem& problem, const State<double>& state, std::size_t b, double reach) {
  constexpr double pressing = 1e-6;  // of the largest traction: less is a touch without force
  constexpr double rounding = 1e-9;  // of the motion: what its stiffness makes of less is no force
  const auto& [model, slots, unused] = problem;
  const auto& points = model.points;
  auto states = state.contact.state;
  double largest = 0;
  for (const auto& point : points) largest = larger(largest, -state.contact.traction[point.multiplier]);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double least = rounding * reach * slots.stiffness[p] / slots.geometry[p].area;
    if (!(-state.contact.traction[points[p].multiplier] > std::max(pressing * largest, least)))
      states[p] = ContactState::open;
  }
  return detail::free_motion(model, slots, b, state, states);
}

void add_floating_bodies(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& model = result.problem->model;
  double reach = 0;
  for (const auto& step : solved_steps(result))
    reach = std::max(reach, largest_nodal_norm(step.increment->state.displacement, model.dimension));
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    if (&model.scene.bodies[b] == loose_body(model)) continue;  // (add_loose_bodies names it)
    std::string motion;
    double first = 0;
    int steps = 0;
    for (const auto& step : solved_steps(result)) {
      const std::string now = step.bodies.empty()
                                  ? motion_of_floating_body(*result.problem, step.increment->state, b, reach)
                                  : step.bodies[b].free_motion;
      if (now.empty()) continue;
      if (++steps > 1) continue;
      motion = now;
      first = step.increment->time;
    }
    if (steps == 0) continue;
    const std::string& name = model.scene.bodies[b].name;
    warnings.push_back(
        {WarningCode::floating_body, name, static_cast<double>(steps),
         "hold it by a support, or end the run while something presses on it",
         fmt::format("{} floats at the end of {} of {} steps, first at t = {:.6g}: it is free to move {}, as neither "
                     "supports nor a contact that presses hold it, and its place is not determined",
                     name, steps, solved_steps(result).size(), first, motion)});
  }
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

void add_loose_bodies(const CaseResult& result, std::vector<Warning>& warnings) {
  if (const Body* const loose = loose_body(result.problem->model))
    warnings.push_back({WarningCode::non_unique, loose->name, 0, "add a support or a contact",
                        loose->name + " may be anywhere: no support holds it and no contact touches it; it is left "
                                      "where it is"});
}

/// Steps with other solutions than the one that was taken, where these were counted, or with tangents that belong to
/// problems of which some have several.
void add_other_solutions(const CaseResult& result, std::vector<Warning>& warnings) {
  std::size_t most = 0, several = 0, uncounted = 0;
  double first = 0;
  const std::span increments(result.trajectory.increments.data(), result.trajectory.solved_count());
  for (const auto& increment : increments) {
    if (increment.reversed && !increment.counted) ++uncounted;
    if (increment.others.empty()) continue;
    if (several++ == 0) first = increment.time;
    most = std::max(most, 1 + increment.others.size());
  }
  const std::string remedy =
      "look at `solutions`, and whether friction this high is meant; smaller steps follow a branch";
  if (several > 0)
    warnings.push_back(
        {WarningCode::non_unique, "", static_cast<double>(most), remedy,
         fmt::format("{} of {} increments have several solutions, up to {}, the first at t = {:.6g}; the one "
                     "is taken in which the motion from the last increment comes to rest",
                     several, increments.size(), most, first)});
  for (const auto& increment : increments)
    if (increment.jump)
      warnings.push_back({WarningCode::branch_ends, "", *increment.jump,
                          "control a displacement in place of a force, or lower the friction",
                          fmt::format("the branch of solutions ends at t = {:.4g}, and the bodies jump to another one",
                                      *increment.jump)});
  if (several == 0 && uncounted > 0)
    warnings.push_back(
        {WarningCode::non_unique, "", 1, remedy,
         fmt::format("{} of {} increments met tangents whose determinant has the other sign: there may be "
                     "other solutions",
                     uncounted, increments.size())});
}

/// Contacts whose forces equilibrium leaves open, and points on a vertex.
void add_undetermined_contacts(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& contacts = result.problem->model.scene.contacts;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const std::string& name = contacts[c].name;
    const std::size_t steps = solved_steps(result).size();
    if (const long n = steps_with(result, c, &StepResult::undetermined); n > 0)
      warnings.push_back(
          {WarningCode::non_unique, name, 0,
           "take friction off one of the contacts of a node, or use fewer slave nodes on a facet of the master",
           fmt::format("{}: in {} of {} steps the forces of its points are not determined: their constraints repeat "
                       "one another, so that other forces balance the same loads; methods, scales and steps may settle "
                       "on different ones",
                       name, n, steps)});
    if (const long n = steps_with(result, c, &StepResult::at_vertex); n > 0)
      warnings.push_back(
          {WarningCode::non_unique, name, 1,
           R"(smooth the master, integrate over segments ("discretization": "segment"), or shift a mesh a little)",
           fmt::format("{}: in {} of {} steps a point begins or ends on a vertex of the master's facets: each of "
                       "the two facets may lead to a solution of its own, and rounding decides between them",
                       name, n, steps)});
  }
}

/// Springs of a penalty that yield beside the bodies: under the contact's force, as the method-blind errors measure it;
/// and under the part of the pressures that the slave alone shares out, where more nodes of it face the master than
/// nodes of that. It yields there by 1/k of its nodes, beside which the springs' 1/(stiffness A) is to be small.
void add_soft_penalty(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double most = 0.02;
  const auto* penalty = std::get_if<Penalty>(&result.method);
  if (!penalty) return;
  constexpr const char* stiffer = "raise `stiffness`, or take another method";
  double yields = 0;
  for (const auto& step : solved_steps(result)) yields = std::max({yields, step.kkt.gap, step.kkt.stick});
  if (yields > most)
    warnings.push_back({WarningCode::soft_penalty, "", yields, stiffer,
                        fmt::format("the springs of the penalty yield by {:.2g} % of the motion of the contact, and "
                                    "forces are off by about as much",
                                    100 * yields)});
  const auto& [model, slots, unused] = *result.problem;
  const auto rho = initial_regularisation(slots, *penalty);
  const auto shares = slave_shares(model, slots);
  std::vector<double> softest(model.scene.contacts.size(), 0);
  for (std::size_t p = 0; p < shares.size(); ++p)
    softest[model.points[p].contact] =
        std::max(softest[model.points[p].contact], shares[p] / (rho[p].normal * slots.geometry[p].area));
  for (std::size_t c = 0; c < softest.size(); ++c)
    if (softest[c] > most && softest[c] > 10 * yields)  // (the first sentence says the rest)
      warnings.push_back(
          {WarningCode::soft_penalty, model.scene.contacts[c].name, softest[c], stiffer,
           fmt::format("{}: several nodes of a stiff slave share facets of a softer master, and the springs of the "
                       "penalty yield by {:.2g} times what the slave does: they decide how its nodes share the force",
                       model.scene.contacts[c].name, softest[c])});
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

const Body* loose_body(const Model& model) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto in_body = [&, first = model.bodies[b].first_node](int node) {
      return node >= first && node < first + model.bodies[b].mesh.node_count;
    };
    const bool held = std::any_of(model.constraints.begin(), model.constraints.end(),
                                  [&](const Constraint& c) { return in_body(c.dof / model.dimension); });
    const bool touched = std::any_of(model.contact_nodes.begin(), model.contact_nodes.end(), in_body);
    if (!held && !touched) return &model.scene.bodies[b];
  }
  return nullptr;
}

double spurious_pressure(const Problem& problem, const State<double>& state, std::size_t b) {
  const auto& law = problem.slots.laws[b];
  const auto moduli = moduli_of(law);
  if (!moduli || !may_lock(problem, b)) return 0;
  const auto& mesh = problem.model.bodies[b].mesh;
  const int nodes = nodes_of(mesh.shape);
  Vector<double> volume = Vector<double>::Zero(mesh.element_count()), change = volume, around = volume;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    volume[e] += v;
    change[e] += v * H.trace();
  });
  Vector<double> nodal_volume = Vector<double>::Zero(mesh.node_count), nodal_change = nodal_volume;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < nodes; ++a) {
      nodal_volume[mesh.connectivity[e * nodes + a]] += volume[e];
      nodal_change[mesh.connectivity[e * nodes + a]] += change[e];
    }
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < nodes; ++a) {
      const int node = mesh.connectivity[e * nodes + a];
      around[e] += nodal_change[node] / nodal_volume[node] / nodes;
    }
  const double bulk = moduli->lame + 2 * moduli->shear / 3;
  double spurious = 0, all = 0;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double* memory) {
    constexpr int rows = std::decay_t<decltype(H)>::RowsAtCompileTime;
    const auto [xx, yy, zz, xy] = stress_of<rows>(law, H, memory);
    spurious += v * std::pow(bulk * (H.trace() - around[e]), 2);
    all += v * (xx * xx + yy * yy + zz * zz + 2 * xy * xy);
  });
  return all > 0 ? std::sqrt(spurious / all) : 0;
}

double parasitic_shear(const Problem& problem, const State<double>& state, std::size_t b) {
  const auto& body = problem.model.bodies[b];
  const auto& mesh = body.mesh;
  if (!may_lock_in_shear(problem, b)) return 0;
  const auto edges = edges_of_thin_body(mesh);
  if (edges.empty()) return 0;
  const int nodes = nodes_of(mesh.shape);
  using Strain = Mat<double, 2>;  // in the plane; Green's at finite strain
  const auto strain_of = [&](const auto& H) {
    const Strain h = H.template topLeftCorner<2, 2>();
    Strain strain = (h + h.transpose()) / 2;
    if (problem.model.scene.finite_strain) strain += h.transpose() * h / 2;
    return strain;
  };
  std::vector<double> volume(mesh.element_count(), 0), nodal_volume(mesh.node_count, 0);
  std::vector<Strain> mean(mesh.element_count(), Strain::Zero()), nodal(mesh.node_count, Strain::Zero()), around = mean;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    volume[e] += v;
    mean[e] += v * strain_of(H);
  });
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < nodes; ++a) {
      nodal_volume[mesh.connectivity[e * nodes + a]] += volume[e];
      nodal[mesh.connectivity[e * nodes + a]] += mean[e];
    }
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int a = 0; a < nodes; ++a) {
      const int node = mesh.connectivity[e * nodes + a];
      around[e] += nodal[node] / (nodal_volume[node] * nodes);
    }
  double shear = 0, all = 0;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    const Strain strain = strain_of(H);
    all += v * strain.squaredNorm();
    const auto edge = edges.find(e);
    if (edge == edges.end()) return;
    const auto [from, to] = edge->second;
    const Vec<double, 2> along =
        (problem.slots.points.col(body.first_node + to) - problem.slots.points.col(body.first_node + from))
            .template head<2>()
            .normalized();
    const double varying = along.dot((strain - around[e]) * Vec<double, 2>(-along[1], along[0]));
    shear += 2 * v * varying * varying;
  });
  return all > 0 ? shear / all : 0;
}

BodyMeasures measures_of_body(const Problem& problem, const State<double>& state, std::size_t b) {
  BodyMeasures measures;
  if (!problem.model.scene.finite_strain) measures = deformation_of(problem, state, b);
  if (is_watched_for_locking(problem, b)) measures.spurious_pressure = spurious_pressure(problem, state, b);
  measures.parasitic_shear = parasitic_shear(problem, state, b);
  measures.free_motion =
      motion_of_floating_body(problem, state, b, largest_nodal_norm(state.displacement, problem.model.dimension));
  return measures;
}

std::span<const StepResult> solved_steps(const CaseResult& result) {
  const auto end = std::find_if(result.steps.begin(), result.steps.end(),
                                [](const StepResult& step) { return !step.increment->solved(); });
  return {result.steps.begin(), end};
}

std::vector<Warning> warnings_of(const CaseResult& result) {
  std::vector<Warning> warnings;
  add_deformations(result, warnings);
  add_slips(result, warnings);
  add_held_points(result, warnings);
  add_cut_steps(result, warnings);
  add_locking(result, warnings);
  add_shear_locking(result, warnings);
  add_single_nodes(result, warnings);
  add_contact_warnings(result, warnings);
  add_floating_bodies(result, warnings);
  add_shared_places(result, warnings);
  if (has_ended(result)) add_loose_bodies(result, warnings);
  add_other_solutions(result, warnings);
  add_undetermined_contacts(result, warnings);
  add_soft_penalty(result, warnings);
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
