// A spring pushed against a stop: the contact force by the monolithic augmented Lagrangian, and its derivative.
#include <cmath>
#include <cstdio>

#include "core/model/response.hpp"
#include "sensitivity/differentiate.hpp"

int main() {
  using namespace stickslip;
  Scene scene;
  const Number F(15, 0);  // a value and its slot: what has a slot has derivatives
  scene.numbers = {15};
  scene.parameters = {{"F", {{0, 1.0}}, "/F", 15}};
  scene.bodies = {{"mass", PointMesh{{0.0, 0.0}}, GroundedSpring{{{1000.0, 0.0}, {0.0, 1000.0}}}}};
  scene.obstacles = {{"wall", Plane{{0.01, 0.0}, {-1.0, 0.0}}}};
  scene.contacts = {{"stop", "mass.node", "wall"}};
  scene.loads = {{"mass.node", Load::Kind::force, {F, 0.0}}};
  scene.legs = {{1, 1}};
  scene.responses = {{"press", Response::Kind::contact_force, "stop", Response::Component::normal}};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Workspace<double> workspace;
  const auto trajectory = solve(model, slots, MonolithicAL{}, {}, workspace);
  const auto gradients = differentiate(model, slots, MonolithicAL{}, trajectory, workspace);
  const auto& last = trajectory.increments.back();
  const double press = evaluate_responses(model, slots, last.state, last.time)[0],
               slope = gradients.of_responses.back()(0, 0);
  std::printf("press = %g, d press / dF = %g\n", press, slope);
  // exact: F - k g0 = 5, and 1; a few roundings of the load of 15
  return std::abs(press - 5) < 1e-13 && std::abs(slope - 1) < 1e-13 ? 0 : 1;
}
