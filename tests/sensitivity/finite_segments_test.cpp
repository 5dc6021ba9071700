/// Segment integration at finite strain: the patch test of A13 between any two meshes and elements, sliding with
/// friction over facets and ends, invariance, its limit of small strain, tangents and derivatives against the complex
/// step.
#include <gtest/gtest.h>

#include "core/contact/segments.hpp"
#include "sensitivity/one_sided.hpp"
#include "sensitivity/vertex_margin.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/finite_strain.hpp"
#include "tests/support/tangents.hpp"

namespace stickslip::finite_segments_test {
namespace {

using namespace scenes;
using Kind = Response::Kind;

Body rubber_body(Body body, Scene& s, const std::string& name, double E) {
  body.material = NeoHookean{parameter(s, name, E), 0.3, NeoHookean::Volumetric::log};
  return body;
}

Scene empty(std::vector<Leg> legs) {
  Scene s;
  s.finite_strain = true;
  s.legs = std::move(legs);
  return s;
}

Contact joint(Scene& s, const std::string& slave, const std::string& master, double mu) {
  Contact contact = scenes::contact("joint", slave, master);
  contact.segment = true;
  if (mu > 0) contact.friction = parameter(s, "mu", mu);
  return contact;
}

const Table still = table({{0, 0.0}});

// --- A13: two blocks, pressed on one another by any meshes ----------------------------------------------------------

/// Elements of the master's and of the slave's body; empty: Q4.
using Elements = std::array<std::string, 2>;

Scene stacked_segments(double stretch, double mu, int slave, int master, Space space = Space::plane_strain,
                       const Elements& elements = {}) {
  Scene s = empty({{1, 4}});
  s.space = space;
  s.bodies = {rubber_body(scenes::box_body("lower", {0, 0}, {2, 0.5}, {master, 2}), s, "E", 1000),
              rubber_body(scenes::box_body("upper", {0, 0.5}, {2, 1}, {slave, 2}), s, "E_upper", 1000)};
  for (int b : {0, 1}) s.bodies[b].element = elements[b];
  s.contacts = {joint(s, "upper.bottom", "lower.top", mu)};
  const Number down = parameter(s, "down", stretch - 1);
  s.supports = {scenes::support("lower.bottom", {{'y', still}}),
                scenes::support("upper.top", {{'y', table({{0, 0.0}, {1, down}})}})};
  if (space != Space::axisymmetric) {
    s.supports.push_back(scenes::support("lower.left", {{'x', still}}));
    s.supports.push_back(scenes::support("upper.left", {{'x', still}}));
  }
  s.responses = {response("press", Kind::reaction, "upper.top", "y"),
                 response("wide", Kind::displacement, "upper.right", "x"),
                 response("gap", Kind::gap, "joint", "", Response::Take::min),
                 response("least", Kind::contact_pressure, "joint", "", Response::Take::min),
                 response("most", Kind::contact_pressure, "joint", "", Response::Take::max)};
  return s;
}

/// With a penalty per area that is the same everywhere, as the pressure is to be.
std::vector<Method> patch_methods() {
  auto methods = finite_methods();
  std::get<Penalty>(methods[0]).stiffness = scenes::absolute(1e7);
  return methods;
}

constexpr std::pair<int, int> ratios[] = {{4, 4}, {8, 4}, {4, 8}, {3, 4}, {5, 4}, {7, 11}};

TEST(FiniteSegments, PassAUniformPressureBetweenAnyTwoMeshes) {
  for (const auto& [slave, master] : ratios)
    for (const auto& [l1, l2, P1] : {std::array{0.9, 1.0449972898, -120.5210836}, {0.7, 1.1507960463, -458.4239232}})
      for (const double mu : {0.0, 0.2})  // (both sides stretch alike: nothing slips)
        for (const auto& method : patch_methods()) {
          const auto s = run(stacked_segments(l1, mu, slave, master), method);
          ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
          // equilibrium is solved to 1e-10 of the largest nodal force
          EXPECT_NEAR(s.value("most") / s.value("least"), 1, 1e-10) << slave << ":" << master << name_of(method);
          const double overlap = std::abs(s.value("gap"));
          EXPECT_LE(overlap, std::holds_alternative<Penalty>(method) ? 1e-4 : 1e-11) << name_of(method);
          // the closed form has ten digits; by its overlap a penalty stretches less
          EXPECT_NEAR(s.value("most"), -P1, 1e-7 + 2e4 * overlap) << name_of(method);
          EXPECT_NEAR(s.value("press") / 2, P1, 1e-7 + 2e4 * overlap) << name_of(method);
          EXPECT_NEAR(s.value("wide") / 2 + 1, l2, 1e-8 + 10 * overlap) << name_of(method);
        }
}

TEST(FiniteSegments, PassAUniformPressureBetweenQuadraticElements) {
  for (const Elements& elements : {Elements{"Q8", "Q4"}, {"Q4", "Q8"}, {"T6", "T6"}, {"Q8", "T6"}})
    for (const auto& [slave, master] : {std::pair{3, 4}, {5, 3}})
      for (const Space space : {Space::plane_strain, Space::axisymmetric})
        for (const auto& method : patch_methods()) {
          // (its updates take hundreds: multipliers of a finer quadratic side that sticks are nearly redundant)
          if (slave > master && std::holds_alternative<UzawaAL>(method)) continue;
          const auto s = run(stacked_segments(0.8, 0.2, slave, master, space, elements), method);
          ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
          EXPECT_NEAR(s.value("most") / s.value("least"), 1, 1e-10)
              << elements[0] << elements[1] << slave << ":" << master << name_of(method);
        }
}

TEST(FiniteSegments, PassAUniformPressureOfRevolutionAndInPlaneStress) {
  for (const Space space : {Space::axisymmetric, Space::plane_stress})
    for (const auto& [slave, master] : {std::pair{3, 4}, {7, 11}})
      for (const auto& method : patch_methods()) {
        const auto s = run(stacked_segments(0.8, 0.2, slave, master, space), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
        EXPECT_NEAR(s.value("most") / s.value("least"), 1, 1e-10) << slave << ":" << master << name_of(method);
      }
}

// --- a die pressed into a slab and dragged along it, over facets and over the end ------------------------------------

/// `turned`: the whole scene about the origin, radians; `from`: where the die begins; `along`: how far it is dragged.
struct Ironing {
  double mu = 0.3, turned = 0, from = 0.8, along = 0.7;
  bool segment = true, shaped = false;
  Elements elements = {};
};

Scene ironing_segments(const Ironing& of = {}) {
  Scene s = empty({{1, 3}, {2, 5}});
  const double c = std::cos(of.turned), sn = std::sin(of.turned);
  const auto corner = [&](double x, double y) { return std::array<Number, 2>{c * x - sn * y, sn * x + c * y}; };
  QuadMesh slab, die;
  slab.corners = {corner(0, 0), corner(4, 0), corner(4, 1), corner(0, 1)};
  slab.cells = {12, 3};
  const double x = of.from;
  die.corners = {corner(x + 0.1, 1.05), corner(x + 0.9, 1.0), corner(x + 1, 1.6), corner(x, 1.6)};
  die.cells = {4, 2};
  s.bodies = {rubber_body({"slab", slab, LinearElastic{1.0, 0.0}, "", 1.0}, s, "E", 1),
              rubber_body({"die", die, LinearElastic{1.0, 0.0}, "", 1.0}, s, "E_die", 5)};
  for (int b : {0, 1}) s.bodies[b].element = of.elements[b];
  s.contacts = {joint(s, "die.bottom", "slab.top", of.mu)};
  s.contacts[0].segment = of.segment;
  const Number down = parameter(s, "down", -0.15), along = parameter(s, "along", of.along);
  const auto moves = [&](bool drags) {
    std::map<char, Table> move{{'x', table({{0, 0.0}, {1, 0.0}})}, {'y', table({{0, 0.0}, {1, down}})}};
    if (drags) move['x'].points.emplace_back(2, along);
    return move;
  };
  if (of.turned == 0) {
    s.supports = {scenes::support("slab.bottom", {{'x', still}, {'y', still}}),
                  scenes::support("die.top", moves(of.along != 0))};
  } else {
    s.supports = {
        scenes::support("slab.bottom", {{'x', still}, {'y', still}}),
        scenes::support("die.top", {{'x', table({{0, 0.0}, {1, 0.15 * sn}, {2, c * of.along + 0.15 * sn}})},
                                    {'y', table({{0, 0.0}, {1, -0.15 * c}, {2, sn * of.along - 0.15 * c}})}})};
    s.parameters.clear();
  }
  s.responses = {response("x", Kind::reaction, "die.top", "x"),
                 response("y", Kind::reaction, "die.top", "y"),
                 response("floor x", Kind::reaction, "slab.bottom", "x"),
                 response("floor y", Kind::reaction, "slab.bottom", "y"),
                 response("energy", Kind::strain_energy, ""),
                 response("normal", Kind::contact_force, "joint", "normal"),
                 response("on slave", Kind::contact_force, "joint", "y")};
  if (of.mu > 0) {
    s.responses.push_back(response("slid", Kind::slip, "joint"));
    s.responses.push_back(response("heat", Kind::dissipation, "joint"));
  }
  if (of.shaped) {
    scenes::shape(s, "lift", {1, "die.bottom", "die.top", {0, 1}, -1, 0});
    scenes::shape(s, "bump", {1, "die.bottom", "", {0.3, -1}, 2, 0});
    scenes::shape(s, "floor", {0, "slab.top", "slab.bottom", {0.2, 1}, -1, 0});
  }
  return s;
}

TEST(FiniteSegments, MethodsAgreeOnADieThatCrossesFacets) {
  auto methods = finite_methods();
  std::get<Penalty>(methods[0]).stiffness = scenes::relative(100);
  const auto exact = run(ironing_segments(), methods[2]);
  ASSERT_TRUE(is_converged(exact.trajectory.status)) << exact.trajectory.message;
  for (int m : {0, 1}) {
    const auto s = run(ironing_segments(), methods[m]);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(methods[m]) << s.trajectory.message;
    for (const char* name : {"x", "y", "energy", "heat"})  // (a penalty's overlap is some 1 / 100 of the depth)
      EXPECT_NEAR(s.value(name), exact.value(name), (m == 0 ? 0.03 : 1e-9) * std::abs(exact.value("y")))
          << name_of(methods[m]) << " " << name;
  }
}

TEST(FiniteSegments, ForcesBalanceBetweenSlaveAndMaster) {
  // to what equilibrium is solved to, 1e-10 of the largest nodal force; over the end of the slab too
  for (const double from : {0.8, 2.7})
    for (const auto& method : finite_methods()) {
      const auto s = run(ironing_segments({0.3, 0, from}), method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << name_of(method) << s.trajectory.message;
      for (int n = 0; n < static_cast<int>(s.trajectory.increments.size()); ++n) {
        const double size = std::abs(s.value("y"));
        EXPECT_NEAR(s.value("x", n), -s.value("floor x", n), 1e-9 * size);
        EXPECT_NEAR(s.value("y", n), -s.value("floor y", n), 1e-9 * size);
        EXPECT_NEAR(s.value("y", n), -s.value("on slave", n), 1e-9 * size);
      }
    }
}

/// A block of two facets, pressed onto a table that ends under the second one.
Scene block_over_an_end(double end, double mu) {
  Scene s = empty({{1, 1}});
  s.bodies = {rubber_body(scenes::box_body("block", {0, 0}, {1, 0.5}, {2, 1}), s, "E", 100)};
  s.obstacles = {{"table", Polyline{{{-1.0, 0.0}, {parameter(s, "end", end), 0.0}}}}};
  s.contacts = {joint(s, "block.bottom", "table", mu)};
  s.supports = {scenes::support("block.top", {{'x', still}, {'y', table({{0, 0.0}, {1, -0.02}})}})};
  s.responses = {response("N", Kind::contact_force, "joint", "normal")};
  return s;
}

TEST(FiniteSegments, TheForceOnANodeFadesAsAnEndLeavesIt) {
  // Where the force changes most between two ends, halved until they are 1e-5 of a facet apart. A jump would stay; it
  // was 6 % of the force. (Without friction, so that it does not depend on the path.)
  for (const Method& method : finite_methods()) {
    const auto force = [&](double end) {
      const auto s = run(block_over_an_end(end, 0), method);
      EXPECT_TRUE(is_converged(s.trajectory.status)) << end << name_of(method) << s.trajectory.message;
      return s.value("N");
    };
    double low = 0.51, at_low = force(low), width = 0.01, most = 0;
    for (double end = 0.51; end < 0.75; end += width)
      if (const double N = force(end + width), change = N - force(end); change > most) {
        most = change;
        low = end;
        at_low = N - change;
      }
    for (; width > 5e-6; width /= 2) {
      const double middle = force(low + width / 2), high = force(low + width);
      if (high - middle > middle - at_low) {
        low += width / 2;
        at_low = middle;
      }
    }
    EXPECT_LE(force(low + width) - at_low, 1e-3 * at_low) << name_of(method) << low;
  }
}

TEST(FiniteSegments, FrictionWorkAndStrainEnergyAddUpToTheWorkDone) {
  // 24 steps lose 0.1 % by their length, and 4 facets a second-order share of the work of the normal force
  for (const double mu : {0.0, 0.3}) {
    Scene scene = ironing_segments({mu});
    scene.legs = {{1, 12}, {2, 12}};
    const auto s = run(scene, MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    double work = 0, x = 0, y = 0, at_x = 0, at_y = 0;
    for (int n = 0; n < static_cast<int>(s.trajectory.increments.size()); ++n) {
      const double t = s.trajectory.increments[n].time;
      const double to_x = t <= 1 ? 0 : 0.7 * (t - 1), to_y = t <= 1 ? -0.15 * t : -0.15;
      work += 0.5 * ((x + s.value("x", n)) * (to_x - at_x) + (y + s.value("y", n)) * (to_y - at_y));
      x = s.value("x", n);
      y = s.value("y", n);
      at_x = to_x;
      at_y = to_y;
    }
    const double heat = mu > 0 ? s.value("heat") : 0;
    EXPECT_NEAR(work, s.value("energy") + heat, 0.004 * work) << mu;
  }
}

TEST(FiniteSegments, DoNotKnowDirectionsInSpace) {
  for (const double from : {0.8, 2.7})
    for (double turned : {0.5, 2.9}) {
      const auto s = run(ironing_segments({0.3, 0, from}), MonolithicAL{}),
                 t = run(ironing_segments({0.3, turned, from}), MonolithicAL{});
      ASSERT_TRUE(is_converged(t.trajectory.status)) << t.trajectory.message;
      const double c = std::cos(turned), sn = std::sin(turned), size = std::abs(s.value("y"));
      EXPECT_NEAR(t.value("x"), c * s.value("x") - sn * s.value("y"), 1e-10 * size);
      EXPECT_NEAR(t.value("y"), sn * s.value("x") + c * s.value("y"), 1e-10 * size);
      for (const char* name : {"energy", "heat", "slid", "normal"})
        EXPECT_NEAR(t.value(name), s.value(name), 1e-10 * size) << name;
    }
}

TEST(FiniteSegments, SmallStrainIsTheirLimit) {  // D3
  const auto press = [](bool finite, double down, double mu) {
    Scene s = ironing_segments({mu, 0, 0.8, 0});
    s.finite_strain = finite;
    for (auto& body : s.bodies)
      if (!finite) body.material = LinearElastic{body.name == "die" ? 5.0 : 1.0, 0.3};
    std::get<QuadMesh>(s.bodies[1].mesh).corners = {{{0.9, 1.0}, {1.7, 1.0}, {1.8, 1.6}, {0.8, 1.6}}};
    s.supports[1] =
        scenes::support("die.top", {{'x', table({{0, 0.0}, {1, -0.3 * down}})}, {'y', table({{0, 0.0}, {1, down}})}});
    s.legs = {{1, 2}};
    s.parameters.clear();
    const auto solved = run(s, MonolithicAL{});
    EXPECT_TRUE(is_converged(solved.trajectory.status)) << solved.trajectory.message;
    return Eigen::Vector2d(solved.value("x"), solved.value("y")) / down;
  };
  for (const double mu : {0.0, 0.1}) {
    double last = 0;
    for (double down : {-1e-2, -1e-3, -1e-4, -1e-5, -1e-6}) {  // the difference falls with the strain
      const Eigen::Vector2d small = press(false, down, mu);
      const double difference = (press(true, down, mu) - small).norm() / small.norm();
      EXPECT_LE(difference, 10 * std::abs(down));
      if (last > 0) {
        EXPECT_NEAR(std::log10(last / difference), 1, 0.02);  // (that of second order at 1e-2: 0.006)
      }
      last = difference;
    }
  }
}

/// Sides of quadratic elements, which bend as they are pressed.
Ironing quadratic(double from = 0.8) {
  Ironing of;
  of.from = from;
  of.elements = {"Q8", "T6"};
  return of;
}

TEST(FiniteSegments, TangentsAreTheComplexStepOfForcesAndRows) {
  for (const Scene& scene : {ironing_segments(), ironing_segments({0.3, 0, 2.7}), stacked_segments(0.7, 0.2, 3, 16),
                             ironing_segments(quadratic()), ironing_segments(quadratic(2.7))})
    for (const Method& method : {Method(MonolithicAL{}), Method(Penalty{scenes::relative(100)})}) {
      const auto s = run(scene, method);
      ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
      for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n)
        EXPECT_LE(scenes::errors_of_tangent(s.model, s.slots, method, s.trajectory, n).largest(), 1e-10);  // rounding
    }
}

TEST(FiniteSegments, DerivativesEqualTheComplexStepAndTheAdjoint) {
  for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(ironing_segments(), method);
  Ironing shaped;
  shaped.shaped = true;
  for (const Method& method : {Method(MonolithicAL{}), finite_schemes()[0]})
    scenes::expect_derivatives_in_both_modes(ironing_segments(shaped), method);
  Ironing bent = quadratic();
  bent.shaped = true;
  scenes::expect_derivatives_in_both_modes(ironing_segments(bent), MonolithicAL{});
  bent.shaped = false;
  bent.elements = {"Q4", "T6"};
  for (const Method& method : {finite_schemes()[0], finite_schemes()[1]})
    scenes::expect_derivatives_in_both_modes(ironing_segments(bent), method);
  scenes::expect_derivatives_in_both_modes(ironing_segments({0}), MonolithicAL{});
  scenes::expect_derivatives_in_both_modes(ironing_segments({0.3, 0, 2.7}), MonolithicAL{});
  for (const double end : {0.62, 0.65})  // (a node of which a twentieth faces the table, and nearly a tenth)
    scenes::expect_derivatives_in_both_modes(block_over_an_end(end, 0.3), MonolithicAL{});
  for (const Space space : {Space::axisymmetric, Space::plane_stress}) {
    Scene blocks = stacked_segments(0.8, 0.2, 3, 4, space);
    blocks.responses.resize(2);  // (the gap is rounding)
    scenes::expect_derivatives_in_both_modes(blocks, MonolithicAL{});
  }
}

TEST(FiniteSegments, TellWhereAnEndOfTheSlaveMeetsABendOfTheMaster) {
  const auto s = run(ironing_segments(), MonolithicAL{});
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  State<double> state = s.trajectory.increments.back().state;
  EXPECT_GT(integration_margin(s.model, s.slots, state, 2), 1e-3);
  EXPECT_LT(integration_margin(s.model, s.slots, state, 2), 10);
  EXPECT_EQ(vertex_margin(s.model, s.slots, state, 2), integration_margin(s.model, s.slots, state, 2));
  const int end = s.model.side("die.bottom").nodes.back();
  for (std::size_t p = 0; p < s.model.points.size(); ++p) {
    if (s.model.points[p].nodes[0] != end) continue;
    ASSERT_NE(state.contact.state[p], ContactState::open);
    const int vertex = state.contact.facing[p].pieces.front().master[0];
    const auto dofs = [&](int node) { return state.displacement.segment<2>(2 * static_cast<Eigen::Index>(node)); };
    dofs(end) = s.slots.points.col(vertex).head<2>() + dofs(vertex) - s.slots.points.col(end).head<2>();
  }
  EXPECT_LE(integration_margin(s.model, s.slots, state, 2), weak_margin);
}

// --- walls -----------------------------------------------------------------------------------------------------------

/// A block on a table that is the slave. Its walls lean outwards from upright by `lean` of their height of 1.
Scene leaning_block(const std::string& master, double lean) {
  Scene s = empty({{1, 2}});
  QuadMesh block;
  block.corners = {
      std::array<Number, 2>{1.05, 1.0}, {3.1, 1.0}, {parameter(s, "right", 3.1 + lean), 2.0}, {1.05 - lean, 2.0}};
  block.cells = {3, 2};
  s.bodies = {rubber_body(scenes::box_body("table", {0, 0}, {5, 1}, {20, 4}), s, "E", 100),
              rubber_body({"block", block, LinearElastic{1.0, 0.0}, "", 1.0}, s, "E_block", 100)};
  s.contacts = {joint(s, "table.top", "block." + master, 0.3)};
  s.supports = {
      scenes::support("table.bottom", {{'x', still}, {'y', still}}),
      scenes::support("block.top", {{'x', still}, {'y', table({{0, 0.0}, {1, parameter(s, "down", -0.02)}})}})};
  s.responses = {response("y", Kind::reaction, "block.top", "y")};
  return s;
}

/// From 104 to 120 degrees between the normals walls count in part, the more the farther they lean.
TEST(FiniteSegments, WallsCountAsFarAsTheyOpposeTheSlave) {
  const auto weight = [](double cosine) {
    return weight_of_angle(Vec<double, 2>(0, 1), Vec<double, 2>(std::sqrt(1 - cosine * cosine), -cosine));
  };
  EXPECT_EQ(weight(-0.3), 0);
  EXPECT_EQ(weight(0.25), 0);
  EXPECT_NEAR(weight(0.375), 0.5, 1e-15);  // a rounding of the cosine
  EXPECT_EQ(weight(0.5), 1);
  EXPECT_EQ(weight(1), 1);
  const auto force = [](const std::string& master, double lean) {
    const auto s = run(leaning_block(master, lean), MonolithicAL{});
    EXPECT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    return s.value("y");
  };
  const double sole = force("bottom", 0.4);  // (cosine .37)
  EXPECT_GT(std::abs(force("boundary", 0.4) - sole), 1e-3 * std::abs(sole));
  EXPECT_NEAR(force("boundary", 0.1), force("bottom", 0.1), 1e-9 * std::abs(sole));  // as far as equilibrium is solved
  for (const Method& method : finite_schemes())
    scenes::expect_derivatives_in_both_modes(leaning_block("boundary", 0.4), method);
}

// --- obstacles -------------------------------------------------------------------------------------------------------

/// A block pressed onto a floor by a load, which turns and moves; `round`: a disk.
Scene on_floor(bool round, bool segment = true) {
  Scene s = empty({{1, 2}, {2, 5}});
  s.bodies = {rubber_body(scenes::box_body("block", {-1, 0}, {1, 1}, {4, 2}), s, "E", 100)};
  Obstacle floor{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}};
  if (round) floor.shape = Circle{{0.1, -3}, parameter(s, "R", 3)};
  floor.rotate = Rotation{{0.0, -2.0}, {}, table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "angle", 6)}})};
  floor.move = {{'x', table({{0, 0.0}, {1, 0.0}, {2, parameter(s, "aside", 0.1)}})}};
  s.obstacles = {floor};
  s.contacts = {joint(s, "block.bottom", "floor", 0.1)};
  s.contacts[0].segment = segment;
  s.loads = {scenes::traction("block.right", {parameter(s, "load", 1), 0.0})};
  s.supports = {scenes::support("block.top", {{'x', still}, {'y', table({{0, 0.0}, {1, -0.1}})}})};
  s.responses = {response("x", Kind::reaction, "block.top", "x"), response("y", Kind::reaction, "block.top", "y"),
                 response("slid", Kind::slip, "joint"), response("heat", Kind::dissipation, "joint")};
  return s;
}

TEST(FiniteSegments, ObstaclesMoveAndTurnWithTheirFriction) {
  for (const bool round : {false, true}) {
    for (const Method& method : finite_schemes()) scenes::expect_derivatives_in_both_modes(on_floor(round), method);
    const auto s = run(on_floor(round), MonolithicAL{});
    for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n)
      EXPECT_LE(scenes::errors_of_tangent(s.model, s.slots, MonolithicAL{}, s.trajectory, n).largest(), 1e-10);
  }
  // (four cells on a plane are within 5 % of node-to-segment: both have the error of their mesh)
  const auto integrated = run(on_floor(false), MonolithicAL{}), nodal = run(on_floor(false, false), MonolithicAL{});
  for (const char* name : {"x", "y", "slid"})
    EXPECT_NEAR(integrated.value(name), nodal.value(name), 0.05 * std::abs(nodal.value("y"))) << name;
}

}  // namespace
}  // namespace stickslip::finite_segments_test
