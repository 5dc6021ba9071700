// One spring against a stop, by the monolithic augmented Lagrangian, with the derivative of the contact force.
#include <cmath>
#include <cstdio>

#include "core/model/response.hpp"
#include "sensitivity/differentiate.hpp"

int main() {
  using namespace stickslip;
  Scene scene;
  scene.legs = {{1, 1}};
  scene.numbers = {15};  // one number with a slot: the load
  scene.parameters = {{"F", {{0, 1.0}}, "/F", 15}};
  scene.bodies = {{"block", PointMesh{{0.0, 0.0}}, GroundedSpring{{{1000.0, 0.0}, {0.0, 1000.0}}}, "", 1.0}};
  scene.obstacles = {{"stop", Plane{{0.0, 0.01}, {0.0, -1.0}}, {}}};
  scene.contacts = {{"touch", "block.node", "stop", {}, 0.0}};
  scene.loads = {{"block.node", Load::Kind::force, {0.0, Number(15, 0)}, {}}};
  scene.responses = {{"press", Response::Kind::contact_force, "touch", "normal", Response::Take::mean, {}}};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, MonolithicAL{}, {}, workspace);
  const auto gradients = differentiate(model, slots, MonolithicAL{}, trajectory, workspace);
  const auto& last = trajectory.increments.back();
  const double press = evaluate_responses(model, slots, last.state, last.time)[0];
  std::printf("press = %g, d press / dF = %g\n", press, gradients.of.back()(0, 0));
  // exact values 5 and 1; a few roundings of the load of 15
  return std::abs(press - 5) < 1e-13 && std::abs(gradients.of.back()(0, 0) - 1) < 1e-13 ? 0 : 1;
}
