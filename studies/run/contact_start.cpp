#include "studies/run/contact_start.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/model/state.hpp"
#include "core/model/stencil.hpp"
#include "methods/stepping/free_bodies.hpp"
#include "studies/run/contact_points.hpp"
#include "studies/run/facing_sides.hpp"
#include "studies/run/side_curve.hpp"

namespace stickslip {
namespace {

/// Share of a slave facet, or of the motion, up to which a gap is rounding. An overlap of it strains the elements by
/// about as much, and a file with seven digits moves its nodes as far.
constexpr double rounding = 1e-6;

void add(StartGaps& all, const StartGaps& more) {
  all.least = std::min(all.least, more.least);
  all.largest = std::max(all.largest, more.largest);
  all.points += more.points;
  all.overlapping += more.overlapping;
  all.unasked += more.unasked;
  all.overlap = std::max(all.overlap, more.overlap);
}

/// Name under which a contact is taken together with others.
const std::string& rule_of(const Contact& contact) { return contact.group.empty() ? contact.name : contact.group; }

/// Length up to which a gap or an overlap of a point is rounding. `motion`: size of the motion of contact, length.
double negligible_gap(const ContactPoint& point, double motion) {
  return std::max(point.tie_length, rounding * std::max(point.mesh_size, motion));
}

/// Of one point.
StartGaps start_gap(const Problem& problem, std::size_t p) {
  const auto& point = problem.model.points[p];
  const double nothing = negligible_gap(point, 0), measured = problem.slots.geometry[p].gap;
  const double gap = std::abs(measured) <= nothing ? 0 : measured;
  const double asked = std::max(0.0, -problem.slots.numbers(problem.model.scene.contacts[point.contact].offset));
  const double unasked = -gap - asked;
  const bool is_unasked = unasked > nothing;
  return {"", gap, gap, 1, gap < 0, is_unasked, is_unasked ? unasked : 0};
}

/// Least gap over all steps, length, of each contact or rule none of whose points ever closes or touches, by name;
/// infinite where none ever faces the master.
std::map<std::string, double> least_gaps_of_open_rules(const CaseResult& result) {
  const auto& model = result.problem->model;
  std::map<std::string, double> least;
  for (const auto& contact : model.scene.contacts) least[rule_of(contact)] = std::numeric_limits<double>::infinity();
  for (const auto& step : result.steps) {
    const auto& field = step.increment->state.contact;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& point = model.points[p];
      const auto found = least.find(rule_of(model.scene.contacts[point.contact]));
      if (found == least.end()) continue;
      const double gap = field.gap[static_cast<Eigen::Index>(p)];
      const bool faces = faces_master(point, facing_in(model, field, p));
      // (a point that touches without force may count as open)
      if (field.state[p] != ContactState::open || (faces && gap <= negligible_gap(point, result.scales.length)))
        least.erase(found);
      else if (faces)
        found->second = std::min(found->second, gap);
    }
  }
  return least;
}

/// What to do where no point of a contact, or of a rule, ever faces its master.
std::string sides_to_take(const Problem& problem, const std::string& name) {
  const auto& contacts = problem.model.scene.contacts;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (contacts[c].name != name) continue;
    const auto sides = facing_sides(problem, static_cast<int>(c));
    if (!sides || *sides == std::pair{contacts[c].slave, contacts[c].master}) continue;
    return fmt::format("take {} as the slave and {} as the master, which face each other", sides->first, sides->second);
  }
  return "take the sides that face one another as slave and master: the far side of a body faces nothing, nor does one "
         "that is inside of the other body";
}

/// What to do where points face their master and never touch it. `gap`: the least one, length.
std::string ways_to_close(const Problem& problem, const std::string& name, double gap) {
  constexpr double far = 10;  // sizes of the body: nothing moves as far
  const auto& contacts = problem.model.scene.contacts;
  const auto contact =
      std::find_if(contacts.begin(), contacts.end(), [&](const auto& c) { return rule_of(c) == name; });
  const auto& body = problem.model.bodies[problem.model.contact_sides[contact - contacts.begin()].slave.body];
  const auto points = problem.slots.points.middleCols(body.first_node, body.mesh.node_count);
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  if (size > 0 && gap > far * size)
    return fmt::format("this is {:.2g} times the size of the slave's body: give all lengths in one unit", gap / size);
  return "look at the gap at the start, the direction of loads and motions, and the side on which the master is solid";
}

}  // namespace

std::string StartGaps::in_words() const {
  if (points == 0) return "no point faces the master";
  return fmt::format("least {:.3g}, largest {:.3g}, {} of {} points overlap", least, largest, overlapping, points);
}

std::vector<StartGaps> start_gaps(const Problem& problem) {
  const auto& model = problem.model;
  std::vector<StartGaps> gaps(model.scene.contacts.size());
  for (std::size_t c = 0; c < gaps.size(); ++c) gaps[c].name = model.scene.contacts[c].name;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (faces_master(point, point.facing)) add(gaps[point.contact], start_gap(problem, p));
  }
  return gaps;
}

std::vector<StartGaps> start_gaps_of_rules(const Problem& problem) {
  std::vector<StartGaps> rules;
  const auto contacts = start_gaps(problem);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const std::string& name = rule_of(problem.model.scene.contacts[c]);
    if (rules.empty() || rules.back().name != name) rules.push_back({name});  // (pairs of a rule are neighbours)
    add(rules.back(), contacts[c]);
  }
  return rules;
}

std::vector<Warning> overlaps_at_start(const Problem& problem) {
  std::vector<Warning> warnings;
  for (const auto& gaps : start_gaps(problem)) {
    if (gaps.unasked == 0) continue;
    const auto& contacts = problem.model.scene.contacts;
    const auto contact =
        std::find_if(contacts.begin(), contacts.end(), [&](const Contact& one) { return one.name == gaps.name; });
    const bool rigid = obstacle_of(problem.model, static_cast<int>(contact - contacts.begin())) != nullptr;
    warnings.push_back(
        {WarningCode::starts_overlapping, gaps.name, gaps.overlap,
         fmt::format(
             "move the bodies apart; {}; refine curved sides, whose facets leave the curve; if an interference is "
             "meant, let the sides touch and give it as a negative `offset`",
             rigid ? "turn the master round if it is solid on the wrong side"
                   : "take other sides if a body is meant to be inside of the other"),
         fmt::format("{}: {} of {} points overlap at the start by up to {:.3g}, which no `offset` asks for, and the "
                     "first step pushes them apart",
                     gaps.name, gaps.unasked, gaps.points, gaps.overlap)});
  }
  return warnings;
}

std::vector<Warning> contacts_never_closed(const CaseResult& result) {
  if (!is_converged(result.trajectory.status) || result.steps.empty()) return {};
  std::vector<Warning> warnings;
  for (const auto& [name, gap] : least_gaps_of_open_rules(result)) {
    const std::string nearest =
        std::isfinite(gap) ? fmt::format("the nearest is {:.3g} away at the least", gap) : "none ever faces the master";
    warnings.push_back(
        {WarningCode::never_closes, name, gap,
         std::isfinite(gap) ? ways_to_close(*result.problem, name, gap) : sides_to_take(*result.problem, name),
         fmt::format("{}: no point closes in any of {} steps; {}", name, result.steps.size(), nearest)});
  }
  return warnings;
}

bool is_held_by_contact_alone(const Model& model, std::size_t b) {
  if (!is_continuum(model.bodies[b].mesh.shape)) return false;
  return std::none_of(model.constraints.begin(), model.constraints.end(),
                      [&, body = nodes_of_body(model, b)](const Constraint& held) {
                        return held.support >= 0 && body.has(held.dof / model.dimension);
                      });
}

}  // namespace stickslip
