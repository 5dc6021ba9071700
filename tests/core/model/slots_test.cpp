/// What a residual reads: values of stiffness and loads, and derivatives by dual numbers against complex ones and
/// against differences.
#include "core/model/slots.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/compiled_slots.hpp"
#include "tests/support/derivatives.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip::slots_test {
namespace {

using scenes::parameter;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// A half disk pressed on another (bisectors, facets and vertices), or on a disk or a cup where `master` says so.
Scene half_disks(const std::string& master, int lower_cells) {
  Scene s;
  s.legs = {{1, 1}};
  HalfDiskMesh upper, lower;
  const Number radius = parameter(s, "radius", 1.0), grade = parameter(s, "grade", 4.0),
               shift = parameter(s, "shift", 0.013), offset = parameter(s, "offset", 1e-3), E = parameter(s, "E", 10.0),
               nu = parameter(s, "nu", 0.3), mu = parameter(s, "mu", 0.2), rim = parameter(s, "rim", 1.3),
               load = parameter(s, "load", -0.7);
  upper.center = {shift, 1.001};
  upper.radius = radius;
  upper.cells = {6, 6};
  upper.grade = grade;
  lower.center = {0.0, -1.3};
  lower.radius = rim;
  lower.cells = {lower_cells, 6};
  lower.facing = HalfDiskMesh::Facing::up;
  s.bodies = {{"upper", upper, LinearElastic{E, nu}, "", 1.0}, {"lower", lower, LinearElastic{E, 0.2}, "", 1.0}};
  s.obstacles = {{"disk", Circle{{0.0, -1.3}, rim, false}, {}}, {"cup", Circle{{0.0, 0.8}, rim, true}, {}}};
  s.contacts = {scenes::contact("touch", "upper.arc", master)};
  s.contacts[0].friction = mu;
  s.contacts[0].offset = offset;
  s.loads = {scenes::traction("upper.flat", {0.0, load}), scenes::force("upper.arc", {load, 1.0})};
  return s;
}

/// Lumped bodies: an arc of bars in a tilted plane's way, and a point on a spring.
Scene lumped() {
  Scene s;
  s.legs = {{1, 1}};
  const Number radius = parameter(s, "radius", 1.5), angle = parameter(s, "angle", 130.0), E = parameter(s, "E", 7.0),
               area = parameter(s, "area", 0.1), tilt = parameter(s, "tilt", 0.3), k = parameter(s, "k", 3.0),
               y = parameter(s, "y", 0.2);
  s.bodies = {{"arc", ArcMesh{{0.0, 0.0}, radius, 20.0, angle, 7}, LinearElastic{E, 0.3}, "", area},
              {"ball", PointMesh{{0.1, y}}, GroundedSpring{{{k, 0.5}, {0.5, 2.0}}}, "", 1.0}};
  s.obstacles = {{"slope", Plane{{0.0, y}, {tilt, 1.0}}, {}}};
  s.contacts = {scenes::contact("bars", "arc.interior", "slope"), scenes::contact("end", "arc.end", "slope"),
                scenes::contact("ball", "ball.node", "slope")};
  s.loads = {scenes::traction("arc.nodes", {1.0, k})};
  return s;
}

std::vector<Scene> all_scenes() {
  return {
      half_disks("lower.arc", 6),    half_disks("lower.arc", 5), half_disks("disk", 6), half_disks("cup", 6), lumped(),
      scenes::two_boxes(5, 7, "T3"), scenes::two_boxes(4, 8),    scenes::greco_plate(4)};
}

/// Every number of the slots that a residual reads, grouped by kind so that each kind has its own scale.
template <class T>
std::vector<Vector<T>> groups(const Model& model, const Slots<T>& slots) {
  std::vector<std::vector<T>> lists(7);
  for (const T& x : slots.points.reshaped()) lists[0].push_back(x);
  for (const auto& g : slots.geometry) {
    lists[1].push_back(g.gap);
    lists[2].insert(lists[2].end(), g.normal.begin(), g.normal.end());
    for (const T& x : g.tangents.reshaped()) lists[2].push_back(x);
    lists[3].insert(lists[3].end(), g.weights.begin(), g.weights.end());
    lists[4].push_back(g.area);
  }
  lists[5].assign(slots.stiffness.begin(), slots.stiffness.end());
  for (const auto& law : slots.friction) lists[6].push_back(law.slope_at_apex());
  std::vector<Vector<T>> out;
  for (const auto& list : lists) out.push_back(Eigen::Map<const Vector<T>>(list.data(), list.size()));
  for (const auto& load : slots.loads) out.push_back(load.all(model.dof_count()));
  const Vector<double> u = derivatives::arbitrary(model.dof_count());
  out.push_back(bulk_forces<T>(model, slots, u.unaryExpr([](double x) { return T(x); }), {}));
  return out;
}

/// Numbers of a scene with parameter j shifted by `step` times its weights.
template <class T>
Numbers<T> shifted(const Scene& scene, std::size_t j, const T& step) {
  auto numbers = scene.as<T>();
  for (const auto& [slot, weight] : scene.parameters[j].slots) numbers.at_slot[slot] += step * T(weight);
  return numbers;
}

/// Calls check(scene, parameter's index) for every parameter of every scene.
template <class Check>
void for_every_parameter(Check&& check) {
  for (const auto& scene : all_scenes()) {
    const Model model = make_model(scene);
    ASSERT_FALSE(model.points.empty());
    for (std::size_t j = 0; j < scene.parameters.size(); ++j) check(scene, model, j);
  }
}

std::vector<Vector<double>> by_dual(const Scene& scene, const Model& model, std::size_t j) {
  std::vector<Vector<double>> out;
  for (const auto& group : groups(model, make_slots<Direction>(model, shifted(scene, j, Direction::seed(0.0, 0)))))
    out.push_back(group.unaryExpr([](const Direction& x) { return x.d[0]; }));
  return out;
}

TEST(SlotDerivatives, AreThoseOfTheComplexStep) {
  constexpr double h = 1e-30;
  for_every_parameter([&](const Scene& scene, const Model& model, std::size_t j) {
    const auto dual = by_dual(scene, model, j);
    const auto complex =
        groups(model, make_slots<derivatives::Complex>(model, shifted(scene, j, derivatives::Complex(0, h))));
    for (std::size_t g = 0; g < dual.size(); ++g) {
      if (dual[g].size() == 0) continue;
      const Vector<double> exact = complex[g].imag() / h, here = complex[g].real();
      // some hundred operations; where the dependence cancels as a whole, relative to the terms that cancel
      const double size = std::max(largest_entry(exact), largest_entry(here) / std::abs(scene.parameters[j].value));
      EXPECT_LE(largest_entry(dual[g] - exact), 1e-12 * size) << scene.parameters[j].name << " group " << g;
    }
  });
}

TEST(SlotDerivatives, AreThoseOfDifferences) {
  for_every_parameter([&](const Scene& scene, const Model& model, std::size_t j) {
    const double h = 1e-5 * std::abs(scene.parameters[j].value);
    const auto dual = by_dual(scene, model, j);
    const auto up = groups(model, make_slots<double>(model, shifted(scene, j, h)));
    const auto down = groups(model, make_slots<double>(model, shifted(scene, j, -h)));
    const auto here = groups(model, make_slots<double>(model, scene.as<double>()));
    for (std::size_t g = 0; g < dual.size(); ++g) {
      const Vector<double> difference = (up[g] - down[g]) / (2 * h);
      if (dual[g].size() == 0) continue;
      // h^2 of the third derivative, for functions that change within a tenth of the parameter, and rounding over h
      const double allowed = 1e-7 * largest_entry(dual[g]) + 100 * epsilon * largest_entry(here[g]) / h;
      EXPECT_LE(largest_entry(dual[g] - difference), allowed) << scene.parameters[j].name << " group " << g;
    }
  });
}

TEST(SlotDerivatives, AreThereForEveryParameterOfTheseScenes) {
  for_every_parameter([&](const Scene& scene, const Model& model, std::size_t j) {
    if (scene.parameters[j].name == "down" || scene.parameters[j].name == "F") return;  // read at their time
    double largest = 0;
    for (const auto& group : by_dual(scene, model, j)) largest = larger(largest, largest_entry(group));
    if (scene.parameters[j].name != "rim" || scene.contacts[0].master != "lower.arc") {
      EXPECT_GT(largest, 0) << scene.parameters[j].name;
    }
  });
}

TEST(GapsAgainstBodies, AreThoseOfTheMovedPoints) {
  // g_0 + n.w is the gap after a displacement w only if g_0 is n.(x_s - y), whatever normal the two bodies share
  using Master = ContactPoint::Master;
  for (Master kind : {Master::facet, Master::vertex}) {
    int met = 0;
    for (const auto& scene : {half_disks("lower.arc", 6), half_disks("lower.arc", 5)}) {
      const Model model = make_model(scene);
      const auto slots = make_slots<double>(model, scene.as<double>());
      for (std::size_t p = 0; p < model.points.size(); ++p) {
        const auto& g = slots.geometry[p];
        if (model.points[p].master != kind) continue;
        ++met;
        double gap = 1e-3;  // the contact's offset
        const auto& nodes = model.points[p].nodes;
        for (std::size_t n = 0; n < nodes.size(); ++n) gap += g.weights[n] * g.normal.dot(slots.points.col(nodes[n]));
        EXPECT_NEAR(g.gap, gap, 20 * epsilon) << p;  // a dozen products of coordinates of the size of one
      }
    }
    EXPECT_GT(met, 0);
  }
}

TEST(NodalStiffness, OfAPointIsItsSpringAlongTheNormal) {
  Scene scene = scenes::stop(15, 1000);
  std::get<GroundedSpring>(scene.bodies[0].material).stiffness = {{300.0, 100.0}, {100.0, 1000.0}};
  auto stiffness = [&](double nx, double ny) {
    std::get<Plane>(scene.obstacles[0].shape).normal = {nx, ny};
    return make_slots<double>(make_model(scene), scene.as<double>()).stiffness[0];
  };
  EXPECT_NEAR(stiffness(0, -1), 1000, 1000 * 4 * epsilon);  // four products
  EXPECT_NEAR(stiffness(-1, 0), 300, 300 * 4 * epsilon);
  EXPECT_NEAR(stiffness(1, 1), 0.5 * 300 + 0.5 * 1000 + 100, 1000 * 8 * epsilon);
}

TEST(NodalStiffness, OfABarAcrossItsAxisIsTheMeanOverAllDirections) {
  Scene scene;
  scene.legs = {{1, 1}};
  scene.bodies = {{"chain", LineMesh{{0.0, 0.0}, {2.0, 0.0}, 2}, LinearElastic{10.0, 0.3}, "", 0.5}};
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}, {"wall", Plane{{0.0, 0.0}, {1.0, 0.0}}, {}}};
  scene.contacts = {scenes::contact("down", "chain.interior", "floor"),
                    scenes::contact("aside", "chain.interior", "wall")};
  const auto slots = make_slots<double>(make_model(scene), scene.as<double>());
  EXPECT_DOUBLE_EQ(slots.stiffness[0], 0.5 * (2 * 5 + 0));  // two bars of EA / L = 5
  EXPECT_DOUBLE_EQ(slots.stiffness[1], 2 * 5);
}

TEST(NodalStiffness, AgainstABodyIsTheHarmonicMeanOfTheTwoSides) {
  auto scene = scenes::two_boxes(4, 4);
  auto pair = [&](double E_upper, double E_lower) {
    std::get<LinearElastic>(scene.bodies[0].material).E = E_upper;
    std::get<LinearElastic>(scene.bodies[1].material).E = E_lower;
    return make_slots<double>(make_model(scene), scene.as<double>()).stiffness;
  };
  const auto both = pair(1000, 1500), rigid_master = pair(1000, 1e18), rigid_slave = pair(1e18, 1500);
  const auto stiff_slave = pair(1500e3, 1500);
  for (std::size_t p = 0; p < both.size(); ++p) {
    const double a = rigid_master[p] / 2, b = rigid_slave[p] / 2;         // of the softer side alone
    EXPECT_NEAR(both[p], 2 * a * b / (a + b), 1e-12 * both[p]);           // the rigid side's share is 1e-15
    EXPECT_NEAR(stiff_slave[p], 0.1 * 1500 * a, 1e-12 * stiff_slave[p]);  // a is of E = 1000
  }
  scene.bodies.pop_back();
  std::get<LinearElastic>(scene.bodies[0].material).E = 1000.0;
  scene.supports.erase(scene.supports.begin());
  scene.obstacles = {{"floor", Plane{{0.0, 0.0}, {0.0, 1.0}}, {}}};
  scene.contacts[0].master = "floor";
  scene.responses.clear();
  const auto alone = make_slots<double>(make_model(scene), scene.as<double>()).stiffness;
  for (std::size_t p = 0; p < alone.size(); ++p) EXPECT_NEAR(rigid_master[p], 2 * alone[p], 1e-12 * alone[p]);
}

Vector<double> total(const Scene& scene, int load) {
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  return slots.loads[load].all(model.dof_count()).reshaped(model.dimension, model.node_count).rowwise().sum();
}

TEST(Loads, AddUpToTheForceOrToTheTractionTimesTheLength) {
  auto scene = scenes::two_boxes(5, 7);
  scene.loads = {scenes::force("upper.top", {3.0, -2.0}), scenes::traction("upper.top", {3.0, -2.0}),
                 scenes::force("upper.top & upper.left", {3.0, -2.0})};
  for (int load = 0; load < 3; ++load) {
    const double length = load == 1 ? 1.6 : 1;
    EXPECT_NEAR(total(scene, load)[0], 3 * length, 20 * epsilon * 3);  // a dozen terms
    EXPECT_NEAR(total(scene, load)[1], -2 * length, 20 * epsilon * 3);
  }
}

TEST(Loads, ShareAForceByTributaryLength) {
  Scene scene;
  scene.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {4.0, 1.0};
  box.cells = {4, 1};
  scene.bodies = {{"block", box, LinearElastic{1.0, 0.3}, "", 1.0}};
  scene.loads = {scenes::force("block.bottom", {8.0, 0.0})};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const Vector<double> forces = slots.loads[0].all(model.dof_count());
  for (int node = 0; node < 5; ++node) EXPECT_DOUBLE_EQ(forces[2 * node], node == 0 || node == 4 ? 1 : 2);
}

TEST(Loads, ShareAForceByTributaryLengthOfUnequalEdges) {
  Scene scene;
  scene.legs = {{1, 1}};
  HalfDiskMesh disk;
  disk.center = {0.0, 0.0};
  disk.radius = 1.0;
  disk.cells = {4, 3};
  disk.grade = 3.0;
  scene.bodies = {{"disk", disk, LinearElastic{1.0, 0.3}, "", 1.0}};
  scene.loads = {scenes::force("disk.arc", {8.0, 0.0})};
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  const auto& side = model.bodies[0].mesh.sides.at("arc");
  Vector<double> tributary = Vector<double>::Zero(model.node_count);
  double longest = 0, shortest = 1;
  for (const auto& facet : side.facets) {
    const double length = (slots.points.col(facet[0]) - slots.points.col(facet[1])).norm();
    for (int node : facet) tributary[node] += length / 2;
    longest = larger(longest, length);
    shortest = smaller(shortest, length);
  }
  ASSERT_GT(longest, 1.5 * shortest);
  const Vector<double> forces = slots.loads[0].all(model.dof_count());
  for (int node : side.nodes)
    EXPECT_NEAR(forces[2 * node], 8 * tributary[node] / tributary.sum(), 100 * epsilon) << node;
}

TEST(Loads, GiveAForceToTheNamedNodesAlone) {
  auto scene = scenes::two_boxes(4, 4);
  scene.loads = {scenes::force("upper.top - upper.right", {3.0, -2.0})};
  scene.bodies.push_back({"chain", LineMesh{{0.0, 5.0}, {2.0, 5.0}, 2}, LinearElastic{10.0, 0.3}, "", 0.5});
  scene.loads.push_back(scenes::force("chain.interior", {3.0, -2.0}));
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  for (int load = 0; load < 2; ++load) {
    const auto nodes = model.side(scene.loads[load].on).nodes;
    double sum = 0;
    for (int node : nodes) sum += slots.loads[load].all(model.dof_count())[2 * node];
    EXPECT_NEAR(sum, 3, 20 * epsilon) << scene.loads[load].on;  // a dozen terms
  }
}

TEST(BulkForces, AreTheElementTangentsTimesTheDisplacements) {
  for (const auto& scene : all_scenes()) {
    const Model model = make_model(scene);
    const auto slots = make_slots<double>(model, scene.as<double>());
    const Vector<double> u = derivatives::arbitrary(model.dof_count());
    Vector<double> forces = Vector<double>::Zero(model.dof_count());
    double stiffest = 0;
    for (std::size_t b = 0; b < model.bodies.size(); ++b)
      for_each_element_tangent(model, slots, static_cast<int>(b), nullptr, [&](const auto& nodes, const auto& K) {
        stiffest = larger(stiffest, largest_entry(K));
        for (Eigen::Index i = 0; i < K.rows(); ++i)
          for (Eigen::Index j = 0; j < K.cols(); ++j)
            forces[nodes[i / 2] * 2 + i % 2] += K(i, j) * u[nodes[j / 2] * 2 + j % 2];
      });
    // some thirty products of displacements up to one
    EXPECT_LE(largest_entry(bulk_forces(model, slots, u, {}) - forces), 60 * epsilon * stiffest);
  }
}

TEST(BulkForces, VanishInARigidTranslationOfFreeBodies) {
  const auto scene = half_disks("lower.arc", 6);
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  Vector<double> u(model.dof_count());
  for (int node = 0; node < model.node_count; ++node) u.segment<2>(2 * node) << 0.3, -0.7;
  EXPECT_LE(largest_entry(bulk_forces(model, slots, u, {})), 60 * epsilon * 10 * 10);  // E times the worst stretch
}

}  // namespace
}  // namespace stickslip::slots_test
