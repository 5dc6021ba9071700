/// What must not matter: units, rotation, the engine, a friction coefficient of zero; and the rate that theory
/// predicts.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/support/blocks.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::invariance_test {
namespace {

using scenes::all_methods;
using scenes::run;

std::vector<std::pair<Method, bool>> methods_and_discretisations() {
  std::vector<std::pair<Method, bool>> out;
  for (const auto& method : all_methods())
    for (bool segment : {false, true}) out.emplace_back(method, segment);
  return out;
}

/// The two boxes with lengths times `length` and stresses times `stress`.
Scene scaled_boxes(double length, double stress, bool segment) {
  Scene scene = scenes::two_boxes(6, 9);
  auto times = [&](Number& n, double factor) {
    n.value *= factor;
    if (n.slot >= 0) scene.numbers[n.slot] = n.value;
  };
  for (auto& body : scene.bodies) {
    auto& box = std::get<BoxMesh>(body.mesh);
    for (int i = 0; i < 2; ++i) {
      times(box.min[i], length);
      times(box.max[i], length);
    }
    times(std::get<LinearElastic>(body.material).E, stress);
  }
  times(scene.contacts[0].offset, length);
  for (auto& support : scene.supports)
    for (auto& [axis, table] : support.move)
      for (auto& [t, value] : table.points) times(value, length);
  scene.contacts[0].segment = segment;
  return scene;
}

TEST(Invariance, UnitsChangeNeitherThePathNorTheAnswer) {
  for (const auto& [method, segment] : methods_and_discretisations()) {
    const auto reference = run(scaled_boxes(1, 1, segment), method);
    // (counts to a hundred times the tolerance: nearer to it rounding decides the last one, and differs by processor)
    Method coarse = method;
    std::visit([](auto& options) { options.newton.tolerance *= 100; }, coarse);
    const auto counted = run(scaled_boxes(1, 1, segment), coarse);
    for (const auto& [length, stress] : {std::pair{1e3, 1e-6}, {1e6, 1e-12}, {1e-6, 1.0}, {39.37, 1.45e-4}}) {
      const auto s = run(scaled_boxes(length, stress, segment), method);
      const auto count = run(scaled_boxes(length, stress, segment), coarse);
      ASSERT_EQ(count.trajectory.increments.size(), counted.trajectory.increments.size());
      for (std::size_t n = 0; n < count.trajectory.increments.size(); ++n) {
        const auto &a = count.trajectory.increments[n], &b = counted.trajectory.increments[n];
        EXPECT_EQ(a.newton, b.newton) << name_of(method) << " " << length;
        EXPECT_EQ(a.augmentations, b.augmentations) << name_of(method) << " " << length;
        EXPECT_EQ(a.state.contact.state, b.state.contact.state);
      }
      // force per length; rounding of the scaled numbers, magnified by the conditioning
      EXPECT_NEAR(s.value("press") / (length * stress), reference.value("press"), 1e-9 * reference.value("press"));
      EXPECT_NEAR(s.derivative("press", "mu") / (length * stress), reference.derivative("press", "mu"),
                  1e-8 * std::abs(reference.value("press") / 0.3));
    }
  }
}

/// A box as an imported mesh, turned by `angle` about the origin and moved by `shift`, on a floor turned with it.
Scene turned_block(double angle, double shift) {
  const int n = 8;
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {2.0, 1.0};
  box.cells = {n, n / 2};
  ImportedMesh mesh;
  mesh.mesh = make_mesh(MeshDescription(box), "Q4", 2);
  const Points<double> flat = make_points<double>(MeshDescription(box), Numbers<double>{}, 2);
  const double c = std::cos(angle), s = std::sin(angle);
  auto turn = [&](double x, double y) { return Eigen::Vector2d(c * x - s * y, s * x + c * y); };
  mesh.points.resize(2, flat.cols());
  for (Eigen::Index i = 0; i < flat.cols(); ++i)
    mesh.points.col(i) = turn(flat(0, i), flat(1, i)) + Eigen::Vector2d::Constant(shift);
  Scene scene;
  scene.legs = {{2, 6}};
  const Number mu = scenes::parameter(scene, "mu", 0.3);
  scene.bodies = {{"block", mesh, LinearElastic{1000.0, 0.3}, "", 1.0}};
  const Eigen::Vector2d normal = turn(0, 1), down = turn(0, -0.01), side = turn(0.006, 0);
  scene.obstacles = {{"floor", Plane{{shift, shift}, {normal[0], normal[1]}}, {}}};
  scene.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  scene.contacts[0].friction = mu;
  std::map<char, Table> move;
  for (int i = 0; i < 2; ++i)
    move[static_cast<char>('x' + i)] = scenes::table({{0, 0.0}, {1, down[i]}, {2, down[i] + side[i]}});
  scene.supports = {scenes::support("block.top", move)};
  scene.responses = {scenes::response("press", Response::Kind::contact_force, "sole", "normal"),
                     scenes::response("heat", Response::Kind::dissipation, "sole")};
  return scene;
}

TEST(Invariance, RotationAndTranslationChangeNeitherThePathNorTheAnswer) {
  for (const auto& method : all_methods()) {
    const auto reference = run(turned_block(0, 0), method);
    for (const auto& [angle, shift] : {std::pair{37 * M_PI / 180, 0.0}, {-1.1, 0.0}, {37 * M_PI / 180, 2e3}}) {
      const auto s = run(turned_block(angle, shift), method);
      ASSERT_EQ(s.trajectory.increments.size(), reference.trajectory.increments.size());
      for (std::size_t n = 0; n < s.trajectory.increments.size(); ++n) {
        EXPECT_EQ(s.trajectory.increments[n].newton, reference.trajectory.increments[n].newton) << name_of(method);
        EXPECT_EQ(s.trajectory.increments[n].state.contact.state,
                  reference.trajectory.increments[n].state.contact.state);
      }
      // coordinates of 1e3 body sizes keep 1e-13 of a body, and a gap of 1e-2 of it 1e-11: 1e-9 with its magnification
      for (const char* name : {"press", "heat"})
        EXPECT_NEAR(s.value(name), reference.value(name), (shift > 0 ? 1e-8 : 1e-9) * reference.value(name));
    }
  }
}

TEST(Invariance, FrictionZeroAndNoFrictionAgreeAndTheLatterHasFewerUnknowns) {
  for (const auto& method : all_methods()) {
    auto without = scenes::two_boxes(6, 9);
    without.contacts[0].friction.reset();
    const auto zero = run(scenes::two_boxes(6, 9, "Q4", 0), method), none = run(without, method);
    for (const char* name : {"press", "peak", "energy", "pull"})
      EXPECT_NEAR(zero.value(name), none.value(name), 1e-12 * std::max(1.0, std::abs(none.value("press"))))
          << name_of(method);
    EXPECT_LT(none.model.multiplier_count, zero.model.multiplier_count);
    const auto& state = none.trajectory.increments.back().state;
    EXPECT_EQ(state.contact.slip.size() + state.history.placement.size() + state.history.work.size(), 0);
  }
}

/// A body of the scene as an imported mesh, its nodes and elements numbered backwards and each element begun at another
/// corner.
void renumber(Scene& scene, int body) {
  const Model model = make_model(scene);
  Mesh mesh = model.bodies[body].mesh;
  const int count = mesh.node_count, corners = nodes_of(mesh.shape);
  ImportedMesh imported;
  imported.body = scene.bodies[body].name;
  imported.points.resize(2, count);
  const auto points = initial_points(model, scene.as<double>());
  auto renamed = [&](int node) { return count - 1 - node; };
  for (int n = 0; n < count; ++n) imported.points.col(renamed(n)) = points.col(model.bodies[body].first_node + n);
  const auto before = mesh.connectivity;
  const int elements = mesh.element_count();
  for (int e = 0; e < elements; ++e)
    for (int a = 0; a < corners; ++a)
      mesh.connectivity[(elements - 1 - e) * corners + a] = renamed(before[e * corners + (a + 1) % corners]);
  for (auto& [name, side] : mesh.sides) {
    for (int& node : side.nodes) node = renamed(node);
    for (auto& facet : side.facets)
      for (int& node : facet) node = renamed(node);
  }
  imported.mesh = mesh;
  scene.bodies[body].mesh = imported;
}

TEST(Invariance, NumberingOfNodesElementsAndBodiesDoesNotMatter) {
  for (const auto& method : all_methods()) {
    Scene other = scenes::two_boxes(6, 9);
    for (int body : {0, 1}) renumber(other, body);
    std::swap(other.bodies[0], other.bodies[1]);
    const auto a = run(scenes::two_boxes(6, 9), method), b = run(other, method);
    ASSERT_EQ(a.trajectory.increments.size(), b.trajectory.increments.size());
    for (std::size_t n = 0; n < a.trajectory.increments.size(); ++n)
      EXPECT_EQ(a.trajectory.increments[n].newton, b.trajectory.increments[n].newton) << name_of(method) << " " << n;
    for (const auto& response : a.model.scene.responses)
      EXPECT_NEAR(a.value(response.name), b.value(response.name),
                  1e-10 * std::max(1.0, std::abs(a.value(response.name))))
          << name_of(method) << " " << response.name;
    EXPECT_NEAR(a.derivative("shear", "mu"), b.derivative("shear", "mu"), 1e-9 * std::abs(a.value("press")));
  }
}

TEST(Invariance, SparseAndCondensedEnginesAgree) {
  RunOptions sparse, condensed;
  sparse.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  condensed.linear_algebra.engine = LinearAlgebra::Engine::condensed;
  for (const auto& method : all_methods()) {
    const auto a = run(scenes::two_boxes(6, 9), method, sparse), b = run(scenes::two_boxes(6, 9), method, condensed);
    ASSERT_EQ(a.trajectory.increments.size(), b.trajectory.increments.size());
    for (const auto& response : a.model.scene.responses)
      EXPECT_NEAR(a.value(response.name), b.value(response.name),
                  1e-9 * std::max(1.0, std::abs(a.value(response.name))));
    for (const auto& parameter : a.model.scene.parameters)
      EXPECT_NEAR(a.derivative("shear", parameter.name), b.derivative("shear", parameter.name),
                  1e-8 * std::max(std::abs(a.value("press") / parameter.value),
                                  std::abs(a.derivative("shear", parameter.name))));
  }
}

TEST(Invariance, TheSameInputGivesTheSameBits) {
  for (const auto& method : all_methods()) {
    const auto a = run(scenes::two_boxes(6, 9), method), b = run(scenes::two_boxes(6, 9), method);
    expect_same_bits(a.trajectory, b.trajectory, std::string(name_of(method)));
    ASSERT_EQ(a.gradients.of_responses.size(), b.gradients.of_responses.size());
    for (std::size_t n = 0; n < a.gradients.of_responses.size(); ++n)
      EXPECT_EQ(a.gradients.of_responses[n], b.gradients.of_responses[n]) << n;
  }
}

/// Spectral radius of (I + rho S)^-1 for the final states of the GRECO plate: S = B_N-and-stuck-rows K^-1 (forces per
/// unit multiplier), built here from dense matrices.
double predicted_contraction(const scenes::Solved& s, double rho) {
  const auto& model = s.model;
  const int free = static_cast<int>(model.free_dofs.size());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(free, free);
  for_each_element_tangent(model, s.slots, 0, nullptr, [&](const auto& nodes, const auto& element) {
    for (std::size_t i = 0; i < nodes.size() * 2; ++i)
      for (std::size_t j = 0; j < nodes.size() * 2; ++j) {
        const int r = model.free_index[nodes[i / 2] * 2 + i % 2], c = model.free_index[nodes[j / 2] * 2 + j % 2];
        if (r >= 0 && c >= 0) K(r, c) += element(i, j);
      }
  });
  std::vector<Eigen::VectorXd> constraints, forces;
  const auto& contact = s.trajectory.increments.back().state.contact;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    if (contact.state[p] == ContactState::open) continue;
    const int node = model.points[p].nodes[0], t = model.free_index[node * 2], n = model.free_index[node * 2 + 1];
    const double area = s.slots.geometry[p].area, frame = s.slots.geometry[p].tangents(0, 0);
    Eigen::VectorXd along = Eigen::VectorXd::Zero(free), normal = along;
    along[t] = frame;
    normal[n] = 1;
    const bool stick = contact.state[p] == ContactState::stick;
    const double sign = contact.traction[model.points[p].multiplier + 1] < 0 ? -1 : 1;
    constraints.push_back(normal);
    forces.push_back(area *
                     (stick ? normal : Eigen::VectorXd(normal - s.slots.friction[0].slope_at_apex() * sign * along)));
    if (stick) {
      constraints.push_back(along);
      forces.push_back(area * along);
    }
  }
  const auto factor = K.ldlt();
  const auto m = static_cast<Eigen::Index>(constraints.size());
  Eigen::MatrixXd S(m, m);
  for (Eigen::Index j = 0; j < m; ++j) {
    const Eigen::VectorXd u = factor.solve(forces[j]);
    for (Eigen::Index i = 0; i < m; ++i) S(i, j) = constraints[i].dot(u);
  }
  const Eigen::MatrixXd step = (Eigen::MatrixXd::Identity(m, m) + rho * S).inverse();
  return largest_entry(Eigen::EigenSolver<Eigen::MatrixXd>(step).eigenvalues());
}

TEST(UzawaRate, IsTheSpectralRadiusThatTheFinalStatesPredict) {
  int compared = 0;
  for (int n : {8, 16, 20})
    for (double mu : {0.0, 0.1, 0.5, 1.0})
      for (double multiple : {0.05, 0.1, 0.5, 2.0, 4.0, 6.0, 8.0}) {
        const double rho = multiple * 1.3e11 * n / 0.04;  // of the order of E / h
        UzawaAL method;
        method.scale = scenes::absolute(rho);
        method.adapt = false;
        method.tolerance = 1e-12;  // many updates, so that the last show the asymptotic ratio
        method.max_augmentations = 3000;
        const auto s = run(scenes::greco_plate(n, mu), method);
        ASSERT_TRUE(is_converged(s.trajectory.status));
        const double q = predicted_contraction(s, rho);
        if (q < 0.1 || q > 0.95) continue;
        ++compared;
        // rounding leaves room for ten updates at q = 0.1, in which the slowest mode has little share
        EXPECT_NEAR(s.trajectory.increments.back().contraction, q, 0.05 * q) << n << " " << mu << " " << multiple;
      }
  EXPECT_GE(compared, 75);
}

}  // namespace
}  // namespace stickslip::invariance_test
