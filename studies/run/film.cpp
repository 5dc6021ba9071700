#include "studies/run/film.hpp"

#include <nlohmann/json.hpp>
#include <string_view>

#include "studies/run/contact_points.hpp"

namespace stickslip {

nlohmann::json film_json(const CaseResult& result) {
  using nlohmann::json;
  constexpr std::size_t most = 48;
  const auto& model = result.problem->model;
  const auto steps = solved_steps(result);
  const std::size_t stride = (steps.size() + most - 1) / most;
  json times = json::array(), contacts = json::object();
  for (std::size_t n = 0; n < steps.size(); ++n) {
    if ((steps.size() - 1 - n) % stride != 0) continue;  // counted from the end: the last step is always there
    times.push_back(steps[n].increment->time);
    std::vector<std::string> states(model.scene.contacts.size());
    const auto& field = steps[n].increment->state.contact;
    for (std::size_t p = 0; p < model.points.size(); ++p) {
      const std::string_view name = state_name(model.points[p], field.state[p]);
      states[static_cast<std::size_t>(model.points[p].contact)] += name == "stick" ? 'k' : name.front();
    }
    for (std::size_t c = 0; c < states.size(); ++c) contacts[model.scene.contacts[c].name].push_back(states[c]);
  }
  return {{"times", times}, {"contacts", contacts}};
}

}  // namespace stickslip
