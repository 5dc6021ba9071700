/// Solid bodies in space, where nothing is as in the plane: patch tests, names of the axes, turns; and derivatives
/// against the complex step of the whole program, in both modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "tests/support/finite_strain.hpp"

namespace stickslip::solid_bodies_test {
namespace {

using Kind = Response::Kind;

const J2Plastic metal{1000.0, 0.3, 12.0, 50.0};

/// A block of space that is pressed on a skew floor, drawn along two directions and twisted.
Scene twisted_block(const Material& material, bool finite, const std::string& element = "") {
  Scene s;
  s.space = Space::solid;
  s.finite_strain = finite;
  s.legs = {{1, 2}, {2, 2}};
  const Number mu = scenes::parameter(s, "mu", 0.3), depth = scenes::parameter(s, "depth", 0.9),
               twist = scenes::parameter(s, "twist", 4.0), tilt = scenes::parameter(s, "tilt", 0.03),
               pressure = scenes::parameter(s, "pressure", 3.0), grade = scenes::parameter(s, "grade", 2.0);
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {1.2, depth, 0.8};
  box.cells = {3, 2, 2};
  box.grade = {{"bottom", grade}};
  s.bodies = {{"block", box, material, element, 1.0}};
  s.obstacles = {{"floor", Plane{{0.0, 0.0, -0.04}, {tilt, -0.02, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.contacts[0].friction = mu;
  Support top = scenes::support(
      "block.top", {{'x', scenes::table({{1, 0.0}, {2, 0.03}})}, {'z', scenes::table({{0, 0.0}, {1, -0.12}})}});
  top.rotate = Rotation{{0.6, 0.4, 0.8}, {0.1, 0.0, 1.0}, scenes::table({{1, 0.0}, {2, twist}})};
  s.supports = {top};
  s.loads = {{"block.back", Load::Kind::pressure, {pressure}, {}},
             {"block", Load::Kind::body_force, {0.5, 0.0, -2.0}, {}},
             {"block.left", Load::Kind::traction, {0.3, 0.1, -0.2}, {}}};
  s.responses = {scenes::response("press", Kind::contact_force, "sole", "normal"),
                 scenes::response("x", Kind::contact_force, "sole", "x"),
                 scenes::response("y", Kind::contact_force, "sole", "y"),
                 scenes::response("pull", Kind::reaction, "block.top", "y"),
                 scenes::response("heat", Kind::dissipation, "sole"),
                 scenes::response("slip", Kind::slip, "sole", "x"),
                 scenes::response("energy", Kind::strain_energy, "")};
  return s;
}

/// The block in a bowl that turns about a skew axis while the block is twisted in it.
Scene block_in_a_bowl(const Material& material, bool finite) {
  Scene s = twisted_block(material, finite);
  const Number radius = scenes::parameter(s, "radius", 5.0), turn = scenes::parameter(s, "turn", 1.5);
  s.obstacles[0].shape = Sphere{{0.6, 0.4, 4.95}, radius, true};
  s.obstacles[0].rotate = Rotation{{0.6, 0.4, 4.0}, {0.2, 0.1, 1.0}, scenes::table({{1, 0.0}, {2, turn}})};
  return s;
}

/// Two blocks whose meshes do not match: the upper one is pressed, drawn along two directions and twisted.
Scene block_on_block(const std::string& element, bool matching = false, double degrees = 3) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 2}, {2, 3}};
  const Number mu = scenes::parameter(s, "mu", 0.3), E = scenes::parameter(s, "E", 1000.0),
               down = scenes::parameter(s, "down", -0.02), twist = scenes::parameter(s, "twist", degrees),
               depth = scenes::parameter(s, "depth", 0.83), edge = scenes::parameter(s, "edge", 0.21);
  BoxMesh upper, lower;
  upper.min = {edge, 0.17, 1.0};
  upper.max = {1.0, depth, 1.6};
  upper.cells = {3, 2, 2};
  lower.min = {0.0, 0.0, 0.0};
  lower.max = {1.2, 1.0, 1.0};
  lower.cells = {3, 4, 2};
  if (matching) {
    lower.min = {edge, 0.17, 0.4};
    lower.max = {1.0, depth, 1.0};
    lower.cells = upper.cells;
  }
  s.bodies = {{"upper", upper, LinearElastic{E, 0.3}, element, 1.0},
              {"lower", lower, LinearElastic{1500.0, 0.2}, element, 1.0}};
  s.contacts = {scenes::contact("touch", "upper.bottom", "lower.top")};
  s.contacts[0].friction = mu;
  const Table still = scenes::table({{0, 0.0}});
  Support top = scenes::support("upper.top", {{'x', scenes::table({{1, 0.0}, {2, 0.01}})},
                                              {'y', scenes::table({{1, 0.0}, {2, -0.006}})},
                                              {'z', scenes::table({{0, 0.0}, {1, down}})}});
  top.rotate = Rotation{{0.6, 0.4, 1.6}, {0.0, 0.0, 1.0}, scenes::table({{1, 0.0}, {2, twist}})};
  s.supports = {scenes::support("lower.bottom", {{'x', still}, {'y', still}, {'z', still}}), top};
  s.responses = {scenes::response("press", Kind::contact_force, "touch", "normal"),
                 scenes::response("x", Kind::contact_force, "touch", "x"),
                 scenes::response("y", Kind::contact_force, "touch", "y"),
                 scenes::response("pull", Kind::reaction, "upper.top", "y"),
                 scenes::response("heat", Kind::dissipation, "touch"),
                 scenes::response("peak", Kind::contact_pressure, "touch", "", Response::Take::max),
                 scenes::response("energy", Kind::strain_energy, "")};
  return s;
}

/// Nodes over nodes: pressed evenly, both blocks have one stress, since each node bears its own share of the area.
TEST(SolidBodies, OfMatchingMeshesPassThePatchTest) {
  for (const char* element : {"H8", "T4"}) {
    Scene s = block_on_block(element, true);
    for (auto& body : s.bodies) body.material = LinearElastic{1000.0, 0.0};
    s.contacts[0].friction.reset();
    const Table still = scenes::table({{0, 0.0}});
    s.supports = {
        scenes::support("lower.bottom", {{'x', still}, {'y', still}, {'z', still}}),
        scenes::support("upper.top", {{'x', still}, {'y', still}, {'z', scenes::table({{0, 0.0}, {2, -0.012}})}})};
    for (const Method& method : {Method(UzawaAL{}), Method(MonolithicAL{})}) {
      const auto run = scenes::run(s, method);
      ASSERT_TRUE(is_converged(run.trajectory.status)) << run.trajectory.message;
      const auto& contact = run.trajectory.increments.back().state.contact;
      for (std::size_t p = 0; p < run.model.points.size(); ++p)  // E u / h = 1000 x .012 / 1.2; Uzawa ends at 1e-7
        EXPECT_NEAR(contact.traction[run.model.points[p].multiplier], -10, 1e-5) << element << name_of(method);
    }
  }
}

/// The same of rubber, at finite strain: the upper one is pressed deep, and slides and twists over faces of the lower.
Scene sliding_blocks(Smoothing smoothing, const std::string& element = "H8") {
  Scene s = block_on_block(element, false, 12.0);
  s.finite_strain = true;
  s.bodies[0].material = NeoHookean{std::get<LinearElastic>(s.bodies[0].material).E, 0.3};
  s.bodies[1].material = NeoHookean{400.0, 0.3};
  std::get<BoxMesh>(s.bodies[0].mesh).cells = {2, 2, 1};
  std::get<BoxMesh>(s.bodies[1].mesh).cells = {3, 3, 1};  // no node begins on an edge, where the numbering chooses
  s.contacts[0].smoothing = smoothing;
  auto& move = s.supports.back().move;
  move['x'] = scenes::table({{1, 0.0}, {2, 0.17}});
  move['y'] = scenes::table({{1, 0.0}, {2, -0.1}});
  return s;
}

/// The side of a box that another becomes where x becomes y, y becomes z and z becomes x.
std::string turned_side(const std::string& side) {
  const std::map<std::string, std::string> becomes{{"left", "front"}, {"right", "back"},  {"front", "bottom"},
                                                   {"back", "top"},   {"bottom", "left"}, {"top", "right"}};
  const auto found = becomes.find(side);
  return found == becomes.end() ? side : found->second;
}
std::string turned_place(const std::string& place) {
  const auto dot = place.find('.');
  return dot == std::string::npos ? place : place.substr(0, dot + 1) + turned_side(place.substr(dot + 1));
}

/// A scene with other names of the axes: frames, numbers of nodes and the direction of grading change.
Scene turned(Scene s) {
  const auto turn = [](auto& three) { std::rotate(three.rbegin(), three.rbegin() + 1, three.rend()); };
  for (auto& body : s.bodies) {
    auto& box = std::get<BoxMesh>(body.mesh);
    turn(box.min);
    turn(box.max);
    turn(box.cells);
    for (Grading& grading : box.grade) grading.towards = turned_side(grading.towards);
  }
  for (auto& obstacle : s.obstacles) {
    auto& plane = std::get<Plane>(obstacle.shape);
    turn(plane.point);
    turn(plane.normal);
  }
  s.contacts[0].slave = turned_place(s.contacts[0].slave);
  s.contacts[0].master = turned_place(s.contacts[0].master);
  for (auto& support : s.supports) {
    support.on = turned_place(support.on);
    std::map<char, Table> move;
    for (const auto& [axis, table] : support.move) move[axis == 'z' ? 'x' : static_cast<char>(axis + 1)] = table;
    support.move = move;
    if (!support.rotate) continue;
    turn(support.rotate->center);
    turn(support.rotate->axis);
  }
  for (auto& load : s.loads) {
    load.on = turned_place(load.on);
    if (load.vector.size() == 3) turn(load.vector);
  }
  using Component = Response::Component;
  for (auto& response : s.responses) {
    response.on = turned_place(response.on);
    if (response.component == Component::x)
      response.component = Component::y;
    else if (response.component == Component::y)
      response.component = Component::z;
  }
  return s;
}

/// Iterations of Newton's method to a hundred times its tolerance, by Uzawa with the updates of the default.
long iterations(const Scene& scene, Method method) {
  std::visit([](auto& options) { options.newton.tolerance = 1e-10; }, method);
  if (auto* uzawa = std::get_if<UzawaAL>(&method)) uzawa->tolerance = UzawaAL{}.tolerance;
  return scenes::run(scene, method).trajectory.counters.newton;
}

TEST(SolidBodies, DoNotDependOnTheNamesOfTheAxes) {
  const NeoHookean rubber{1000.0, 0.3};
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  for (const Method& method : {Method(Penalty{}), Method(uzawa), Method(MonolithicAL{})})
    for (const Scene& scene : {twisted_block(LinearElastic{1000.0, 0.3}, false), twisted_block(rubber, true),
                               twisted_block(metal, true), sliding_blocks(Smoothing::catmull_rom)}) {
      const auto one = scenes::run(scene, method), other = scenes::run(turned(scene), method);
      ASSERT_TRUE(is_converged(one.trajectory.status)) << one.trajectory.message;
      ASSERT_EQ(one.trajectory.increments.size(), other.trajectory.increments.size()) << other.trajectory.message;
      // (Rounding decides the last iterations of tight tolerances: of Uzawa's updates, and of springs, which make a
      // tenth of Newton's tolerance of it. Counts are those of a hundred times that tolerance.)
      EXPECT_EQ(iterations(scene, method), iterations(turned(scene), method)) << name_of(method);
      const auto value = [](const scenes::Solved& s, const std::string& name) { return s.value(name); };
      const auto derivative = [](const scenes::Solved& s, Eigen::Index r, Eigen::Index j) {
        return s.gradients.of_responses.back()(r, j);
      };
      for (Eigen::Index r = 0; r < static_cast<Eigen::Index>(scene.responses.size()); ++r) {
        const std::string& name = scene.responses[r].name;
        // the tolerance of the runs, a thousand times: the condition of the block
        EXPECT_NEAR(value(other, name), value(one, name), 1e-9 * std::abs(value(one, name))) << name_of(method) << name;
        const double size = largest_entry(one.gradients.of_responses.back().row(r));
        for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(scene.parameters.size()); ++j)
          EXPECT_NEAR(derivative(other, r, j), derivative(one, r, j), 1e-8 * size) << name_of(method) << name;
      }
    }
}

/// Two blocks that an interference presses, and that are turned as one: what they bear turns with them.
TEST(SolidBodies, ThatTurnTogetherKeepWhatTheyBearWhereTheyTouch) {
  const Table still = scenes::table({{0, 0.0}}), turn = scenes::table({{2, 0.0}, {3, 50.0}});
  Scene s = sliding_blocks(Smoothing::catmull_rom);
  s.legs = {{1, 2}, {2, 2}, {3, 5}};
  for (auto& support : s.supports) {
    support.rotate = Rotation{{0.6, 0.4, 0.0}, {0.3, -0.2, 1.0}, turn};
    support.move = {{'x', still}, {'y', still}, {'z', still}};
  }
  s.contacts[0].offset = -0.05;  // what presses them
  s.responses = {scenes::response("press", Kind::contact_force, "touch", "normal"),
                 scenes::response("x", Kind::contact_force, "touch", "x"),
                 scenes::response("y", Kind::contact_force, "touch", "y"),
                 scenes::response("z", Kind::contact_force, "touch", "z"),
                 scenes::response("energy", Kind::strain_energy, "")};
  for (const Method& method : {Method(Penalty{}), Method(MonolithicAL{})}) {
    const auto run = scenes::run(s, method);
    ASSERT_TRUE(is_converged(run.trajectory.status)) << run.trajectory.message;
    const auto& increments = run.trajectory.increments;
    const auto& before = increments[3].state.contact;
    const auto& after = increments.back().state.contact;
    double shear = 0;
    for (const auto& point : run.model.points) {
      const auto k = point.multiplier;
      EXPECT_NEAR(after.traction[k], before.traction[k], 1e-8 * std::abs(before.traction[k])) << name_of(method);
      const double t = before.traction.segment(k + 1, 2).norm();
      shear = larger(shear, t);
      EXPECT_NEAR(after.traction.segment(k + 1, 2).norm(), t, 1e-8 * std::abs(before.traction[k])) << name_of(method);
    }
    EXPECT_GT(shear, 1);
    // the force of contact is turned by the angle of the table about the axis
    const auto force = [&](int n) { return Vec<double, 3>(run.value("x", n), run.value("y", n), run.value("z", n)); };
    const double angle = 50 * std::numbers::pi / 180;
    const Vec<double, 3> e = Vec<double, 3>(0.3, -0.2, 1).normalized(), f = force(3);
    const Vec<double, 3> expected =
        std::cos(angle) * f + std::sin(angle) * cross<double>(e, f) + (1 - std::cos(angle)) * e.dot(f) * e;
    EXPECT_LE((force(static_cast<int>(increments.size()) - 1) - expected).norm(), 1e-8 * f.norm()) << name_of(method);
  }
}

/// A body that a support turns and that touches nothing bears nothing: what Newton's method finds are residuals alone,
/// which are no larger beside the forces of the next iterate than beside those of the last.
TEST(SolidBodies, ThatOnlyTurnAreSolvedInAFewIterations) {
  for (const char* element : {"H8", "T4"}) {
    Scene s = twisted_block(NeoHookean{1000.0, 0.3}, true, element);
    s.contacts.clear();
    s.obstacles.clear();
    s.loads.clear();
    s.parameters.clear();
    s.responses = {scenes::response("energy", Kind::strain_energy, "")};
    s.supports[0].move = {};
    s.supports[0].rotate = Rotation{{0.6, 0.4, 0.8}, {0.1, 0.3, 1.0}, scenes::table({{0, 0.0}, {2, 40.0}})};
    const auto run = scenes::run(s, MonolithicAL{});
    ASSERT_EQ(run.trajectory.status, Status::converged) << run.trajectory.message;
    for (std::size_t n = 0; n < run.trajectory.increments.size(); ++n) {
      EXPECT_LE(run.trajectory.increments[n].newton, 8) << element;  // 10 degrees a step, and two to see that it rests
      EXPECT_LE(run.value("energy", static_cast<int>(n)), 1e-16 * 1000) << element;  // a strain of 1e-8, of rounding
    }
  }
}

/// A block of space over rigid triangles, which go up and down, turn about a skew axis and are drawn along.
Scene over_triangles(Smoothing smoothing) {
  Scene s = twisted_block(NeoHookean{1000.0, 0.3}, true);
  RigidFacets hills;
  constexpr int n = 5;
  hills.vertices.resize(3, n * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      hills.vertices.col(n * i + j) << -1.03 + 0.71 * i, -0.92 + 0.69 * j, 0.02 * ((i * i + 2 * j) % 3) - 0.02;
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      const int a = n * i + j, b = a + n;
      hills.facets.push_back({a, b, b + 1});
      hills.facets.push_back({a, b + 1, a + 1});
    }
  s.obstacles[0].shape = hills;
  s.obstacles[0].move['x'] = scenes::table({{1, 0.0}, {2, scenes::parameter(s, "drawn", 0.15)}});
  s.obstacles[0].rotate =
      Rotation{{0.5, 0.4, -0.3}, {0.1, 0.2, 1.0}, scenes::table({{1, 0.0}, {2, scenes::parameter(s, "turned", 4.0)}})};
  s.contacts[0].smoothing = smoothing;
  return s;
}

/// The same block over the side of a rigid ball of another mesh, whose radius and place are parameters.
Scene over_a_mesh(Smoothing smoothing, bool finite) {
  Scene s = over_triangles(smoothing);
  s.finite_strain = finite;
  if (!finite) s.bodies[0].material = LinearElastic{1000.0, 0.3};
  BallMesh ball;
  ball.center = {0.61, scenes::parameter(s, "aside", 0.43), -5.03};
  ball.radius = scenes::parameter(s, "radius", 5.0);
  ball.cells = {8, 1};
  s.obstacles[0].shape = MeshSide(ball, make_mesh(ball, "", 3), "surface");
  return s;
}

/// The same block on a rigid box of nearly its own size: pressed, it spreads over all ends of the box.
Scene on_a_box(const std::optional<double>& friction) {
  Scene s = twisted_block(NeoHookean{1000.0, 0.3}, true);
  if (!friction) s.contacts[0].friction.reset();
  BoxMesh box;
  box.min = {-0.01, 0.0, -1.0};
  box.max = {scenes::parameter(s, "end", 1.19), 0.89, -0.04};
  box.cells = {3, 3, 1};
  s.obstacles[0].shape = MeshSide(box, make_mesh(box, "", 3), "boundary");
  s.contacts[0].smoothing = Smoothing::catmull_rom;
  if (!friction)  // the others are zero
    std::erase_if(s.responses, [](const Response& r) { return r.name != "press" && r.name != "energy"; });
  std::erase_if(s.parameters, [&](const Parameter& p) {
    return p.name == "tilt" || p.name == "pressure" || p.name == "grade" || (!friction && p.name == "mu");
  });
  return s;
}

/// Few steps and parameters: the oracle runs each in complex numbers.
Scene few_steps(Scene s) {
  s.legs = {{1, 1}, {2, 1}};
  std::erase_if(s.parameters,
                [](const Parameter& p) { return p.name == "down" || p.name == "E" || p.name == "depth"; });
  return s;
}

/// The same scene, integrated over overlaps.
Scene segmented(Scene scene) {
  scene.contacts[0].segment = true;
  return scene;
}

TEST(SolidBodies, HaveTheDerivativesOfTheOracleInBothModes) {
  const NeoHookean rubber{1000.0, 0.3};
  const auto two_steps = [](Scene s) {
    s.legs = {{1, 1}, {2, 1}};
    return s;
  };
  for (const Method& method : scenes::finite_schemes()) {
    scenes::expect_derivatives_in_both_modes(two_steps(twisted_block(LinearElastic{1000.0, 0.3}, false)), method);
    scenes::expect_derivatives_in_both_modes(two_steps(twisted_block(LinearElastic{1000.0, 0.3}, false, "T4")), method);
    scenes::expect_derivatives_in_both_modes(two_steps(twisted_block(rubber, true)), method);
    scenes::expect_derivatives_in_both_modes(two_steps(block_on_block("H8")), method);
    scenes::expect_derivatives_in_both_modes(block_in_a_bowl(rubber, true), method);
  }
  const MonolithicAL monolithic;
  scenes::expect_derivatives_in_both_modes(twisted_block(rubber, true, "H8_mean_dilatation"), monolithic);
  scenes::expect_derivatives_in_both_modes(twisted_block(rubber, true, "T4"), monolithic);
  scenes::expect_derivatives_in_both_modes(block_on_block("T4"), monolithic);
  scenes::expect_derivatives_in_both_modes(twisted_block(metal, false), monolithic);
  scenes::expect_derivatives_in_both_modes(twisted_block(metal, true), monolithic);
}

/// Few cells too: those of quadratic elements have many nodes.
Scene few_cells(Scene s) {
  for (auto& body : s.bodies)
    for (int& along : std::get<BoxMesh>(body.mesh).cells) along = along > 2 ? 2 : along;
  return few_steps(std::move(s));
}

/// Faces of all kinds against one another, against a plane and rigid triangles: shapes move what overlaps what.
TEST(SolidBodies, IntegratedOverOverlapsHaveTheDerivativesOfTheOracleInBothModes) {
  for (const Method& method : scenes::finite_schemes())
    scenes::expect_derivatives_in_both_modes(few_cells(segmented(block_on_block("H8"))), method);
  const MonolithicAL monolithic;
  scenes::expect_derivatives_in_both_modes(few_cells(segmented(block_on_block("T4"))), monolithic);
  Scene triangles = few_cells(segmented(over_triangles(Smoothing::none)));
  triangles.finite_strain = false;
  triangles.bodies[0].material = LinearElastic{1000.0, 0.3};
  scenes::expect_derivatives_in_both_modes(triangles, monolithic);
  for (const char* element : {"T10", "H20", "H27"}) {
    Scene block = few_cells(segmented(twisted_block(LinearElastic{1000.0, 0.3}, false, element)));
    std::erase_if(block.parameters, [](const Parameter& p) { return p.name != "depth" && p.name != "mu"; });
    scenes::expect_derivatives_in_both_modes(block, monolithic);
  }
  // the sides of quadratic elements on one another, of few cells and parameters, because there are many nodes
  Scene blocks = few_cells(segmented(block_on_block("T10")));
  for (auto& body : blocks.bodies) std::get<BoxMesh>(body.mesh).cells = {2, 1, 1};
  std::get<BoxMesh>(blocks.bodies[0].mesh).cells = {1, 1, 1};
  blocks.parameters.clear();
  scenes::shape(blocks, "side", {1, "lower.right", "lower.left", {1.0, 0.3, -0.2}, -1, 0});
  scenes::expect_derivatives_in_both_modes(blocks, monolithic);
}

/// A penalty at which the two modes differ by 1e-12: by the rounding of gaps times the stiffness.
Penalty soft_penalty() {
  Penalty penalty;
  penalty.stiffness = scenes::relative(10);
  return penalty;
}

TEST(SolidBodies, OfQuadraticElementsHaveTheDerivativesOfTheOracleInBothModes) {
  const MonolithicAL monolithic;
  for (const char* element : {"T10", "H20", "H27"}) {
    scenes::expect_derivatives_in_both_modes(few_cells(twisted_block(NeoHookean{1000.0, 0.3}, true, element)),
                                             monolithic);
    Scene blocks = few_cells(block_on_block(element));
    scenes::shape(blocks, "side", {1, "lower.right", "lower.left", {1.0, 0.3, -0.2}, -1, 0});  // and its middles
    scenes::expect_derivatives_in_both_modes(blocks, monolithic);
  }
  scenes::expect_derivatives_in_both_modes(few_cells(twisted_block(metal, false, "T10")), monolithic);
  scenes::expect_derivatives_in_both_modes(few_cells(twisted_block(LinearElastic{1000.0, 0.3}, false, "H27")),
                                           soft_penalty());
}

TEST(SolidBodies, OverRigidTrianglesHaveTheDerivativesOfTheOracleInBothModes) {
  for (const Method& method : {Method(soft_penalty()), scenes::finite_schemes()[1], Method(MonolithicAL{})})
    scenes::expect_derivatives_in_both_modes(few_steps(over_triangles(Smoothing::catmull_rom)), method);
  scenes::expect_derivatives_in_both_modes(few_steps(over_triangles(Smoothing::none)), MonolithicAL{});
}

TEST(SolidBodies, OverRigidSidesOfMeshesHaveTheDerivativesOfTheOracleInBothModes) {
  // by the numbers of the mesh too
  const auto schemes = scenes::finite_schemes();
  for (const std::size_t k : {0U, 1U, 4U})  // one a method
    scenes::expect_derivatives_in_both_modes(few_steps(over_a_mesh(Smoothing::catmull_rom, true)), schemes[k]);
  const MonolithicAL monolithic;
  scenes::expect_derivatives_in_both_modes(few_steps(over_a_mesh(Smoothing::b_spline, true)), monolithic);
  scenes::expect_derivatives_in_both_modes(few_steps(over_a_mesh(Smoothing::none, false)), monolithic);
  scenes::expect_derivatives_in_both_modes(few_cells(segmented(over_a_mesh(Smoothing::none, false))), monolithic);
}

TEST(SolidBodies, PastTheEndsOfTheirMasterHaveTheDerivativesOfTheOracleInBothModes) {
  for (const auto& friction : {std::optional<double>(), std::optional(0.3)})
    for (const Method& method : {Method(soft_penalty()), scenes::finite_schemes()[1], Method(MonolithicAL{})}) {
      const Scene scene = few_cells(on_a_box(friction));
      const auto run = scenes::run(scene, method);
      const auto is_past = [](const Facing& facing) { return facing.ends != 0; };
      ASSERT_FALSE(run.trajectory.increments.empty());
      const auto& contact = run.trajectory.increments.back().state.contact;
      EXPECT_TRUE(std::any_of(contact.facing.begin(), contact.facing.end(), is_past));
      scenes::expect_derivatives_in_both_modes(scene, method);
    }
}

TEST(SolidBodies, ThatSlideOverOneAnotherHaveTheDerivativesOfTheOracle) {
  const auto schemes = scenes::finite_schemes();
  for (const std::size_t k : {0U, 1U, 4U})  // one a method
    scenes::expect_derivatives_in_both_modes(few_steps(sliding_blocks(Smoothing::catmull_rom)), schemes[k]);
}

TEST(SolidBodies, ThatSlideOverSplinesAndTrianglesHaveTheDerivativesOfTheOracle) {
  const MonolithicAL monolithic;
  scenes::expect_derivatives_in_both_modes(few_steps(sliding_blocks(Smoothing::b_spline)), monolithic);
  scenes::expect_derivatives_in_both_modes(few_steps(sliding_blocks(Smoothing::catmull_rom, "T4")), monolithic);
  scenes::expect_derivatives_in_both_modes(few_steps(sliding_blocks(Smoothing::catmull_rom, "T10")), monolithic);
}

TEST(SolidBodies, LeaveNoElementOnTheTapeOfTheAdjoint) {
  // Of a hexahedron a tangent takes 1.8 MB of tape where it is recorded whole, a volume or an energy 200 kB. What is
  // left of a volume, eight points by 25 inputs and their shares for eight nodes, takes 16 kB; a tape may double as it
  // grows.
  constexpr long kept = 2 * 16'000;
  const auto tape_of = [](int cells, const Method& method) {
    Scene s = twisted_block(LinearElastic{1000.0, 0.3}, false);
    std::get<BoxMesh>(s.bodies[0].mesh).cells = {cells, cells, cells};
    s.legs = {{1, 1}};
    scenes::ask_for_objectives(s);
    scenes::SolvedRun run(s, method);
    const auto gradients = run.backward();
    EXPECT_GT(gradients.of_objectives.size(), 0) << gradients.message;
    return gradients.storage.tape;
  };
  for (const Method& method : {Method(Penalty{}), Method(MonolithicAL{})})
    EXPECT_LE(tape_of(6, method) - tape_of(3, method), kept * (6 * 6 * 6 - 3 * 3 * 3)) << name_of(method);
}

}  // namespace
}  // namespace stickslip::solid_bodies_test
