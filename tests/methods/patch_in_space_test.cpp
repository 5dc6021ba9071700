// The contact patch test in space: two blocks under uniform pressure, whose faces do not match; the pressure of
// segment-integrated contact must be uniform too, whatever the two meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/support/contact_traction.hpp"

namespace stickslip::patch_in_space_test {
namespace {

using namespace scenes;

struct Pair {
  const char *slave_element, *master_element;
  std::array<int, 2> slave, master;
};

constexpr double pressure = 10;

/// A block of n x m x 1 cells in [0, 1] x [0, 0.8] x [low, high].
BoxMesh box(const std::array<int, 2>& cells, double low, double high) {
  BoxMesh mesh;
  mesh.min = {0.0, 0.0, low};
  mesh.max = {1.0, 0.8, high};
  mesh.cells = {cells[0], cells[1], 1};
  return mesh;
}

/// Two blocks, of which the upper one carries the slave side.
Scene stacked(const Pair& pair, std::optional<double> mu, double nu = 0.3) {
  Scene s;
  s.space = Space::solid;
  s.legs = {{1, 1}};
  s.bodies = {{"upper", box(pair.slave, 1, 2), LinearElastic{1000.0, nu}, pair.slave_element, 1.0},
              {"lower", box(pair.master, 0, 1), LinearElastic{1000.0, nu}, pair.master_element, 1.0}};
  s.contacts = {contact("touch", "upper.bottom", "lower.top")};
  s.contacts[0].segment = true;
  if (mu) s.contacts[0].friction = *mu;
  s.loads = {traction("upper.top", {0.0, 0.0, -pressure})};
  const Table still = table({{0, 0.0}});
  s.supports = {support("lower.bottom", {{'z', still}}), support("lower.bottom & lower.left", {{'x', still}}),
                support("upper.top & upper.left", {{'x', still}}),
                support("lower.bottom & lower.front", {{'y', still}}),
                support("upper.top & upper.front", {{'y', still}})};
  s.responses = {response("top", Response::Kind::displacement, "upper.top", "z")};
  return s;
}

/// Largest relative error of the contact tractions against the pressure.
double traction_error(const Solved& s) {
  double worst = 0;
  for (std::size_t p = 0; p < s.model.points.size(); ++p)
    worst = larger(worst, (contact_traction(s, p) - Eigen::Vector3d(0, 0, -pressure)).norm() / pressure);
  return worst;
}

TEST(ContactPatchInSpace, PassesWithSegmentIntegrationBetweenAnyTwoMeshes) {
  const Pair pairs[] = {{"H8", "H8", {3, 2}, {2, 3}},   {"H8", "H8", {2, 2}, {4, 4}},   {"T4", "T4", {3, 2}, {2, 3}},
                        {"T4", "H8", {2, 3}, {3, 2}},   {"H8", "T4", {2, 3}, {3, 2}},   {"H27", "H27", {2, 1}, {1, 2}},
                        {"H20", "H20", {2, 1}, {1, 2}}, {"T10", "T10", {2, 1}, {1, 2}}, {"T10", "H8", {2, 1}, {3, 2}},
                        {"H8", "H20", {3, 2}, {1, 2}}};
  for (const auto& pair : pairs)
    for (const std::optional<double> mu : {std::optional<double>(), std::optional<double>(10)}) {
      UzawaAL uzawa;
      uzawa.scale = relative(1e3);
      uzawa.tolerance = 1e-13;
      for (const Method& method : {Method(MonolithicAL{}), Method(uzawa)}) {
        SCOPED_TRACE(std::string(pair.slave_element) + " on " + pair.master_element + ", " +
                     std::string(name_of(method)) + (mu ? ", friction" : ""));
        const auto s = run(stacked(pair, mu), method);
        ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
        // equilibrium is solved to 1e-12 of the largest nodal force, which a condition of some 10 magnifies
        EXPECT_LT(traction_error(s), 1e-10);
        EXPECT_NEAR(s.value("top"), -2 * pressure / 1000, 1e-10 * 2 * pressure / 1000);
      }
    }
}

/// Weights of a quadrilateral that is no parallelogram are no polynomials in its plane: an error is left, which falls
/// fast as cells do.
TEST(ContactPatchInSpace, ErrsByTheQuadratureOnSkewedQuadrilaterals) {
  const auto error = [](int n) {
    Scene s = stacked({"H8", "H8", {1, 1}, {1, 1}}, {}, 0);
    for (int b = 0; b < 2; ++b) {
      QuadMesh quad;
      quad.corners = {{{0.0, 0.0}, {4.0, 0.5}, {3.0, 2.5}, {0.6, 2.0}}};
      quad.cells = b == 0 ? std::array{3 * n, 2 * n} : std::array{2 * n, 3 * n};
      if (b == 1) quad.grade = {{"left", 3.0}, {"bottom", 2.0}};
      s.bodies[b].mesh = ExtrudedMesh{quad, b == 0 ? 1.0 : 0.0, b == 0 ? 2.0 : 1.0, 1};
    }
    s.contacts[0].slave = "upper.front";
    s.contacts[0].master = "lower.back";
    s.loads[0].on = "upper.back";
    const Table still = table({{0, 0.0}});
    s.supports = {support("lower.front", {{'x', still}, {'y', still}, {'z', still}}),
                  support("upper.back", {{'x', still}, {'y', still}})};
    s.responses.clear();
    const auto solved = run(s, MonolithicAL{});
    EXPECT_TRUE(is_converged(solved.trajectory.status)) << solved.trajectory.message;
    return traction_error(solved);
  };
  const double coarse = error(1), fine = error(2);
  EXPECT_LT(coarse, 1e-8);  // 1e-9, as docs/decisions.md has it
  EXPECT_GT(coarse, 1e-11);
  EXPECT_LT(fine, 0.1 * coarse);
}

/// Nodes that carry no multiplier leave their share to the others of their facets: of a pressure nothing is lost.
TEST(ContactPatchInSpace, PassesIfSomeNodesOfTheSlaveSideCarryNothing) {
  for (const Pair& pair : {Pair{"H8", "H8", {3, 2}, {2, 3}}, {"T4", "T4", {3, 2}, {2, 3}}}) {
    auto scene = stacked(pair, {});
    scene.contacts[0].slave = "upper.bottom - upper.left";
    const auto s = run(scene, MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    EXPECT_LT(traction_error(s), 1e-10);  // as above
  }
}

/// With springs of one stiffness the overlap is uniform.
TEST(ContactPatchInSpace, PassesWithThePenaltyMethodUpToTheUniformPenetration) {
  const double eps = 1e6;
  Penalty penalty;
  penalty.stiffness = absolute(eps);
  for (const Pair& pair : {Pair{"H8", "H8", {3, 2}, {2, 3}}, {"T10", "H20", {1, 2}, {2, 1}}}) {
    const auto s = run(stacked(pair, 10), penalty);
    ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
    EXPECT_LT(traction_error(s), 1e-10);  // as above
    EXPECT_NEAR(s.value("top"), -2 * pressure / 1000 - pressure / eps, 1e-10 * 2 * pressure / 1000);
  }
}

/// Nodes on faces fail where meshes do not match: the reason for segments.
TEST(ContactPatchInSpace, FailsWithNodesOnFaces) {
  auto scene = stacked({"H8", "H8", {3, 2}, {2, 3}}, {});
  scene.contacts[0].segment = false;
  const auto s = run(scene, MonolithicAL{});
  ASSERT_TRUE(is_converged(s.trajectory.status)) << s.trajectory.message;
  EXPECT_GT(traction_error(s), 1e-2);
}

/// A side against obstacles: a plane bears the uniform pressure of sides of all elements.
TEST(ContactPatchInSpace, PassesOnAPlane) {
  for (const char* element : {"H8", "T4", "T10", "H20", "H27"}) {
    auto scene = stacked({element, "H8", {2, 1}, {1, 1}}, {});
    scene.bodies.pop_back();
    std::erase_if(scene.supports, [](const Support& support) { return support.on.starts_with("lower"); });
    scene.obstacles = {{"floor", Plane{{0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}}, {}}};
    scene.contacts[0].master = "floor";
    const auto s = run(scene, MonolithicAL{});
    ASSERT_TRUE(is_converged(s.trajectory.status)) << element << s.trajectory.message;
    EXPECT_LT(traction_error(s), 1e-10) << element;  // as above
  }
}

}  // namespace
}  // namespace stickslip::patch_in_space_test
