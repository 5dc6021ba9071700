/// What drives a scene: loads, tables, supports and obstacles that move, each against a closed form or against the same
/// scene said in another way.
#include <gtest/gtest.h>

#include "tests/support/blocks.hpp"

namespace stickslip::loading_test {
namespace {

using scenes::all_methods;
using scenes::response;
using scenes::run;
using scenes::support;
using scenes::table;
using Kind = Response::Kind;

std::vector<RunOptions> both_engines() {
  RunOptions sparse, condensed;
  sparse.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  condensed.linear_algebra.engine = LinearAlgebra::Engine::condensed;
  return {sparse, condensed};
}

Number with_slot(Scene& scene, double value) {
  return scenes::parameter(scene, "p" + std::to_string(scene.numbers.size()), value);
}

Scene of_box(double width, double height, std::array<int, 2> cells, double nu, const std::string& element = "Q4") {
  Scene s;
  s.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {width, height};
  box.cells = {cells[0], cells[1]};
  s.bodies = {{"block", box, LinearElastic{1000.0, nu}, element, 1.0}};
  return s;
}

// --- loads -----------------------------------------------------------------------------------------------------------

TEST(Loads, PressureAllAroundIsAHydrostaticState) {
  // plane strain: sigma = -p in the plane, so eps_xx = eps_yy = -p (1 + nu) (1 - 2 nu) / E
  for (const char* element : {"Q4", "T3"}) {
    Scene s = of_box(2, 1, {4, 3}, 0.3, element);
    for (const char* side : {"block.top", "block.right", "block.left", "block.bottom"})
      s.loads.push_back({side, Load::Kind::pressure, {5.0}, {}});
    s.supports = {support("block.left", {{'x', table({{0, 0.0}})}}),
                  support("block.bottom", {{'y', table({{0, 0.0}})}})};
    s.responses = {response("u", Kind::displacement, "block.right", "x"),
                   response("v", Kind::displacement, "block.top", "y", Response::Take::max),
                   response("left", Kind::reaction, "block.left", "x")};
    const auto r = run(s, MonolithicAL{});
    const double strain = -5 * 1.3 * 0.4 / 1000;
    // rounding of a solve with a condition number of about 100
    EXPECT_NEAR(r.value("u"), 2 * strain, 1e-13 * std::abs(strain)) << element;
    EXPECT_NEAR(r.value("v"), strain, 1e-13 * std::abs(strain)) << element;
    EXPECT_NEAR(r.value("left"), 0, 1e-12 * 5) << "the pressure on the other side holds it";
  }
}

TEST(Loads, PressureOnACurvedSidePushesInwardsWithTheForceOfItsProjection) {
  Scene s;
  s.legs = {{1, 1}};
  HalfDiskMesh disk;
  disk.center = {0.0, 0.0};
  disk.radius = 2.0;
  s.bodies = {{"disk", disk, LinearElastic{1000.0, 0.3}, "", 1.0}};
  s.loads = {{"disk.arc", Load::Kind::pressure, {3.0}, {}}};
  s.supports = {support("disk.flat", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  s.responses = {response("x", Kind::reaction, "disk.flat", "x"), response("y", Kind::reaction, "disk.flat", "y")};
  const auto r = run(s, MonolithicAL{});
  EXPECT_NEAR(r.value("y"), -3.0 * 4, 1e-11) << "the facets span the diameter 4, whatever their number";
  EXPECT_NEAR(r.value("x"), 0, 1e-11);
}

TEST(Loads, BodyForceOnAStandingColumn) {
  // nu = 0: u(H) = b H^2 / 2 E at the nodes, exactly, by any elements of linear shape functions with straight sides
  for (const char* element : {"Q4", "T3"}) {
    Scene s = of_box(1, 3, {2, 5}, 0, element);
    s.loads = {{"block", Load::Kind::body_force, {0.0, with_slot(s, -2)}, {}}};
    s.supports = {support("block.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
    s.responses = {response("u", Kind::displacement, "block.top", "y"),
                   response("R", Kind::reaction, "block.bottom", "y")};
    const auto r = run(s, MonolithicAL{});
    if (std::string(element) == "Q4") {
      EXPECT_NEAR(r.value("u"), -2.0 * 9 / 2000, 1e-15);
    }
    EXPECT_NEAR(r.value("R"), 6, 1e-13) << element;
    EXPECT_NEAR(r.derivative("R", "p0"), -3, 1e-13) << element;
  }
  Scene bar;
  bar.legs = {{1, 1}};
  bar.bodies = {{"bar", LineMesh{{0.0, 0.0}, {0.0, 3.0}, 4}, LinearElastic{1000.0, 0.0}, "", with_slot(bar, 0.5)}};
  bar.loads = {{"bar", Load::Kind::body_force, {0.0, -2.0}, {}}};
  bar.supports = {support("bar.start", {{'y', table({{0, 0.0}})}}), support("bar.nodes", {{'x', table({{0, 0.0}})}})};
  bar.responses = {response("u", Kind::displacement, "bar.end", "y"), response("R", Kind::reaction, "bar.start", "y")};
  const auto r = run(bar, MonolithicAL{});
  EXPECT_NEAR(r.value("u"), -2.0 * 9 / 2000, 1e-15);
  EXPECT_NEAR(r.value("R"), 3, 1e-13) << "length x area x 2";
  EXPECT_NEAR(r.derivative("R", "p0"), 6, 1e-13);
  EXPECT_NEAR(r.derivative("u", "p0"), 0, 1e-15) << "weight and stiffness grow alike";
}

TEST(Loads, HaveDerivativesByTheirHistory) {
  // u = F f(t) H / (E A), f(1/2) halfway between two numbers of the table
  Scene s = of_box(2, 3, {2, 2}, 0);
  s.legs = {{1, 2}};
  s.loads = {{"block.top", Load::Kind::force, {0.0, -4.0}, {}}};
  Table history = table({{0, 0.0}, {1, 0.0}});
  history.points[0].second = with_slot(s, 0.5);
  history.points[1].second = with_slot(s, 2);
  s.loads[0].history = history;
  s.supports = {support("block.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  s.responses = {response("u", Kind::displacement, "block.top", "y")};
  const auto r = run(s, MonolithicAL{});
  const double unit = -4.0 * 3 / (1000 * 2);
  for (const auto& [n, before, after] : {std::tuple{0, 0.5, 0.5}, {1, 0.0, 1.0}}) {
    EXPECT_NEAR(r.value("u", n), unit * (0.5 * before + 2 * after), 1e-12) << n;
    EXPECT_NEAR(r.derivative("u", "p0", n), unit * before, 1e-12) << n;
    EXPECT_NEAR(r.derivative("u", "p1", n), unit * after, 1e-12) << n;
  }
}

TEST(Bodies, HaveDerivativesByTheirThickness) {
  Scene s = of_box(2, 3, {2, 2}, 0);
  s.bodies[0].thickness = with_slot(s, 0.5);
  s.loads = {{"block.top", Load::Kind::force, {0.0, -4.0}, {}}};
  s.supports = {support("block.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  s.responses = {response("u", Kind::displacement, "block.top", "y")};
  const auto r = run(s, MonolithicAL{});
  const double u = -4.0 * 3 / (1000 * 2 * 0.5);
  EXPECT_NEAR(r.value("u"), u, 1e-12);
  EXPECT_NEAR(r.derivative("u", "p0"), -u / 0.5, 1e-11);
}

TEST(Loads, BodyForceOfRevolutionIsConsistentOnTrianglesToo) {
  // N_a of two of the corners on the axis weigh r half as much as that of the third
  Scene s;
  s.space = Space::axisymmetric;
  s.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {3.0, 2.0};
  box.cells = {1, 1};
  s.bodies = {{"block", box, LinearElastic{1000.0, 0.0}, "T3", 1.0}};
  s.loads = {{"block", Load::Kind::body_force, {0.0, -2.0}, {}}};
  const Model model = make_model(s);
  const auto slots = make_slots<double>(model, s.as<double>());
  Vector<double> expected = Vector<double>::Zero(model.node_count);
  const auto& mesh = model.bodies[0].mesh;
  for (int e = 0; e < mesh.element_count(); ++e) {
    const int* nodes = &mesh.connectivity[3 * e];
    double r = 0;
    for (int a = 0; a < 3; ++a) r += slots.points(0, nodes[a]);
    // int N_a r dA = A (r_a + sum r) / 12, exactly, on a triangle of half the box
    for (int a = 0; a < 3; ++a) expected[nodes[a]] += -2 * 2 * M_PI * 3 * (slots.points(0, nodes[a]) + r) / 12;
  }
  const Vector<double> forces = slots.loads[0].all(model.dof_count());
  for (int node = 0; node < model.node_count; ++node)
    EXPECT_NEAR(forces[2 * node + 1], expected[node], 1e-14 * expected.norm()) << node;
}

TEST(Loads, ActOnNothingOnTheAxisOfRevolution) {
  Points<Dual<1>> ends = Points<Dual<1>>::Constant(2, 2, Dual<1>(0));
  ends(1, 1) = Dual<1>::seed(1, 0);
  const auto shares = side_shares(ends, {0, 1}, Depth<Dual<1>>{true});
  EXPECT_EQ(shares[0].v, 0);
  EXPECT_EQ(shares[0].d[0], 0) << "its length grows, its area does not";
  Scene s;
  s.space = Space::axisymmetric;
  s.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {with_slot(s, 1), 1.0};
  box.cells = {2, 2};
  s.bodies = {{"block", box, LinearElastic{1000.0, 0.3}, "", 1.0}};
  s.loads = {{"block.top", Load::Kind::traction, {0.0, -3.0}, {}}};
  s.supports = {support("block.bottom", {{'y', table({{0, 0.0}})}})};
  s.responses = {response("R", Kind::reaction, "block.bottom", "y")};
  const auto r = run(s, MonolithicAL{});
  EXPECT_NEAR(r.value("R"), 3 * M_PI, 1e-12);
  EXPECT_NEAR(r.derivative("R", "p0"), 6 * M_PI, 1e-12);
  s.loads[0].on = "block.left";
  EXPECT_THROW(make_model(s), ModelError);
  s.loads[0].kind = Load::Kind::force;
  EXPECT_THROW(make_model(s), ModelError);
  s.loads[0].on = "block.top";
  s.obstacles = {{"wall", Plane{{0.0, 0.0}, {1.0, 0.0}}, {}}};
  s.contacts = {scenes::contact("touch", "block.left", "wall")};
  EXPECT_THROW(make_model(s), ModelError);
}

TEST(Loads, BeyondTheRangeOfNumbersAreNotFiniteAndNotConverged) {
  for (const auto& method : all_methods()) {
    Scene s = of_box(1, 1, {2, 2}, 0.3, "Q4");
    s.loads.assign(5, {"block.top", Load::Kind::force, {0.0, -1e308}, {}});  // half of each on the middle node
    s.supports = {support("block.bottom", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
    EXPECT_EQ(run(s, method).trajectory.status, Status::not_finite) << name_of(method);
  }
}

// --- tables ----------------------------------------------------------------------------------------------------------

TEST(Tables, RepeatedValuesAreThoseOfTheFirstPeriodToTheLastBit) {
  Table t{{{0.1, 2.0}, {0.4, -1.0}, {0.7, 2.0}}, 1000};
  const Numbers<double> none;
  for (int n : {0, 1, 7, 333, 999}) {
    EXPECT_EQ(evaluate(t, t.time(n, 1), none), -1.0) << n;
    EXPECT_EQ(evaluate(t, t.time(n, 2), none), 2.0) << n;
    // a time of n periods keeps 2e-16 n of a period, and the slope is 10
    EXPECT_NEAR(evaluate(t, t.time(n, 1) + 0.1, none), 0.0, 2e-15 * (n + 1)) << n;
  }
  EXPECT_EQ(evaluate(t, -5, none), 2.0);
  EXPECT_EQ(evaluate(t, 1e4, none), 2.0);
}

/// A2 (C34): the first loading, then so many cycles.
Scene cycled_slider(int cycles) {
  Scene s = scenes::slider({{0, 0}, {1, 0.1}}, 1);
  const Number back = scenes::parameter(s, "back", -0.1);
  const auto first = s.supports[0].move.at('x').points[1].second;
  s.supports[0].move['x'] = Table{{{1, first}, {2, back}, {3, first}}, cycles};
  s.legs = {{1.0 + 2 * cycles, 1}};
  return s;
}

TEST(Tables, AThousandCyclesOfTheSliderDriftByNothing) {
  for (const auto& method : {Method(UzawaAL{}), Method(MonolithicAL{})}) {
    const auto s = run(cycled_slider(1000), method);
    ASSERT_EQ(s.trajectory.increments.size(), 2001u) << "every breakpoint of every repeat is hit, and nothing else";
    EXPECT_NEAR(s.value("heat"), 0.21 + 840, 1e-10 * 840) << name_of(method);
    // dD/dmu = N (U0 - 2 mu N / k) of the first loading, 4 N (U0 - 2 mu N / k) of each cycle
    EXPECT_NEAR(s.derivative("heat", "mu"), 0.4 + 1600, 1e-10 * 1600) << name_of(method);
    EXPECT_NEAR(s.value("u"), 0.07, 1e-12) << name_of(method);
    const auto &second = s.trajectory.increments[1].state, &last = s.trajectory.increments.back().state;
    EXPECT_EQ(last.contact.traction.size() + last.displacement.size(),
              second.contact.traction.size() + second.displacement.size());
    EXPECT_TRUE(s.trajectory.increments.back().augmented.empty());
  }
}

TEST(Tables, PenaltyCyclesDissipateAlikeEveryTime) {
  const auto s = run(cycled_slider(200), Penalty{});
  const double cycle = s.value("heat", 4) - s.value("heat", 2);
  EXPECT_NEAR(s.value("heat"), s.value("heat", 0) + 200 * cycle, 1e-10 * 200 * cycle);
}

// --- supports --------------------------------------------------------------------------------------------------------

/// A block on a rough floor that is pressed down and pulled by its right side, which slides along a wall: all turned by
/// `angle`. Inclined supports hold it, unless the angle is zero and `by_axis`.
Scene turned_scene(double angle, bool by_axis) {
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {2.0, 1.0};
  box.cells = {8, 4};
  ImportedMesh mesh;
  mesh.mesh = make_mesh(MeshDescription(box), "Q4", 2);
  const Points<double> flat = make_points<double>(MeshDescription(box), Numbers<double>{}, 2);
  const double c = std::cos(angle), s = std::sin(angle);
  mesh.points = (Eigen::Matrix2d() << c, -s, s, c).finished() * flat;
  Scene scene;
  scene.legs = {{2, 6}};
  const Number mu = scenes::parameter(scene, "mu", 0.3), pull = scenes::parameter(scene, "pull", 0.01),
               down = scenes::parameter(scene, "down", -0.01);
  scene.bodies = {{"block", mesh, LinearElastic{1000.0, 0.3}, "", 1.0}};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {-s, c}}, {}}};
  scene.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  scene.contacts[0].friction = mu;
  auto hold = [&](const std::string& side, double x, double y, const Table& value) {
    Support held = support(side, {});
    if (by_axis)
      held.move[x > 0 ? 'x' : 'y'] = value;
    else
      held.inclined = Inclined{{3 * (c * x - s * y), 3 * (s * x + c * y)}, value};
    scene.supports.push_back(held);
  };
  hold("block.right", 1, 0, table({{0, 0.0}, {1, 0.0}, {2, pull}}));  // contact nodes are among them
  hold("block.top", 0, 1, table({{0, 0.0}, {1, down}}));
  scene.responses = {
      response("press", Kind::contact_force, "sole", "normal"), response("heat", Kind::dissipation, "sole"),
      response("moment", Kind::reaction, "block.right", "moment"), response("rx", Kind::reaction, "block.right", "x"),
      response("ry", Kind::reaction, "block.right", "y")};
  scene.responses[2].about = {0.0, 0.0};
  return scene;
}

TEST(Supports, AnInclinedSceneIsTheAxisParallelOneTurned) {
  for (const auto& method : all_methods())
    for (const auto& options : both_engines()) {
      const auto reference = run(turned_scene(0, true), method, options);
      EXPECT_TRUE(reference.model.framed.empty() && reference.slots.frames.empty());
      for (double angle : {0.0, 37 * M_PI / 180, -2.2}) {
        const auto s = run(turned_scene(angle, false), method, options);
        ASSERT_EQ(s.trajectory.increments.size(), reference.trajectory.increments.size());
        EXPECT_EQ(s.model.free_dofs.size(), reference.model.free_dofs.size());
        EXPECT_EQ(s.trajectory.increments.back().newton, reference.trajectory.increments.back().newton);
        // 1e-11: rounding of the turned coordinates (gaps of 1e-2 keep 1e-14) times a condition number of some 100
        for (const char* name : {"press", "heat", "moment"})
          EXPECT_NEAR(s.value(name), reference.value(name), 1e-11 * std::abs(reference.value(name))) << name << angle;
        const double x = reference.value("rx"), y = reference.value("ry"), c = std::cos(angle), sn = std::sin(angle);
        EXPECT_NEAR(s.value("rx"), c * x - sn * y, 1e-11 * std::abs(x));
        EXPECT_NEAR(s.value("ry"), sn * x + c * y, 1e-11 * std::abs(x));
        for (const char* of : {"mu", "pull", "down"})
          EXPECT_NEAR(s.derivative("press", of), reference.derivative("press", of),
                      1e-10 * std::abs(reference.derivative("press", of)))
              << of;
      }
    }
}

TEST(Supports, TwoInclinedDirectionsAtANodePrescribeItFully) {
  Scene s = of_box(1, 1, {2, 2}, 0.3);
  Support one = support("block.left", {}), two = support("block.left & block.top", {});
  one.inclined = Inclined{{2.0, 1.0}, table({{0, 0.02}})};
  two.inclined = Inclined{{-1.0, 3.0}, table({{0, -0.01}})};
  s.supports = {one, two, support("block.right", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}})}})};
  for (const char* axis : {"x", "y"})
    s.responses.push_back(response(axis, Kind::displacement, "block.left & block.top", axis));
  const auto r = run(s, MonolithicAL{});
  // (2, 1).u = 0.02 sqrt 5, (-1, 3).u = -0.01 sqrt 10
  const double a = 0.02 * std::sqrt(5), b = -0.01 * std::sqrt(10);
  EXPECT_NEAR(r.value("x"), (3 * a - b) / 7, 1e-16);
  EXPECT_NEAR(r.value("y"), (a + 2 * b) / 7, 1e-16);
}

TEST(Supports, AnInclinedAnchorInSpaceIsHeldAcrossItsDirectionToo) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 1}};
  s.bodies = {
      {"p", PointMesh{{0.0, 0.0, 0.0}}, GroundedSpring{{{5.0, 0.0, 0.0}, {0.0, 5.0, 0.0}, {0.0, 0.0, 5.0}}}, "", 1.0}};
  s.supports = {support("p.anchor", {})};
  s.supports[0].inclined = Inclined{{1.0, 2.0, 2.0}, table({{0, 0.9}})};
  for (const char* axis : {"x", "y", "z"}) s.responses.push_back(response(axis, Kind::displacement, "p.node", axis));
  const auto r = run(s, MonolithicAL{});
  EXPECT_NEAR(r.value("x"), 0.3, 1e-15);
  EXPECT_NEAR(r.value("y"), 0.6, 1e-15);
  EXPECT_NEAR(r.value("z"), 0.6, 1e-15);
}

TEST(Supports, ARotatedBodyIsFreeOfStrainAndTheAngleIsInDegrees) {
  Scene s = of_box(2, 1, {3, 3}, 0.3);
  const Rotation turn{{0.3, -0.2}, {}, table({{0, 0.0}, {1, 10.0}})};
  for (const char* side : {"block.left", "block.right"}) {
    s.supports.push_back(support(side, {{'y', table({{0, 0.5}})}}));
    s.supports.back().rotate = turn;
  }
  s.responses = {response("x", Kind::displacement, "block.right & block.top", "x"),
                 response("y", Kind::displacement, "block.right & block.top", "y"),
                 response("energy", Kind::strain_energy, "")};
  const auto r = run(s, MonolithicAL{});
  const double theta = 10 * M_PI / 180;
  EXPECT_NEAR(r.value("x"), -theta * 1.2, 1e-15);
  EXPECT_NEAR(r.value("y"), 0.5 + theta * 1.7, 1e-15);
  EXPECT_NEAR(r.value("energy"), 0, 1e-12) << "of the order of E theta^2 = 30 if it were not linearised";
}

TEST(Supports, OfOneNodeMergeWhereTheyAgreeAndAreRefusedWhereTheyDoNot) {
  auto scene = [](double corner_value) {
    Scene s = of_box(2, 1, {2, 2}, 0.3);
    Support inclined = support("block.left & block.top", {});
    inclined.inclined = Inclined{{3.0, 4.0}, table({{0, 0.0}, {1, corner_value}})};
    s.supports = {support("block.left", {{'x', table({{0, 0.0}, {1, 0.1}})}, {'y', table({{0, 0.0}, {1, 0.2}})}}),
                  inclined};
    return s;
  };
  EXPECT_EQ(make_model(scene(0.6 * 0.1 + 0.8 * 0.2)).constraints.size(), 6u);
  try {
    make_model(scene(0.3));
    FAIL() << "the corner cannot follow both";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.pointer, "/supports/1/along");
    EXPECT_NE(std::string(error.what()).find("block.left"), std::string::npos) << error.what();
  }
}

// --- obstacles -------------------------------------------------------------------------------------------------------

/// The driven block on a floor that is a plane, or a polyline of as many facets.
Scene on_polyline(int facets) {
  Scene s = scenes::driven_block();
  Polyline line;
  for (int i = 0; i <= facets; ++i) {
    const double x = 10.0 * i / facets - 5;
    line.points.push_back({x, -0.02 * x});
  }
  if (facets > 0) s.obstacles[0].shape = line;
  return s;
}

TEST(Polyline, StraightIsThePlane) {
  for (const auto& method : all_methods()) {
    const auto plane = run(on_polyline(0), method);
    for (int facets : {1, 7}) {
      const auto s = run(on_polyline(facets), method);
      for (const auto& r : s.model.scene.responses)
        EXPECT_NEAR(s.value(r.name), plane.value(r.name), 1e-10 * std::max(1.0, std::abs(plane.value("press"))))
            << name_of(method) << " " << r.name;
    }
  }
}

TEST(Polyline, IsSolidOnItsRightAndEndsWhereItEnds) {
  Scene s = of_box(2, 1, {4, 2}, 0.3);
  Polyline square;  // clockwise: the solid is inside
  square.points = {{{0.9, -1.0}}, {{0.9, 0.0}}, {{1.6, 0.0}}, {{1.6, -1.0}}};
  s.obstacles = {{"peg", square, {}}};
  s.contacts = {scenes::contact("touch", "block.bottom", "peg")};
  s.supports = {support("block.top", {{'x', table({{0, 0.0}})}, {'y', table({{0, 0.0}, {1, -0.01}})}})};
  s.responses = {response("press", Kind::contact_force, "touch", "normal")};
  const auto open = run(s, MonolithicAL{});
  const auto& points = open.model.points;
  ASSERT_EQ(points.size(), 5u) << "the nearest of an open line is one of its points or facets";
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double x = 0.5 * static_cast<double>(p), g = open.slots.geometry[p].gap;
    if (x == 1.0 || x == 1.5) {
      EXPECT_NEAR(g, 0, 1e-15) << x;
      EXPECT_NEAR(open.slots.geometry[p].normal[1], 1, 1e-15);
    } else {
      EXPECT_GT(g, 0.2) << x;
      EXPECT_EQ(points[p].master, ContactPoint::Master::vertex);
    }
  }
  EXPECT_GT(open.value("press"), 0);
  std::get<Polyline>(s.obstacles[0].shape).points = {{{0.9, 0.0}}, {{1.6, 0.0}}};
  EXPECT_EQ(make_model(s).points.size(), 2u) << "past a free end nothing is faced";
}

TEST(Obstacles, ADrumThatTurnsDragsABlockByFriction) {
  // a point pressed by N on a drum of radius R that turns about its centre: the spring pulls back with mu N once it
  // slips, and follows the surface, R theta, before
  for (const auto& method : {Method(UzawaAL{}), Method(MonolithicAL{})}) {
    Scene s = scenes::slider({{0, 0}, {1, 0}}, 1);
    s.supports.clear();
    s.obstacles = {{"floor", Circle{{0.0, -2.0}, 2.0}, {}}};
    const Number angle = scenes::parameter(s, "angle", -0.5);
    s.obstacles[0].rotate = Rotation{{0.0, -2.0}, {}, table({{0, 0.0}, {1, angle}})};
    const double degree = M_PI / 180;
    const auto stick = run(s, method);
    EXPECT_NEAR(stick.value("u"), 2 * 0.5 * degree, 1e-12) << "clockwise: the top moves to the right";
    EXPECT_NEAR(stick.derivative("u", "angle"), -2 * degree, 1e-12);
    s.obstacles[0].rotate->angle = table({{0, 0.0}, {1, -5.0}});
    EXPECT_NEAR(run(s, method).value("u"), 0.03, 1e-12) << "mu N / k";
  }
}

TEST(Responses, MomentsOfContactAndSupportsBalanceThoseOfTheLoads) {
  for (const auto& method : all_methods()) {
    Scene s = scenes::driven_block();
    s.responses = {response("contact", Kind::contact_force, "sole", "moment")};
    for (const char* side : {"block.left", "block.right - block.bottom", "block.right & block.bottom"})
      s.responses.push_back(response(side, Kind::reaction, side, "moment"));
    for (auto& r : s.responses) r.about = {0.5, -0.25};
    const auto r = run(s, method);
    // pressure 3 on the top of 0 < x < 2: -3 x 2 at the arm 0.5; body force (0.2, -1.5) x 2 at the arm (0.5, 0.75)
    const double loads = -3 * 2 * 0.5 + 2 * (-1.5 * 0.5 - 0.2 * 0.75);
    double sum = loads, largest = 0;
    for (const auto& response : s.responses) {
      sum += r.value(response.name);
      largest = larger(largest, std::abs(r.value(response.name)));
    }
    EXPECT_GT(largest, 1);
    // equilibrium holds to Newton's tolerance of the largest force
    EXPECT_NEAR(sum, 0, 1e-9 * largest) << name_of(method);
  }
}

}  // namespace
}  // namespace stickslip::loading_test
