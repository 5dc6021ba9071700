// The contact patch test: two blocks under uniform pressure; the contact pressure must be uniform too, whatever the two
// meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>

#include "tests/support/contact_traction.hpp"

namespace stickslip::patch_test {
namespace {

using namespace scenes;

/// Block of m x 3 quadrilaterals between the lines y = low(x) and y = high(x), 0 <= x <= 1; sides as a box.
ImportedMesh block(int m, double (*low)(double), double (*high)(double)) {
  constexpr int rows = 3;
  BoxMesh box;
  box.min = {0.0, 0.0};
  box.max = {1.0, 1.0};
  box.cells = {m, rows};
  ImportedMesh imported{"", "", make_mesh(box, "Q4", 2), make_points<double>(box, {}, 2)};
  for (Eigen::Index n = 0; n < imported.points.cols(); ++n) {
    const double x = imported.points(0, n), share = imported.points(1, n);
    imported.points(1, n) = (1 - share) * low(x) + share * high(x);
  }
  return imported;
}

double zero(double) { return 0; }
double one(double) { return 1; }
double skew(double x) { return 1 + 0.3 * x; }
double two(double) { return 2; }

/// A7: the lower block carries the master side with `master` cells, the upper one the slave side.
Scene stacked(int slave, int master, bool skewed, double nu, std::optional<double> mu, bool segment) {
  Scene s;
  s.legs = {{1, 1}};
  s.bodies = {{"upper", block(slave, skewed ? skew : one, two), LinearElastic{1000.0, nu}, "", 1.0},
              {"lower", block(master, zero, skewed ? skew : one), LinearElastic{1000.0, nu}, "", 1.0}};
  s.contacts = {contact("touch", "upper.bottom", "lower.top")};
  if (mu) s.contacts[0].friction = *mu;
  s.contacts[0].segment = segment;
  s.loads = {traction("upper.top", {0.0, -10.0})};
  s.supports = {support("lower.bottom", {{'y', table({{0, 0.0}})}}),
                support("lower.bottom & lower.left", {{'x', table({{0, 0.0}})}}),
                support("upper.top & upper.left", {{'x', table({{0, 0.0}})}})};
  s.responses = {response("top", Response::Kind::displacement, "upper.top", "y")};
  return s;
}

/// Largest relative error of the contact tractions against -10 e_y.
double traction_error(const Solved& s) {
  double worst = 0;
  for (std::size_t p = 0; p < s.model.points.size(); ++p) {
    // the force on the slave is -t A, A along the interface: a vertical pressure p per horizontal length on it
    const double slope = std::abs(s.slots.geometry[p].normal[1]);
    worst = larger(worst, (contact_traction(s, p) - Eigen::Vector2d(0, -10 * slope)).norm() / 10);
  }
  return worst;
}

std::vector<Method> patch_methods() {
  UzawaAL uzawa;
  uzawa.scale = relative(1e3);
  uzawa.tolerance = 1e-13;
  return {MonolithicAL{}, uzawa};
}

TEST(ContactPatch, PassesWithSegmentIntegrationBetweenAnyTwoMeshes) {
  const std::pair<int, int> cells[] = {{4, 4}, {8, 4}, {4, 8}, {3, 4}, {5, 4}, {7, 11}};
  for (const auto& [slave, master] : cells)
    for (bool skewed : {false, true})
      for (double nu : {0.0, 0.3})
        for (std::optional<double> mu : {std::optional<double>(), std::optional<double>(10)})
          for (const auto& method : patch_methods()) {
            if (skewed && !mu) continue;  // without friction the upper block slides off
            const auto s = run(stacked(slave, master, skewed, nu, mu, true), method);
            ASSERT_TRUE(is_converged(s.trajectory.status)) << slave << ":" << master << " " << name_of(method);
            // equilibrium is solved to 1e-12 of the largest nodal force, which a condition of some 10 magnifies
            EXPECT_LT(traction_error(s), 1e-10) << slave << ":" << master << " skew " << skewed << " nu " << nu
                                                << " mu " << mu.value_or(-1) << " " << name_of(method);
            const double E = 1000 / (1 - nu * nu);
            EXPECT_NEAR(s.value("top"), -10 * 2 / E, 1e-10 * 20 / E);
          }
}

TEST(ContactPatch, PassesWithThePenaltyMethodUpToTheUniformPenetration) {
  for (auto [slave, master] : {std::pair{3, 4}, std::pair{7, 11}}) {
    Penalty penalty;
    const double eps = 1e6;
    penalty.stiffness = absolute(eps);
    const auto s = run(stacked(slave, master, false, 0.3, 10, true), penalty);
    EXPECT_LT(traction_error(s), 1e-10);  // as above
    EXPECT_NEAR(s.value("top"), -20 * 0.91 / 1000 - 10 / eps, 1e-10 * 20 / 1000);
  }
}

/// Node-to-segment passes where every master node is a slave node too, and else errs by what follows from
/// the lumped slave forces: the expected failures.
TEST(ContactPatch, FailsWithNodeToSegmentWhereMeshesDoNotMatchByTheDerivedAmount) {
  struct Row {
    int slave, master;
    double error;  // largest nodal master load error, relative to its own tributary load
  };
  const Row rows[] = {{4, 4, 0},     {8, 4, 0},    {12, 4, 0},    {4, 8, 1.0},   {3, 4, 0.333},
                      {4, 3, 0.125}, {5, 4, 0.12}, {6, 4, 0.111}, {13, 4, 0.018}};
  for (const auto& row : rows) {
    const auto s = run(stacked(row.slave, row.master, false, 0, std::nullopt, false), MonolithicAL{});
    // the load that a uniform pressure p on the slave nodes brings to the master nodes
    std::map<int, double> load;
    for (std::size_t p = 0; p < s.model.points.size(); ++p) {
      const auto& point = s.model.points[p];
      for (std::size_t n = 1; n < point.nodes.size(); ++n)
        load[point.nodes[n]] -= s.slots.geometry[p].area * s.slots.geometry[p].weights[n];
    }
    const auto side = s.model.side("lower.top");
    double worst = 0;
    for (int node : side.nodes) {
      const bool end = node == side.nodes.front() || node == side.nodes.back();
      const double share = (end ? 0.5 : 1.0) / row.master;
      worst = larger(worst, std::abs(load[node] / share - 1));
    }
    EXPECT_NEAR(worst, row.error, row.error == 0 ? 1e-12 : 5e-4 + 0.01 * row.error)  // the printed digits
        << row.slave << ":" << row.master;
    if (row.error == 0)
      EXPECT_LT(traction_error(s), 1e-10);
    else
      EXPECT_GT(traction_error(s), 1e-3);
  }
}

}  // namespace
}  // namespace stickslip::patch_test
