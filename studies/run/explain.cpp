#include "studies/run/explain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/model/loading.hpp"
#include "core/model/pairing.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "studies/input/method_options.hpp"
#include "studies/input/size_estimate.hpp"
#include "studies/io/numerals.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/contact_start.hpp"
#include "studies/run/contact_warnings.hpp"
#include "studies/run/ledger_forecast.hpp"
#include "studies/run/simulation.hpp"

namespace stickslip {
namespace {

const char* shape_name(ElementShape shape) {
  switch (shape) {
    case ElementShape::point:
      return "spring";
    case ElementShape::bar2:
      return "bar";
    case ElementShape::tri3:
      return "T3 triangle";
    case ElementShape::quad4:
      return "Q4 quadrilateral";
    case ElementShape::tri6:
      return "T6 triangle";
    case ElementShape::quad8:
      return "Q8 quadrilateral";
    case ElementShape::tet4:
      return "T4 tetrahedron";
    case ElementShape::hex8:
      return "H8 hexahedron";
    case ElementShape::tet10:
      return "T10 tetrahedron";
    case ElementShape::hex20:
      return "H20 hexahedron";
    case ElementShape::hex27:
      return "H27 hexahedron";
  }
  return "";
}

const char* space_name(Space space) {
  switch (space) {
    case Space::plane_strain:
      return "plane strain";
    case Space::plane_stress:
      return "plane stress";
    case Space::axisymmetric:
      return "axisymmetric (x is the radius, y the axis, all forces are of the full revolution)";
    case Space::solid:
      return "space (3D)";
  }
  return "";
}

template <class List>
std::string count(const List& list, const std::string& noun) {
  return counted(static_cast<long>(list.size()), noun);
}

std::string law_in_words(const FrictionLaw<Number>& friction) {
  std::string words;
  friction.for_each_number([&](const auto& number, const Number& x) { words += number.words + exact_number(x.value); });
  return words;
}

/// With their heading. What kind of contact it is stands in the heading, or, where segments are among them, in each
/// line.
std::string contact_lines(const Problem& problem) {
  const auto& [model, slots, unused] = problem;
  const auto& at_start = slots.points;
  const auto& contacts = model.scene.contacts;
  const bool mixed = std::any_of(contacts.begin(), contacts.end(), [](const auto& of) { return of.segment; });
  const std::string heading = mixed ? "contacts:\n" : "contacts (node to segment):\n";
  const auto gaps = start_gaps(problem);
  std::string text;
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) {
    const auto& contact = model.scene.contacts[c];
    int points = 0;
    for (const auto& point : model.points) points += point.contact == static_cast<int>(c);
    const std::size_t slaves = surface_of(model, at_start, model.contact_sides[c].slave).nodes.size() -
                               nodes_without_area(model, at_start, static_cast<int>(c)).size();
    text += fmt::format("  {}: {} against {}, {}", contact.name, contact.slave, contact.master,
                        counted(points, "contact point"));
    if (mixed) text += contact.segment ? " (segment-integrated)" : " (node to segment)";
    if (points < static_cast<int>(slaves)) text += fmt::format(" ({} slave nodes face no master)", slaves - points);
    text += contact.friction ? ", " + law_in_words(*contact.friction) + "\n" : ", frictionless\n";
    if (points > 0) text += "    gap at the start: " + gaps[c].in_words() + "\n";
  }
  return heading + (text.empty() ? "  none\n" : text);
}

/// Of a body.
long contact_dofs(const Model& model, std::size_t body) {
  const int first = model.bodies[body].first_node, end = first + model.bodies[body].mesh.node_count;
  return model.dimension * std::count_if(model.contact_nodes.begin(), model.contact_nodes.end(),
                                         [&](int node) { return node >= first && node < end; });
}

/// What becomes of each body where some are condensed and others are not.
std::string mixed_lines(const Model& model) {
  std::string text;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    text += fmt::format("  {}: ", model.scene.bodies[b].name);
    if (is_among(model, b, BodyKind::constant))
      text += fmt::format("condensed once to {} contact dofs, a dense block\n", contact_dofs(model, b));
    else
      text += "in full, its tangent assembled anew in each iteration\n";
  }
  return text;
}

/// Which engine runs, what it does with each body of a mixed scene, and the prices it was chosen by.
std::string engine_lines(const Input& input, const Problem& problem) {
  const auto& model = problem.model;
  const auto engine = input.linear_algebra.engine;
  const bool condensed = condenses(model, input.method, engine);
  FullBodies<double> bodies(model, problem.slots);
  const SystemKind kind = system_kind(model, multipliers_of(input.method), cone_radius_of(input.method), input.backend);
  const auto tangent = condensed ? nullptr : make_condensed_tangent(model, problem.slots, kind, engine, bodies);
  std::string text = "linear algebra: ";
  text += tangent ? fmt::format(
                        "tangents of the bodies condensed, one after the other, to {} contact dofs; points change "
                        "their branches on a dense system of {} rows at the start\n",
                        tangent->kept(), tangent->dense_rows())
          : !model.effects.linear_bulk ? "one sparse factorisation an iteration, the bodies' part assembled anew\n"
          : condensed ? fmt::format("bodies condensed once to {} contact dofs, Newton on a dense system\n",
                                    model.contact_nodes.size() * model.dimension)
                      : "one sparse factorisation an iteration, the bodies' part assembled once\n";
  if (condensed && !model.effects.linear_bulk) text += mixed_lines(model);
  const EnginePrice price = predict_price(model, input.method, bodies_factor(model));
  text += "  predicted: ";
  if (can_condense(model)) text += fmt::format("{} Gflop condensed, ", number(1e-9 * price.condensed, 2));
  return text + fmt::format("{} Gflop sparse\n", number(1e-9 * price.sparse, 2));
}

}  // namespace

std::string explain(const Input& input, const Problem& problem) {
  const auto& model = problem.model;
  const auto& scene = model.scene;
  const auto& effects = model.effects;
  std::string text = printable(scene.title.empty() ? input.file : scene.title) + "\n";
  text += fmt::format("\nspace: {}, {}\nbodies:\n", space_name(scene.space),
                      scene.finite_strain ? "finite strain: everything is where it is now"
                                          : "small strain: linear strains, contact geometry of the start");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto& mesh = model.bodies[b].mesh;
    text += fmt::format("  {}: {}, {}{}{}\n", scene.bodies[b].name, counted(mesh.node_count, "node"),
                        counted(mesh.element_count(), shape_name(mesh.shape)),
                        has_mean_dilatation(model.bodies[b].kinematics) ? " with mean dilatation" : "",
                        is_held_by_contact_alone(model, b) ? "; held by contact alone" : "");
  }
  text += contact_lines(problem);
  text += fmt::format("driving: {}, {}, {} to t = {}\n", count(scene.supports, "support"), count(scene.loads, "load"),
                      count(model.times, "step"), exact_number(model.times.empty() ? 0 : model.times.back()));
  if (scene.arc_length)
    text += fmt::format("  along the path by arc length: the factor of load {} is found, in at most {} steps of {}\n",
                        scene.arc_length->load, scene.arc_length->max, number(path_length(model, problem.slots), 3));
  const bool unknown = multipliers_of(input.method) == Multipliers::unknown;
  text += "unknowns: " + count(model.free_dofs, "displacement");
  text +=
      unknown ? ", " + counted(model.multiplier_count, "multiplier") + "\n" : ", no multipliers among the unknowns\n";
  text += "at its peak: " + about(needed_bytes(problem, input)) + ", within a factor of two\n";
  text += fmt::format("method: {}\n", json_with_exact_numbers(to_json(input.method)));
  text += engine_lines(input, problem);
  text += "\nwhat each effect takes (~ about, > and more, ? depends on the path):\n" +
          ledger_table(forecast(input, problem));
  text += "\nsimulated:\n";
  if (effects.contact) text += "  unilateral contact\n";
  if (effects.friction) text += "  friction, path dependent (slip is remembered)\n";
  if (scene.finite_strain) text += "  finite strain\n";
  if (effects.plasticity) text += "  plasticity, path dependent (plastic strains are remembered)\n";
  if (effects.current_geometry) text += "  large sliding\n";
  if (effects.normals_turn) text += "  normals that turn\n";
  if (effects.deformable_master) text += "  contact between deformable bodies\n";
  if (effects.smoothing) text += "  smooth masters\n";
  const bool adjoint = scene.sensitivity_mode == SensitivityMode::adjoint;
  if (effects.sensitivity)
    text += fmt::format("  derivatives of {} with respect to {}, {}\n",
                        adjoint ? count(scene.objectives, "objective") : count(scene.responses, "response"),
                        count(scene.parameters, "parameter"), adjoint ? "adjoint" : "direct");
  text += "left out (no unknowns, no storage, no code path):\n";
  if (!effects.contact) text += "  contact: no slave node faces a master\n";
  if (!effects.friction) text += "  friction: no contact has any\n";
  if (!effects.sensitivity) text += "  derivatives: the scene names no parameters\n";
  text += fmt::format("  {}{}{}inertia\n", scene.finite_strain ? "" : "large displacements and sliding, ",
                      effects.plasticity ? "" : "plasticity, ", effects.smoothing ? "" : "smoothing, ");
  for (const auto& warnings : {contact_warnings_before(problem), overlaps_at_start(problem)})
    for (const auto& warning : warnings)
      text += fmt::format("warning ({}): {}; {}\n", name_of(warning.code), warning.text, warning.remedy);
  return text;
}

}  // namespace stickslip
