#include "tests/support/scenes.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::scenes {

Number parameter(Scene& scene, const std::string& name, double value) {
  scene.numbers.push_back(value);
  scene.pointers.push_back("/" + name);
  const int slot = static_cast<int>(scene.numbers.size()) - 1;
  scene.parameters.push_back({name, {{slot, 1.0}}, "/" + name, value});
  return {value, slot};
}

Response response(const std::string& name, Response::Kind kind, const std::string& on, const std::string& component,
                  Response::Take take) {
  Response r;
  r.name = name;
  r.kind = kind;
  r.on = on;
  const std::vector<std::string> words{"", "x", "y", "z", "normal", "moment"};
  r.component = static_cast<Response::Component>(std::find(words.begin(), words.end(), component) - words.begin());
  r.take = take;
  return r;
}

Table table(std::vector<std::pair<double, Number>> points) { return {std::move(points)}; }

Load force(const std::string& on, std::vector<Number> vector) { return {on, Load::Kind::force, std::move(vector), {}}; }

Load traction(const std::string& on, std::vector<Number> vector) {
  return {on, Load::Kind::traction, std::move(vector), {}};
}

Support support(const std::string& on, std::map<char, Table> move) { return {on, std::move(move)}; }

Contact contact(const std::string& name, const std::string& slave, const std::string& master) {
  Contact c;
  c.name = name;
  c.slave = slave;
  c.master = master;
  return c;
}

RingMesh quarter_ring(int n) {
  RingMesh ring;
  ring.center = {0.0, 0.0};
  ring.inner = 1.0;
  ring.outer = 2.0;
  ring.to_angle = 90.0;
  ring.cells = {n, 2 * n};
  return ring;
}

Scene stop(double F, double k, double g0) {
  Scene s;
  s.legs = {{1, 1}};
  const Number f = parameter(s, "F", F), stiffness = parameter(s, "k", k), gap = parameter(s, "g0", g0);
  s.bodies = {{"block", PointMesh{{0.0, 0.0}}, GroundedSpring{{{k, 0.0}, {0.0, stiffness}}}, "", 1.0}};
  s.obstacles = {{"stop", Plane{{0.0, gap}, {0.0, -1.0}}, {}}};
  s.contacts = {contact("touch", "block.node", "stop")};
  s.loads = {force("block.node", {0.0, f})};
  s.responses = {response("u", Response::Kind::displacement, "block.node", "y"),
                 response("press", Response::Kind::contact_force, "touch", "normal")};
  return s;
}

Scene slider(const std::vector<std::pair<double, double>>& drive, int steps, double k, double mu, double N) {
  Scene s;
  s.legs = {{drive.back().first, steps}};
  const Number friction = parameter(s, "mu", mu), load = parameter(s, "N", -N), spring = parameter(s, "k", k);
  s.parameters[1].slots[0].second = -1;
  s.bodies = {{"block", PointMesh{{0.0, 0.0}}, GroundedSpring{{{spring, 0.0}, {0.0, k}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "block.node", "floor")};
  s.contacts[0].friction = friction;
  s.loads = {force("block.node", {0.0, load})};
  Table motion;
  Parameter amplitude{"U0", {}, "/U0", 0};
  for (const auto& [t, U] : drive) {
    s.numbers.push_back(U);
    s.pointers.push_back("/U" + std::to_string(motion.points.size()));
    const int slot = static_cast<int>(s.numbers.size()) - 1;
    motion.points.emplace_back(t, Number(U, slot));
    if (U != 0) {
      if (amplitude.value == 0) amplitude.value = U;
      amplitude.slots.emplace_back(slot, U / amplitude.value);
    }
  }
  s.parameters.push_back(amplitude);
  s.supports = {support("block.anchor", {{'x', motion}})};
  s.responses = {response("u", Response::Kind::displacement, "block.node", "x"),
                 response("heat", Response::Kind::dissipation, "sole"),
                 response("pull", Response::Kind::reaction, "block.anchor", "x"),
                 response("press", Response::Kind::contact_force, "sole", "normal")};
  return s;
}

Scene dragged_point(const std::vector<std::array<double, 3>>& path, int steps, double c) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{path.back()[0], steps}};
  const double k = 10;
  const Number mu = parameter(s, "mu", 0.1 * c);  // N = 100
  const Number spring = parameter(s, "k", k);
  s.bodies = {{"point", PointMesh{{0.0, 0.0, 0.0}},
               GroundedSpring{{{spring, 0.0, 0.0}, {0.0, spring, 0.0}, {0.0, 0.0, spring}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "point.node", "floor")};
  s.contacts[0].friction = mu;
  s.loads = {force("point.node", {0.0, 0.0, -100.0})};
  Table x, y;
  for (const auto& [t, px, py] : path) {
    x.points.emplace_back(t, px);
    y.points.emplace_back(t, py);
  }
  s.supports = {support("point.anchor", {{'x', x}, {'y', y}})};
  s.responses = {response("x", Response::Kind::displacement, "point.node", "x"),
                 response("y", Response::Kind::displacement, "point.node", "y"),
                 response("heat", Response::Kind::dissipation, "sole")};
  return s;
}

Scene greco_plate(int n, double mu) {
  Scene s;
  s.legs = {{1, 1}};
  const Number friction = parameter(s, "mu", mu), E = parameter(s, "E", 1.3e11), F = parameter(s, "F", 15e7),
               height = parameter(s, "height", 0.04);
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {0.04, height};
  box.cells = {n, n};
  s.bodies = {{"plate", box, LinearElastic{E, 0.2}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "plate.bottom - plate.right", "floor")};
  s.contacts[0].friction = friction;
  s.loads = {traction("plate.left", {F, 0.0}), traction("plate.top", {0.0, -5e7})};
  s.supports = {support("plate.right", {{'x', table({{0, 0.0}})}}),
                support("plate.right & plate.bottom", {{'y', table({{0, 0.0}})}})};
  const double at[] = {0, 1.25e-3, 5e-3, 7.5e-3, 11.25e-3};
  for (int i = 0; i < 5; ++i) {
    s.responses.push_back(response("u" + std::to_string(i), Response::Kind::displacement, "", "x"));
    s.responses.back().at = {at[i], 0.0};
  }
  s.responses.push_back(response("friction", Response::Kind::contact_force, "sole", "x"));
  s.responses.push_back(response("heat", Response::Kind::dissipation, "sole"));
  s.responses.push_back(response("reaction", Response::Kind::reaction, "plate.right", "x"));
  return s;
}

Scene two_boxes(int slave, int master, const std::string& element, double mu) {
  Scene s;
  s.legs = {{3, 12}};
  const Number friction = parameter(s, "mu", mu), E = parameter(s, "E", 1000), down = parameter(s, "down", -0.01),
               height = parameter(s, "height", 2.0), offset = parameter(s, "offset", 1e-4);
  BoxMesh upper, lower;
  upper.min = {0.2, 1.0};
  upper.max = {1.8, height};
  upper.cells = {slave, 3};
  lower.min = {0.0, 0.0};
  lower.max = {2.0, 1.0};
  lower.cells = {master, 4};
  s.bodies = {{"upper", upper, LinearElastic{E, 0.3}, element, 1.0},
              {"lower", lower, LinearElastic{1500.0, 0.2}, element, 1.0}};
  s.contacts = {contact("touch", "upper.bottom", "lower.top")};
  s.contacts[0].friction = friction;
  s.contacts[0].offset = offset;
  s.supports = {support("lower.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                support("upper.top", {{'x', table({{0, 0.0}, {1, 0.0}, {2, 0.008}, {3, -0.004}})},
                                      {'y', table({{0, 0.0}, {1, down}})}})};
  s.responses = {response("press", Response::Kind::contact_force, "touch", "normal"),
                 response("shear", Response::Kind::contact_force, "touch", "x"),
                 response("peak", Response::Kind::contact_pressure, "touch", "", Response::Take::max),
                 response("width", Response::Kind::contact_half_width, "touch"),
                 response("heat", Response::Kind::dissipation, "touch"),
                 response("energy", Response::Kind::strain_energy, ""),
                 response("pull", Response::Kind::reaction, "upper.top", "x")};
  return s;
}

Scene punched_metal(int cells, double mu, bool inclined) {
  Scene s = two_boxes(cells, cells + 2, "", mu);
  std::get<BoxMesh>(s.bodies[0].mesh).cells = {cells, cells};
  s.bodies[1].material = J2Plastic{1500.0, 0.2, parameter(s, "yield", 4), parameter(s, "hardening", 100)};
  s.bodies[1].element = "Q4_mean_dilatation";
  if (inclined) {
    s.parameters.erase(s.parameters.begin() + 2);  // down
    s.loads = {traction("upper.left", {parameter(s, "pull", 0.3), 0.1})};
    s.supports.back() = {
        "upper.top", {}, {}, Inclined{{0.2, parameter(s, "slope", -0.98)}, table({{0, 0.0}, {1, 0.01}, {3, 0.012}})}};
    s.supports.push_back({"upper.top & upper.left", {}, {}, Inclined{{1.0, 0.1}, table({{1, 0.0}, {3, 0.004}})}});
  }
  return s;
}

Scene pull_out(int cells, const std::vector<double>& path, int steps) {
  Scene s;
  const Number friction = parameter(s, "mu", 0.3), stiffness = parameter(s, "EA", 1000), pull = parameter(s, "P", -20);
  s.parameters.back().slots[0].second = -1;
  s.bodies = {{"bar", LineMesh{{0.0, 0.0}, {1.0, 0.0}, cells}, LinearElastic{stiffness, 0.0}, "bar", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "bar.nodes", "floor")};
  s.contacts[0].friction = friction;
  s.loads = {traction("bar.nodes", {0.0, -100.0}), force("bar.start", {pull, 0.0})};
  Table history;
  for (std::size_t t = 0; t < path.size(); ++t) history.points.emplace_back(static_cast<double>(t), path[t]);
  s.loads[1].history = history;
  for (std::size_t t = 1; t < path.size(); ++t) s.legs.push_back({static_cast<double>(t), steps});
  s.responses = {response("u", Response::Kind::displacement, "bar.start", "x"),
                 response("heat", Response::Kind::dissipation, "sole")};
  return s;
}

void shape(Scene& scene, const std::string& name, ShapeMotion motion) {
  motion.slot = static_cast<int>(scene.numbers.size());
  scene.numbers.push_back(0);
  scene.pointers.push_back("/parameters/" + name);
  scene.parameters.push_back({name, {{motion.slot, 1.0}}, "/parameters/" + name, 1.0});
  scene.shapes.push_back(std::move(motion));
}

Scene shaped_boxes(int slave, int master, const std::string& element, bool segment) {
  Scene s = two_boxes(slave, master, element);
  s.contacts[0].segment = segment;
  std::get<BoxMesh>(s.bodies[0].mesh).min[0] = 0.31;  // no symmetry, or a peak has two places
  shape(s, "lift", {0, "upper.bottom", "upper.top", {0, 1}, -1, 0});
  shape(s, "bump", {0, "upper.bottom", "", {0.3, -1}, 2, 0});
  shape(s, "floor", {1, "lower.top", "lower.bottom", {0.2, 1}, 1, 0});
  shape(s, "flank", {1, "lower.right", "", {1, 0}, -1, 0});
  return s;
}

Scene segment_boxes(int slave, int master, double mu) {
  Scene s = two_boxes(slave, master, "Q4", mu);
  s.contacts[0].segment = true;
  std::get<BoxMesh>(s.bodies[0].mesh).max[0] = parameter(s, "edge", 1.75);
  return s;
}

Scene two_disks(int cells, bool segment, double mu) {
  Scene s;
  s.legs = {{1, 3}, {2, 4}};
  const Number radius = parameter(s, "radius", 1.2), friction = parameter(s, "mu", mu),
               down = parameter(s, "down", -0.04), E = parameter(s, "E", 1000);
  HalfDiskMesh upper, lower;
  upper.center = {0.0, 1.0};
  upper.radius = 1.0;
  upper.cells = {cells, cells};
  upper.grade = 3.0;
  lower = upper;
  lower.radius = radius;
  lower.center = {0.0, -1.2};
  lower.cells = {cells + 1, cells + 1};
  lower.facing = HalfDiskMesh::Facing::up;
  s.bodies = {{"upper", upper, LinearElastic{E, 0.3}, "", 1.0}, {"lower", lower, LinearElastic{1500.0, 0.2}, "", 1.0}};
  s.contacts = {contact("touch", "upper.arc", "lower.arc")};
  s.contacts[0].friction = friction;
  s.contacts[0].segment = segment;
  s.supports = {support("lower.flat", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                support("upper.flat", {{'x', table({{1, 0.0}, {2, 0.004}})}, {'y', table({{0, 0.0}, {1, down}})}})};
  s.responses = {response("press", Response::Kind::contact_force, "touch", "normal"),
                 response("shear", Response::Kind::contact_force, "touch", "x"),
                 response("width", Response::Kind::contact_half_width, "touch"),
                 response("heat", Response::Kind::dissipation, "touch"),
                 response("energy", Response::Kind::strain_energy, "")};
  return s;
}

Scene driven_block(const std::string& element) {
  Scene s;
  s.legs = {{2, 4}};
  const Number mu = parameter(s, "mu", 0.3), width = parameter(s, "width", 2.0), c = parameter(s, "c", 0.8),
               n = parameter(s, "n", 0.6), held = parameter(s, "held", 0.004), angle = parameter(s, "angle", 0.4),
               center = parameter(s, "center", 0.3), turn = parameter(s, "turn", -0.2), p = parameter(s, "p", 3),
               weight = parameter(s, "weight", -1.5);
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {width, 1.0};
  box.cells = {4, 3};
  s.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, element, 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.02, 1.0}}, {{'y', table({{0, 0.0}, {1, 0.01}})}}}};
  s.obstacles[0].rotate = Rotation{{center, 0.1}, {}, table({{0, 0.0}, {1, angle}, {2, 0.1}})};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = mu;
  Support left = support("block.left - block.top", {}), corner = support("block.right & block.bottom", {}),
          top = support("block.left & block.top", {}), across = support("block.left & block.top", {});
  left.inclined = Inclined{{c, n}, table({{0, 0.0}, {1, held}, {2, 0.0}})};
  corner.inclined = Inclined{{1.0, n}, table({{0, 0.0}})};
  top.inclined = Inclined{{c, n}, table({{0, 0.0}, {1, held}})};
  across.move = {{'y', table({{0, 0.0}, {2, -0.003}})}};
  Support hinge = support("block.right & block.top", {});
  hinge.rotate = Rotation{{1.0, center}, {}, table({{0, 0.0}, {1, turn}})};
  s.supports = {left, corner, top, across, hinge};
  s.loads = {{"block.top", Load::Kind::pressure, {p}, {}}, {"block", Load::Kind::body_force, {0.2, weight}, {}}};
  s.responses = {response("press", Response::Kind::contact_force, "sole", "normal"),
                 response("shear", Response::Kind::contact_force, "sole", "x"),
                 response("torque", Response::Kind::contact_force, "sole", "moment"),
                 response("left x", Response::Kind::reaction, "block.left", "x"),
                 response("left y", Response::Kind::reaction, "block.left", "y"),
                 response("moment", Response::Kind::reaction, "block.right", "moment"),
                 response("heat", Response::Kind::dissipation, "sole"),
                 response("u", Response::Kind::displacement, "block.left", "y")};
  s.responses[2].about = s.responses[5].about = {0.5, -0.25};
  return s;
}

Scene pushed_block(double angle) {
  Scene s;
  s.legs = {{2, 8}};
  const double c = std::cos(angle), n = std::sin(angle);
  const auto at = [&](double x, double y) { return std::array<Number, 2>{c * x - n * y, n * x + c * y}; };
  const Number thickness = parameter(s, "thickness", 2.5), mu = parameter(s, "mu", 0.3),
               push = parameter(s, "push", 0.02), press = parameter(s, "press", 5);
  QuadMesh quad;
  quad.corners = {at(0, 0), at(4, 0), at(4, 2), at(0, 2)};
  quad.cells = {6, 3};
  Body block{"block", quad, LinearElastic{1000.0, 0.3}, "Q4", 1.0};
  block.thickness = thickness;
  s.bodies = {block};
  s.obstacles = {{"floor", Polyline{{at(-1, 0), at(1.3, 0), at(5, 0)}}, {}}};
  s.contacts = {contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = mu;
  Support left = support("block.left", {});
  left.inclined = Inclined{{c, n}, table({{0, 0.0}, {1, push}, {2, -0.02}})};
  s.supports = {left};
  s.loads = {{"block.top", Load::Kind::pressure, {press}, table({{0, 0.0}, {0.5, 1}})}};
  s.responses = {response("press", Response::Kind::contact_force, "sole", "normal"),
                 response("heat", Response::Kind::dissipation, "sole"), response("slip", Response::Kind::slip, "sole"),
                 response("pull", Response::Kind::reaction, "block.left", "x"),
                 response("u", Response::Kind::displacement, "block.right", "y")};
  return s;
}

Scene turned_point() {
  Scene s = dragged_point({{0, 0, 0}, {1, 0, 0}}, 6, 0.3);
  const Number tilt = parameter(s, "tilt", 0.3), value = parameter(s, "value", 0.5), angle = parameter(s, "angle", 20),
               axis = parameter(s, "axis", 0.2);
  s.supports = {support("point.anchor", {})};
  s.supports[0].inclined = Inclined{{1.0, tilt, -0.2}, table({{0, 0.0}, {0.5, value}, {1, 0.1}})};
  s.obstacles[0].rotate = Rotation{{0.5, -0.2, 0.0}, {axis, 0.0, 1.0}, table({{0, 0.0}, {1, angle}})};
  return s;
}

Scene two_drums(int slave, int master, const std::string& element) {
  Scene s = two_boxes(slave, master, element);
  s.space = Space::axisymmetric;
  return s;
}

Scene two_slices(int slave, int master, const std::string& element) {
  Scene s = two_boxes(slave, master, element);
  s.bodies[0].thickness = parameter(s, "thin", 0.7);
  s.bodies[1].thickness = parameter(s, "thick", 1.3);
  return s;
}

Scene fitted_rings(const std::string& element) {
  Scene s;
  s.legs = {{2, 4}};
  const Number mu = parameter(s, "mu", 0.2), offset = parameter(s, "offset", -0.01), hole = parameter(s, "hole", 1),
               radius = parameter(s, "radius", 2), rim = parameter(s, "rim", 4), x = parameter(s, "x", 0.5),
               end = parameter(s, "end", 90), grade = parameter(s, "grade", 2), nu = parameter(s, "nu", 0.3);
  RingMesh inner, outer;
  inner.center = outer.center = {x, 0.0};
  inner.inner = hole;
  inner.outer = outer.inner = radius;
  outer.outer = rim;
  inner.to_angle = outer.to_angle = end;
  inner.cells = {2, 7};
  outer.cells = {3, 9};
  outer.grade = {{"inner", grade}};
  s.bodies = {{"inner", inner, LinearElastic{1000.0, nu}, element, 1.0},
              {"outer", outer, LinearElastic{1500.0, 0.3}, element, 1.0}};
  s.contacts = {contact("fit", "outer.inner", "inner.outer")};
  s.contacts[0].friction = mu;
  s.contacts[0].offset = offset;
  s.supports = {support("inner.inner", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}}),
                support("outer.outer",
                        {{'x', table({{0, 0.0}, {1, -0.004}, {2, 0.003}})}, {'y', table({{0, 0.0}, {2, 0.004}})}})};
  s.responses = {response("press", Response::Kind::contact_force, "fit", "normal"),
                 response("shear", Response::Kind::contact_force, "fit", "x"),
                 response("peak", Response::Kind::contact_pressure, "fit", "", Response::Take::max),
                 response("heat", Response::Kind::dissipation, "fit"),
                 response("pull", Response::Kind::reaction, "outer.outer", "y")};
  return s;
}

Scene wedge(double mu, double push, double press, double k, double coupling) {
  Scene s;
  s.legs = {{1, 1}};
  const Number friction = parameter(s, "mu", mu), load = parameter(s, "push", push), stiffness = parameter(s, "k", k);
  s.bodies = {{"point", PointMesh{{0.0, 0.0}}, GroundedSpring{{{stiffness, coupling}, {coupling, k}}}, "", 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  s.contacts = {contact("sole", "point.node", "floor")};
  s.contacts[0].friction = friction;
  s.loads = {force("point.node", {load, -press})};
  s.responses = {response("u", Response::Kind::displacement, "point.node", "x"),
                 response("press", Response::Kind::contact_force, "sole", "normal")};
  return s;
}

std::vector<Scene> all() {
  return {stop(),
          slider({{0, 0}, {1, 0.1}, {2, -0.1}, {3, 0.04}}, 9),
          dragged_point({{0, 0, 0}, {1, 0, -0.6}, {2, 0.7, -0.6}, {3, 0.2, 0.9}}, 24, 0.3),
          greco_plate(8),
          two_boxes(6, 9),
          two_boxes(5, 4, "T3", 0.25),
          two_boxes(4, 4, "Q4", 2),
          segment_boxes(5, 7),
          two_disks(8, false),
          two_disks(8, true),
          driven_block(),
          driven_block("T3"),
          pushed_block(),
          turned_point()};
}

std::vector<Scene> shaped() { return {shaped_boxes(5, 4, "Q4", false), shaped_boxes(4, 5, "T3", true)}; }

std::vector<Scene> of_every_element() {
  Scene segments = two_drums(4, 3, "Q4"), slices = segment_boxes(4, 3);
  segments.contacts[0].segment = true;
  slices.bodies[0].thickness = parameter(slices, "thin", 0.7);
  return {two_drums(4, 3, "Q4"),
          two_drums(4, 3, "Q4_mean_dilatation"),
          two_drums(3, 2, "T6"),
          two_slices(3, 4, "Q8"),
          two_slices(4, 4, "T3"),
          fitted_rings("Q8"),
          fitted_rings("Q4_mean_dilatation"),
          segments,
          slices};
}

}  // namespace stickslip::scenes
