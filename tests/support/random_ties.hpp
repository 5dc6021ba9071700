/// Random small scenes whose points meet changes of state exactly, and differences of the solver to either side of a
/// parameter.
#pragma once

#include <optional>
#include <random>

#include "core/model/response.hpp"
#include "tests/support/kinks.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::random_ties {

using namespace scenes;

/// Small whole numbers and simple fractions, so that ties are met exactly, as far as rounding lets them.
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  double of(std::vector<double> values) { return values[below(static_cast<int>(values.size()))]; }

 private:
  std::mt19937_64 engine_;
};

inline Table path(Draw& draw, int legs) {
  Table t{{{0, 0.0}}};
  for (int k = 1; k <= legs; ++k)
    t.points.emplace_back(static_cast<double>(k), draw.of({-1, -0.5, 0, 0.5, 0.75, 1, 1, 1.5}));
  return t;
}

/// One to three points on springs, over floors and beside walls.
inline Scene points(Draw& draw) {
  Scene s;
  const int legs = 1 + draw.below(3);
  s.legs = {{static_cast<double>(legs), legs * (1 + draw.below(2))}};
  const Number mu = parameter(s, "mu", draw.of({0.25, 0.5, 1})), k = parameter(s, "k", draw.of({2, 4})),
               push = parameter(s, "push", draw.of({0.5, 1, 2})), press = parameter(s, "press", draw.of({-2, -1, 1})),
               floor = parameter(s, "floor", draw.of({0, 0, -0.25, -0.5, 0.25})),
               wall = parameter(s, "wall", draw.of({0.25, 0.5}));
  s.obstacles = {{"floor", Plane{{0.0, floor}, {0.0, 1.0}}, {}}, {"wall", Plane{{wall, 0.0}, {-1.0, 0.0}}, {}}};
  const int count = 1 + draw.below(3);
  for (int b = 0; b < count; ++b) {
    const std::string name = "p" + std::to_string(b);
    const Number coupling = draw.of({0, 0, 0.5, -0.5});
    s.bodies.push_back({name, PointMesh{{0.0, 0.0}}, GroundedSpring{{{k, coupling}, {coupling, k}}}, "", 1.0});
    s.contacts.push_back(contact("on floor " + name, name + ".node", "floor"));
    // (a point that a wall and friction hold at once has forces that equilibrium does not determine)
    if (draw.below(3) > 0)
      s.contacts.back().friction = mu;
    else
      s.contacts.push_back(contact("on wall " + name, name + ".node", "wall"));
    s.loads.push_back(force(name + ".node", {push, 0.0}));
    s.loads.back().history = path(draw, legs);
    s.loads.push_back(force(name + ".node", {0.0, press}));
    if (draw.below(2)) s.loads.back().history = path(draw, legs);
    s.responses.push_back(response("x " + name, Response::Kind::displacement, name + ".node", "x"));
    s.responses.push_back(response("y " + name, Response::Kind::displacement, name + ".node", "y"));
    s.responses.push_back(response("f " + name, Response::Kind::contact_force, "on floor " + name, "x"));
  }
  return s;
}

inline Scene point_in_space(Draw& draw) {
  Scene s;
  s.space = Space::solid;
  const int legs = 1 + draw.below(3);
  s.legs = {{static_cast<double>(legs), legs * (1 + draw.below(2))}};
  const Number mu = parameter(s, "mu", draw.of({0.25, 0.5, 1})), k = parameter(s, "k", draw.of({2, 4})),
               x = parameter(s, "x", draw.of({0.6, 0.3, 1})), y = parameter(s, "y", draw.of({0, 0.4, 0.8, -0.8})),
               press = parameter(s, "press", draw.of({-2, -1, 1})),
               floor = parameter(s, "floor", draw.of({0, 0, -0.25}));
  s.bodies = {
      {"p", PointMesh{{0.0, 0.0, 0.0}}, GroundedSpring{{{k, 0.0, 0.0}, {0.0, k, 0.0}, {0.0, 0.0, k}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0, floor}, {0.0, 0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "p.node", "floor")};
  s.contacts[0].friction = mu;
  s.loads = {force("p.node", {x, y, 0.0}), force("p.node", {0.0, 0.0, press})};
  s.loads[0].history = path(draw, legs);
  if (draw.below(2)) s.loads[1].history = path(draw, legs);
  for (const char* axis : {"x", "y", "z"})
    s.responses.push_back(response(axis, Response::Kind::displacement, "p.node", axis));
  s.responses.push_back(response("f", Response::Kind::contact_force, "sole", "x"));
  return s;
}

inline Scene bar(Draw& draw) {
  std::vector<double> factors{0};
  for (int k = 1 + draw.below(3); k > 0; --k) factors.push_back(draw.of({-1, -0.5, 0, 0.25, 0.5, 0.75, 1, 1}));
  return pull_out(std::vector<int>{2, 3, 5, 10}[draw.below(4)], factors, 1 + draw.below(4));
}

/// A block that a stamp brings down onto a floor, just so far that it touches, or further, and then drags.
inline Scene random_block(Draw& draw) {
  Scene s;
  s.legs = {{2, 2}};
  const Number mu = parameter(s, "mu", draw.of({0.2, 0.5})), E = parameter(s, "E", 100),
               down = parameter(s, "down", draw.of({-0.125, -0.25})),
               drag = parameter(s, "drag", draw.of({0, 0.0625, 0.25})), height = parameter(s, "height", 1);
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {2.0, height};
  box.cells = {1 + draw.below(3), 1 + draw.below(2)};
  s.bodies = {{"block", box, LinearElastic{E, draw.of({0, 0.3})}, "Q4", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, draw.of({0, -0.125, -0.25})}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  if (draw.below(3)) s.contacts[0].friction = mu;
  s.supports = {
      support("block.top", {{'x', table({{0, 0.0}, {1, 0.0}, {2, drag}})}, {'y', table({{0, 0.0}, {1, down}})}})};
  s.responses = {response("press", Response::Kind::contact_force, "sole", "normal"),
                 response("shear", Response::Kind::contact_force, "sole", "x"),
                 response("low", Response::Kind::displacement, "block.bottom", "y", Response::Take::min),
                 response("pull", Response::Kind::reaction, "block.top", "x")};
  return s;
}

/// Two blocks whose nodes face one another; one of them moves along.
inline Scene matching(Draw& draw) {
  const int cells = 1 + draw.below(3);
  Scene s;
  s.legs = {{2, 2}};
  const Number mu = parameter(s, "mu", 0.3), shift = parameter(s, "shift", 0), down = parameter(s, "down", -0.0625),
               height = parameter(s, "height", 2);
  BoxMesh upper, lower;
  upper.min = {shift, 1.0};
  upper.max = {1.0, height};
  upper.cells = {cells, 1};
  lower.min = {-1.0, 0.0};
  lower.max = {2.0, 1.0};
  lower.cells = {3 * cells, 1};
  s.numbers.push_back(1.0);
  s.pointers.push_back("/end");
  upper.max[0] = Number(1.0, static_cast<int>(s.numbers.size()) - 1);
  s.parameters[1].slots.emplace_back(upper.max[0].slot, 1.0);
  s.bodies = {{"upper", upper, LinearElastic{100.0, 0.3}, "Q4", 1.0},
              {"lower", lower, LinearElastic{50.0, 0.2}, "Q4", 1.0}};
  s.contacts = {contact("touch", "upper.bottom", "lower.top")};
  if (draw.below(3)) s.contacts[0].friction = mu;
  s.contacts[0].segment = draw.below(2);
  s.supports = {support("lower.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                support("upper.top", {{'x', table({{0, 0.0}, {1, 0.0}, {2, draw.of({0, 0.03125})}})},
                                      {'y', table({{0, 0.0}, {1, down}})}})};
  s.responses = {response("press", Response::Kind::contact_force, "touch", "normal"),
                 response("shear", Response::Kind::contact_force, "touch", "x"),
                 response("pull", Response::Kind::reaction, "upper.top", "x"),
                 response("sink", Response::Kind::displacement, "lower.top", "y", Response::Take::min)};
  return s;
}

/// Responses x increments of a run that repeats the steps; empty where it fails.
inline Matrix<double> responses(const Scene& scene, const Method& method, const std::vector<double>& table) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  RunOptions options;
  options.replay = table;
  const auto trajectory = solve(model, slots, method, options);
  Matrix<double> out(scene.responses.size(), table.size());
  if (trajectory.increments.size() != table.size()) return {};
  for (std::size_t n = 0; n < table.size(); ++n) {
    if (!trajectory.increments[n].usable()) return {};
    out.col(n) = evaluate_responses(model, slots, trajectory.increments[n].state, trajectory.increments[n].time);
  }
  return out;
}

/// Up to which differences tell a derivative: h^2 of the third derivative at h = 1e-4, and 1e-12 / h of the solver's
/// noise.
inline constexpr double agreement = 1e-5;

/// One-sided differences at h, h/2, h/4 without their first error term, twice; nothing where these two disagree
/// (another kink is near, or it is a jump). h: over the size of the parameter.
struct Differences {
  Matrix<double> value;
  Matrix<double> spread;
};
inline std::optional<Differences> differences(const Scene& scene, const Method& method,
                                              const std::vector<double>& table, int j, double side,
                                              const Matrix<double>& base, double h = 1e-4) {
  Matrix<double> slope[3];
  for (int k = 0; k < 3; ++k) {
    const double step = side * h / (1 << k) * kinks::size_of(scene.parameters[j]);
    const auto there = responses(kinks::moved(scene, j, step), method, table);
    if (there.size() == 0) return std::nullopt;
    slope[k] = (there - base) / step;
  }
  const Matrix<double> far = 2 * slope[1] - slope[0], near = 2 * slope[2] - slope[1];
  return Differences{near, (near - far).cwiseAbs()};
}

/// What a response that is zero is the difference of, and the solver leaves rounding of, about 1e-12 of it (1e-7 over
/// h): the largest response; of a force also the stiffness times the displacements, since a stamp that presses nothing
/// has moved its body all the same.
inline double size_of_terms(Response::Kind kind, const Matrix<double>& base, const Trajectory<double>& trajectory,
                            double stiffest) {
  const double largest = largest_entry(base);
  if (kind != Response::Kind::reaction && kind != Response::Kind::contact_force) return largest;
  double motion = 0;
  for (const auto& increment : trajectory.increments)
    motion = larger(motion, largest_entry(increment.state.displacement));
  return larger(largest, stiffest * motion);
}

inline Method any_method(Draw& draw) {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-13;
  uzawa.max_augmentations = 5000;
  if (draw.below(2)) uzawa.sensitivity = UzawaAL::Sensitivity::preconditioned;
  const int which = draw.below(4);
  if (which == 0) return Penalty{relative(draw.of({1, 100}))};
  if (which == 1) return uzawa;
  return MonolithicAL{};
}

/// One of five kinds of scenes.
inline Scene any_scene(Draw& draw, int& kind) {
  kind = draw.below(5);
  if (kind == 0) return points(draw);
  if (kind == 1) return point_in_space(draw);
  if (kind == 2) return bar(draw);
  return kind == 3 ? random_block(draw) : matching(draw);
}

/// A number of the environment, or another.
inline unsigned asked(const char* name, unsigned otherwise) {
  const char* text = std::getenv(name);
  return text ? static_cast<unsigned>(std::atoi(text)) : otherwise;
}

}  // namespace stickslip::random_ties
