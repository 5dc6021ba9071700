#include "studies/warnings.hpp"

#include <fmt/core.h>

#include <cmath>

#include "studies/strains.hpp"

namespace stickslip {
namespace {

constexpr double degree = M_PI / 180;

struct Deformation {
  double strain = 0, rotation = 0;  ///< largest component; radians
};

/// Largest strain and rotation in the elements of a body.
Deformation deformation_of(const Problem& problem, const Vector<double>& displacement, std::size_t b) {
  Deformation largest;
  for_each_strain(problem, displacement, b, [&](int, const auto& H, double) {
    largest.strain = std::max(largest.strain, (H + H.transpose()).cwiseAbs().maxCoeff() / 2);
    largest.rotation = std::max(largest.rotation, std::abs(H(1, 0) - H(0, 1)) / 2);
  });
  return largest;
}

void add_deformations(const CaseResult& result, std::vector<std::string>& warnings) {
  constexpr double most_strain = 0.05, most_rotation = 5 * degree;
  const auto& model = result.problem->model;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    Deformation largest;
    for (const auto& step : result.steps) {
      const auto now = deformation_of(*result.problem, step.increment->state.displacement, b);
      largest = {std::max(largest.strain, now.strain), std::max(largest.rotation, now.rotation)};
    }
    const std::string& name = model.scene.bodies[b].name;
    if (largest.strain > most_strain)
      warnings.push_back(fmt::format("{} is strained by up to {:.2g} %; small strain holds below some 5 %", name,
                                     100 * largest.strain));
    if (largest.rotation > most_rotation)
      warnings.push_back(fmt::format("{} rotates by up to {:.2g} degrees; small strain holds below some 5", name,
                                     largest.rotation / degree));
  }
}

/// Whether sliding along it changes the geometry of the contact.
bool is_flat(const Model& model, const ContactPoint& point) {
  return point.obstacle >= 0 && std::holds_alternative<Plane>(model.scene.obstacles[point.obstacle].shape);
}

void add_slips(const CaseResult& result, std::vector<std::string>& warnings) {
  constexpr double most = 0.5;  // of a slave element
  const auto& model = result.problem->model;
  const auto& contacts = model.scene.contacts;
  std::vector<double> farthest(contacts.size(), 0);
  std::vector<char> closed(contacts.size(), 0), slipped(contacts.size(), 0);
  for (const auto& step : result.steps) {
    const auto& field = step.increment->state.contact;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const auto& point = model.points[p];
      if (field.state[p] == ContactState::open) continue;
      closed[point.contact] = 1;
      if (point.tangents == 0) continue;
      if (field.state[p] == ContactState::slip) slipped[point.contact] = 1;
      const auto placement =
          field.placement.segment(tangential_offset(model, static_cast<int>(p)), point.tangents).norm();
      if (point.mesh_size > 0 && !is_flat(model, point))
        farthest[point.contact] = std::max(farthest[point.contact], placement / point.mesh_size);
    }
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (farthest[c] > most)
      warnings.push_back(
          fmt::format("{}: a point slides by {:.2g} elements of the slave; the contact geometry is that of "
                      "the start, which holds below some half of one",
                      contacts[c].name, farthest[c]));
    if (contacts[c].friction && result.problem->slots.friction[c] > 0 && closed[c] && !slipped[c])
      warnings.push_back(
          fmt::format("{}: no point slipped in any step, so that the friction coefficient of {:.6g} has no "
                      "influence",
                      contacts[c].name, result.problem->slots.friction[c]));
  }
}

void add_cut_steps(const CaseResult& result, std::vector<std::string>& warnings) {
  if (!result.problem->model.effects.friction) return;
  const auto cut = std::count_if(result.steps.begin(), result.steps.end(),
                                 [](const StepResult& step) { return step.increment->cutbacks > 0; });
  if (cut > 0)
    warnings.push_back(
        fmt::format("{} of {} steps were cut into smaller ones: friction depends on the path, and this is another "
                    "one than whole steps would take",
                    cut, result.steps.size()));
}

}  // namespace

std::vector<std::string> warnings_of(const CaseResult& result) {
  std::vector<std::string> warnings;
  if (!is_converged(result.trajectory.status)) return warnings;
  add_deformations(result, warnings);
  add_slips(result, warnings);
  add_cut_steps(result, warnings);
  return warnings;
}

}  // namespace stickslip
