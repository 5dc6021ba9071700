#include "tests/support/solved.hpp"

#include <stdexcept>

#include "core/model/response.hpp"

namespace stickslip::scenes {

double Solved::value(const std::string& name, int n) const {
  const auto& increment = trajectory.increments.at(index(n));
  return evaluate_responses(model, slots, increment.state, increment.time)[response(name)];
}

double Solved::derivative(const std::string& name, const std::string& of, int n) const {
  for (std::size_t j = 0; j < model.scene.parameters.size(); ++j)
    if (model.scene.parameters[j].name == of) return gradients.of_responses.at(index(n))(response(name), j);
  throw std::out_of_range(of);
}

int Solved::response(const std::string& name) const {
  for (std::size_t i = 0; i < model.scene.responses.size(); ++i)
    if (model.scene.responses[i].name == name) return static_cast<int>(i);
  throw std::out_of_range(name);
}

std::size_t Solved::index(int n) const { return n < 0 ? trajectory.increments.size() + n : n; }

Solved run(const Scene& scene, const Method& method, const RunOptions& options) {
  Solved out{make_model(scene), {}, {}, {}, 0};
  out.slots = make_slots<double>(out.model, scene.as<double>());
  Workspace<double> workspace;
  out.trajectory = solve(out.model, out.slots, method, options, workspace);
  out.condition = workspace.engine->condition_estimate();
  out.gradients = differentiate(out.model, out.slots, method, out.trajectory, workspace);
  return out;
}

Regularisation relative(double multiple) { return {Regularisation::Kind::relative, multiple}; }

Regularisation absolute(double value) { return {Regularisation::Kind::absolute, value}; }

}  // namespace stickslip::scenes
