/// Solid bodies of quadratic elements in space: uniform stress, order of convergence, the plane's answers, pressures
/// that follow their faces, and what contact makes of a uniform pressure.
#include <gtest/gtest.h>

#include <numbers>

#include "core/mesh/sides.hpp"
#include "tests/support/extruded.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::quadratic_solids_test {
namespace {

using Kind = Response::Kind;
using std::numbers::pi;

constexpr std::array elements{"T10", "H20", "H27"};

Support held(const std::string& on, const std::string& axes) {
  std::map<char, Table> move;
  for (const char axis : axes) move[axis] = scenes::table({{0, 0.0}});
  return scenes::support(on, move);
}

Scene block(const std::string& element, const Material& material, std::vector<int> cells) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 1}};
  BoxMesh box;
  box.min = {0.0, 0.0, 0.0};
  box.max = {2.0, 1.0, 1.5};
  box.cells = std::move(cells);
  s.bodies = {{"block", box, material, element, 1.0}};
  return s;
}

TEST(QuadraticSolids, HaveUniformStressUnderTractions) {
  for (const char* element : elements) {
    Scene s = block(element, LinearElastic{1000.0, 0.3}, {3, 2, 2});
    auto& box = std::get<BoxMesh>(s.bodies[0].mesh);
    box.grade = {{"right", 3.0}};
    s.supports = {held("block.left", "x"), held("block.front", "y"), held("block.bottom", "z")};
    s.loads = {scenes::traction("block.top", {0.0, 0.0, -10.0}),
               scenes::traction("block.right", {3.0, 0.0, 0.0}),
               {"block.back", Load::Kind::pressure, {4.0}, {}}};
    s.responses = {scenes::response("base", Kind::reaction, "block.bottom", "z")};
    const auto solved = scenes::run(s, MonolithicAL{});
    ASSERT_TRUE(is_converged(solved.trajectory.status));
    const Vec<double, 3> sigma(3, -4, -10);
    const Vec<double, 3> strain = (1.3 * sigma - Vec<double, 3>::Constant(0.3 * sigma.sum())) / 1000;
    const auto& u = solved.trajectory.increments.back().state.displacement;
    for (int node = 0; node < solved.model.node_count; ++node)
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(u[3 * node + i], strain[i] * solved.slots.points(i, node),
                    1e-13)  // as in the plane
            << element;
    EXPECT_NEAR(solved.value("base"), 20, 1e-10) << element;
  }
}

/// Quarter of Lame's tube, radii 1 and 2, under a pressure of 10 on its inner side, held along its axis: the error of
/// the displacement in the mean square over the body, over its largest value.
double tube_error(const std::string& element, int n) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 1}};
  const RingMesh ring = scenes::quarter_ring(n);
  const double E = 1000, nu = 0.3;
  s.bodies = {{"tube", ExtrudedMesh{ring, 0.0, 0.5, std::max(1, n / 2)}, LinearElastic{E, nu}, element, 1.0}};
  s.supports = {held("tube.start", "y"), held("tube.end", "x"), held("tube.front", "z"), held("tube.back", "z")};
  s.loads = {{"tube.inner", Load::Kind::pressure, {10.0}, {}}};
  s.responses = {scenes::response("energy", Kind::strain_energy, "")};
  const auto solved = scenes::run(s, MonolithicAL{});
  EXPECT_TRUE(is_converged(solved.trajectory.status)) << solved.trajectory.message;
  const auto& u = solved.trajectory.increments.back().state.displacement;
  const auto exact = [&](double r) {  // equilibrium of u = A r + B / r with Hooke's law
    return 10.0 / 3 * (1 + nu) / E * ((1 - 2 * nu) * r + 4 / r);
  };
  const auto& body = solved.model.bodies[0];
  double square = 0, volume = 0;
  with_shape(body.mesh.shape, [&]<class Shape>(Shape) {
    if constexpr (Shape::dimension == 3)
      for (int e = 0; e < body.mesh.element_count(); ++e) {
        Nodal<double, Shape> X, U;
        for (int a = 0; a < Shape::nodes; ++a) {
          const int node = body.mesh.connectivity[e * Shape::nodes + a];
          X.col(a) = solved.slots.points.col(node);
          for (int i = 0; i < 3; ++i) U(i, a) = u[3 * node + i];
        }
        for (const auto& point : Shape::quadrature()) {
          const double dV = Gradient<double, Shape>(point, X).volume;
          const Vec<double, 3> x = X * point.value, found = U * point.value;
          const double r = x.head<2>().norm();
          square += dV * (found - Vec<double, 3>(x[0], x[1], 0) * exact(r) / r).squaredNorm();
          volume += dV;
        }
      }
  });
  return std::sqrt(square / volume) / exact(1);
}

TEST(QuadraticSolids, ConvergeWithTheThirdOrderInTheMeanSquare) {
  for (const char* element : elements) {
    const double coarse = tube_error(element, 2), fine = tube_error(element, 4), order = std::log2(coarse / fine);
    EXPECT_GT(order, 2.7) << element;  // from below
    EXPECT_LT(fine, 1e-3) << element;
  }
}

/// A block of plane strain that nothing touches, pressed, pulled and drawn.
Scene loaded_block(const Material& material, bool finite) {
  Scene s;
  s.finite_strain = finite;
  s.legs = {{1, 2}};
  const Number width = scenes::parameter(s, "width", 2.0), down = scenes::parameter(s, "down", -0.08),
               thickness = scenes::parameter(s, "thickness", 0.7), pressure = scenes::parameter(s, "pressure", 9.0);
  BoxMesh box;
  box.max = {width, 1.0};
  box.cells = {4, 3};
  s.bodies = {{"block", box, material, "Q8", 1.0}};
  s.bodies[0].thickness = thickness;
  s.supports = {held("block.bottom", "xy"),
                scenes::support("block.top", {{'y', scenes::table({{0, 0.0}, {1, down}})}})};
  s.loads = {{"block.left", Load::Kind::pressure, {pressure}, {}},
             {"block.top", Load::Kind::traction, {4.0, 0.0}, {}},
             {"block", Load::Kind::body_force, {1.0, -2.0}, {}}};
  s.responses = {scenes::response("pull", Kind::reaction, "block.top", "y"),
                 scenes::response("side", Kind::displacement, "block.right & block.top", "x"),
                 scenes::response("energy", Kind::strain_energy, "")};
  return s;
}

/// H20 with nodes that agree along z has the functions of Q8, and those that it has besides see no other forces: its
/// points are the plane's, three times, and its faces' shares those of the plane's edges. (H27 has nodes within, hence
/// the functions of nine nodes: it is not as stiff. Shares of contact differ, see below.)
TEST(QuadraticSolids, OfH20HaveTheAnswersOfQ8InPlaneStrain) {
  for (const auto& [material, finite] : {std::pair{Material(LinearElastic{1000.0, 0.3}), false},
                                         {Material(J2Plastic{1000.0, 0.3, 12.0, 50.0}), false},
                                         {Material(NeoHookean{1000.0, 0.3, NeoHookean::Volumetric::log}), true},
                                         {Material(J2Plastic{1000.0, 0.3, 12.0, 50.0}), true}}) {
    const Scene plane = loaded_block(material, finite), space = scenes::extruded(plane);
    const auto one = scenes::run(plane, MonolithicAL{}), other = scenes::run(space, MonolithicAL{});
    ASSERT_TRUE(is_converged(one.trajectory.status)) << one.trajectory.message;
    ASSERT_TRUE(is_converged(other.trajectory.status)) << other.trajectory.message;
    EXPECT_EQ(other.model.bodies[0].mesh.shape, ElementShape::hex20);
    for (std::size_t n = 0; n < one.trajectory.increments.size(); ++n)
      for (Eigen::Index r = 0; r < static_cast<Eigen::Index>(plane.responses.size()); ++r) {
        const std::string& name = plane.responses[r].name;
        const double value = one.value(name, static_cast<int>(n));
        EXPECT_NEAR(other.value(name, static_cast<int>(n)), value, 1e-9 * std::abs(value)) << name << finite;
        const double size = largest_entry(one.gradients.of_responses[n].row(r));
        for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(plane.parameters.size()); ++j)
          EXPECT_NEAR(other.gradients.of_responses[n](r, j), one.gradients.of_responses[n](r, j), 1e-8 * size)
              << name << " by " << plane.parameters[j].name << finite;
      }
  }
}

TEST(QuadraticSolids, HaveThePressureThatFollowsTheirFaces) {
  for (const char* element : elements) {
    Scene s = block(element, NeoHookean{1000.0, 0.3}, {1, 1, 1});
    s.finite_strain = true;
    s.supports = {held("block.bottom", "xyz")};
    s.loads = {{"block.top", Load::Kind::pressure, {20.0}, {}}, {"block.left", Load::Kind::pressure, {-5.0}, {}}};
    const Model model = make_model(s);
    const auto slots = make_slots<double>(model, s.as<double>());
    Vector<double> u(model.dof_count());
    for (Eigen::Index k = 0; k < u.size(); ++k) u[k] = 0.05 * std::sin(1.7 * static_cast<double>(k) + 0.3);
    const Vector<double> none;
    Matrix<double> K = Matrix<double>::Zero(u.size(), u.size());
    for_each_follower_tangent<double>(model, slots, {u, none, 1.0},
                                      [&](const std::vector<int>& nodes, const Eigen::Ref<const Matrix<double>>& k) {
                                        for (std::size_t a = 0; a < nodes.size(); ++a)
                                          for (std::size_t b = 0; b < nodes.size(); ++b)
                                            K.block<3, 3>(3 * nodes[a], 3 * nodes[b]) +=
                                                k.block<3, 3>(3 * static_cast<int>(a), 3 * static_cast<int>(b));
                                      });
    // forces are quadratic in the displacements, so differences over a step of any size are exact
    Matrix<double> differences(u.size(), u.size());
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      Vector<double> more = u, less = u;
      more[k] += 0.5;
      less[k] -= 0.5;
      differences.col(k) = follower_forces(model, slots, 1.0, more) - follower_forces(model, slots, 1.0, less);
    }
    EXPECT_LE(largest_entry(K - differences), 1e-13 * largest_entry(K)) << element;
    EXPECT_GT(largest_entry(K), 0.1) << element;
    // a pressure all around has no resultant, whatever the motion
    s.loads = {{"block.boundary", Load::Kind::pressure, {20.0}, {}}};
    const Model closed = make_model(s);
    const auto around = follower_forces(closed, make_slots<double>(closed, s.as<double>()), 1.0, u);
    EXPECT_LE(around.reshaped(3, closed.node_count).rowwise().sum().norm(), 1e-13 * largest_entry(around)) << element;
  }
}

/// A block that stands on a floor under a uniform pressure.
scenes::Solved standing(const std::string& element) {
  Scene s = block(element, LinearElastic{1000.0, 0.0}, {4, 4, 2});
  s.obstacles = {{"floor", Plane{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}}, {}}};
  s.contacts = {scenes::contact("sole", "block.bottom", "floor")};
  s.supports = {held("block.left", "x"), held("block.front", "y")};
  s.loads = {scenes::traction("block.top", {0.0, 0.0, -10.0})};
  s.responses = {scenes::response("force", Kind::contact_force, "sole", "normal")};
  auto solved = scenes::run(s, MonolithicAL{});
  EXPECT_TRUE(is_converged(solved.trajectory.status)) << solved.trajectory.message;
  EXPECT_NEAR(solved.value("force"), 20, 1e-9) << element;
  return solved;
}

/// Consistent forces of a uniform pressure are int N dA, and tractions these over the areas of the nodes: one pressure
/// of faces of nine nodes. Of six and eight nodes the areas are those of facets, and the tractions alternate.
TEST(QuadraticSolids, BearAUniformPressureByOneTractionOnFacesOfNineNodesAlone) {
  const auto tractions = [](const scenes::Solved& solved) {
    std::vector<double> all;
    for (const auto& point : solved.model.points)
      all.push_back(-solved.trajectory.increments.back().state.contact.traction[point.multiplier] / 10);
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto error = [](const scenes::Solved& solved) {  // of u, from that of uniform stress
    const auto& u = solved.trajectory.increments.back().state.displacement;
    double worst = 0;
    for (int node = 0; node < solved.model.node_count; ++node)
      worst = larger(worst, std::abs(u[3 * node + 2] + 0.01 * solved.slots.points(2, node)));
    return worst / 0.015;
  };
  const auto tetrahedra = standing("T10"), tensor = standing("H27"), serendipity = standing("H20");
  EXPECT_LE(error(tetrahedra), 1e-10);
  EXPECT_LE(error(tensor), 1e-10);
  const auto of_tensor = tractions(tensor), of_tetrahedra = tractions(tetrahedra),
             of_serendipity = tractions(serendipity);
  EXPECT_NEAR(of_tensor.front(), 1, 1e-10);
  EXPECT_NEAR(of_tensor.back(), 1, 1e-10);
  EXPECT_NEAR(of_tetrahedra.front(), 0, 1e-9);  // corners: 0 over 1/12
  EXPECT_NEAR(of_tetrahedra.back(), 4.0 / 3, 1e-9);
  EXPECT_EQ(of_serendipity.front(), 0);  // corners lift off, since they should pull: others bear up to 1.5
  EXPECT_LE(error(serendipity), 0.03);   // 2.5 %
}

}  // namespace
}  // namespace stickslip::quadratic_solids_test
