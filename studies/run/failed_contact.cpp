#include "studies/run/failed_contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "methods/stepping/free_bodies.hpp"
#include "studies/io/wording.hpp"
#include "studies/run/contact_start.hpp"
#include "studies/run/side_curve.hpp"
#include "studies/run/solution_warnings.hpp"
#include "studies/run/turned_surfaces.hpp"

namespace stickslip {
namespace {

/// Of open points alone.
std::string what_to_check_if_open(const FailedContact& contact) {
  if (contact.nearest > 0) {
    const std::string apart = std::isfinite(contact.nearest)
                                  ? fmt::format("the nearest starts {:.3g} from its master", contact.nearest)
                                  : "none faces a master at the start";
    return "all are open, and " + apart +
           ": nothing holds the body on its way; let it touch at the start, or move it by a support";
  }
  return "all are open: the load may pull the body off its master, or the master may be solid on the wrong side; "
         "check the sign of the load, the normal of a plane (it points out of the solid) and the order of a "
         "polyline's points (its solid is on their right), or the side of the mesh that is held rigid";
}

std::string what_to_check(const FailedContact& contact) {
  if (contact.turned || !contact.unheld) return "";
  if (contact.stick + contact.slip == 0) return what_to_check_if_open(contact);
  if (!contact.rough)
    return "no contact has friction, so nothing resists sliding; give one `friction`, or hold the body by a support";
  if (contact.stick < contact.slip)
    return "most of those that touch slip: the load may be more than friction bears; push less, raise `friction`, or "
           "prescribe the motion by a support; or it pulls the body off its master: check its sign";
  if (contact.unbalanced) return "the load may pull the body off its master; check its sign";
  return "";
}

/// Whether iterations were given up without a cause that is known.
bool is_without_cause(Status s) { return s == Status::cycle || s == Status::stagnated; }

/// Whether the step failed in a way that forces of contact may explain. (Others have messages that name the cause.)
bool may_be_contact(const Increment<double>& failed) {
  const Status s = failed.status;
  return !failed.solved() &&
         (s == Status::no_equilibrium || s == Status::singular || s == Status::cap || is_without_cause(s));
}

FailedContact failed_contact(const Problem& problem, const Increment<double>& failed) {
  const auto& model = problem.model;
  const auto& field = failed.state.contact;
  FailedContact contact;
  contact.rough = model.effects.friction;
  for (const auto state : field.state)
    ++(state == ContactState::open ? contact.open : is_slipping(state) ? contact.slip : contact.stick);
  const std::vector<ContactState> open(model.points.size(), ContactState::open);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    contact.unbalanced |=
        failed.status == Status::no_equilibrium && !free_motion(model, problem.slots, b, failed.state, open).empty();
    contact.unheld |= contact.unbalanced || is_held_by_contact_alone(model, b);
  }
  contact.nearest = std::numeric_limits<double>::infinity();
  for (const auto& gaps : start_gaps(problem)) contact.nearest = std::min(contact.nearest, gaps.least);
  return contact;
}

}  // namespace

std::string failed_contact_in_words(const FailedContact& contact) {
  const int all = contact.open + contact.stick + contact.slip;
  if (all == 0) return "";
  const std::string counts = contact.rough
                                 ? fmt::format("{} stick, {} slip, {} open", contact.stick, contact.slip, contact.open)
                                 : fmt::format("{} closed, {} open", contact.slip, contact.open);
  const std::string advice = what_to_check(contact);
  return fmt::format("{}: {}{}", counted(all, "contact point"), counts, advice.empty() ? "" : "; " + advice);
}

Advisable advisable(const Model& model) {
  Advisable scene{.contact = !model.points.empty()};
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) {
    const auto& contact = model.scene.contacts[c];
    const Obstacle* const obstacle = obstacle_of(model, static_cast<int>(c));
    const bool facets = !obstacle || has_facets(obstacle->shape);
    scene.other_side |= !obstacle && !contact.is_of_itself();
    scene.may_be_smooth |= facets && !contact.segment && contact.smoothing == Smoothing::none;
    const auto is_of_solid = [&](const ContactPoint& point) {
      return point.contact == static_cast<int>(c) && is_continuum(model.bodies[point.slave_body].mesh.shape);
    };
    scene.may_be_segments |= facets && !contact.segment && (model.dimension == 2 || !model.scene.finite_strain) &&
                             std::any_of(model.points.begin(), model.points.end(), is_of_solid);
  }
  return scene;
}

std::string advice_in_words(const Advisable& scene) {
  std::vector<std::string> ways = {"more steps"};
  if (scene.contact) ways.emplace_back("a smaller stiffness or scale");
  if (scene.other_side) ways.emplace_back("the other side as the slave");
  if (scene.may_be_smooth) ways.emplace_back("a smooth master");
  if (scene.may_be_segments) ways.emplace_back("segments");
  const std::string last = ways.back();
  ways.pop_back();
  return "try " + (ways.empty() ? last : fmt::format("{}, or {}", fmt::join(ways, ", "), last));
}

void explain_failed_contact(const Problem& problem, Trajectory<double>& trajectory) {
  if (is_converged(trajectory.status)) return;
  std::vector<std::string> sentences;
  if (is_without_cause(trajectory.status)) sentences.push_back(advice_in_words(advisable(problem.model)));
  bool turned = false;
  for (std::size_t c = 0; c < problem.model.scene.contacts.size(); ++c)
    if (const auto warning = turned_surface(problem, static_cast<int>(c))) {
      turned = true;
      sentences.push_back(warning->text + "; " + warning->remedy);
    }
  if (!trajectory.increments.empty() && may_be_contact(trajectory.increments.back()) && !loose_body(problem.model)) {
    FailedContact contact = failed_contact(problem, trajectory.increments.back());
    contact.turned = turned;
    sentences.insert(sentences.begin(), failed_contact_in_words(contact));
  }
  for (const auto& sentence : sentences)
    if (!sentence.empty()) trajectory.message += (trajectory.message.empty() ? "" : "; ") + sentence;
}

}  // namespace stickslip
