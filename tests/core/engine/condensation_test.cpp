/// Condensation against dense algebra on the assembled stiffness.
#include "core/engine/condensation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/engine/body_matrix.hpp"
#include "tests/support/engine_problem.hpp"

namespace stickslip::condensation_test {
namespace {

using Eigen::MatrixXd;

/// Rounding times a condition number of some 1e3.
constexpr double condensed = 1e-11;

/// The whole stiffness in the frames, and its free dofs outside the contact.
struct Whole {
  MatrixXd K;
  std::vector<int> contact, interior;

  explicit Whole(const EngineProblem& problem)
      : K(MatrixXd::Zero(problem.model.dof_count(), problem.model.dof_count())) {
    const int D = problem.model.dimension;
    for (std::size_t b = 0; b < problem.model.bodies.size(); ++b)
      for_each_framed_tangent<double>(problem.model, problem.slots, static_cast<int>(b), nullptr,
                                      [&](const auto& nodes, const auto& k) {
                                        for (std::size_t i = 0; i < nodes.size() * D; ++i)
                                          for (std::size_t j = 0; j < nodes.size() * D; ++j)
                                            K(nodes[i / D] * D + i % D, nodes[j / D] * D + j % D) += k(i, j);
                                      });
    for (int node : problem.model.contact_nodes)
      for (int i = 0; i < D; ++i) contact.push_back(node * D + i);
    for (int dof : problem.model.free_dofs)
      if (std::find(contact.begin(), contact.end(), dof) == contact.end()) interior.push_back(dof);
  }
  MatrixXd inverse() const { return MatrixXd(K(interior, interior)).inverse(); }
};

std::vector<Scene> problems() {
  auto soft = scenes::two_boxes(5, 7);
  std::get<LinearElastic>(soft.bodies[0].material).E = 1e-6;
  return {scenes::two_boxes(5, 7), floating(5, true), floating(4, false), soft};
}

TEST(Condensation, IsTheSchurComplementOfTheBodies) {
  for (const auto& scene : problems()) {
    const EngineProblem problem(scene);
    const Whole whole(problem);
    const MatrixXd expected = MatrixXd(whole.K(whole.contact, whole.contact)) -
                              MatrixXd(whole.K(whole.contact, whole.interior)) * whole.inverse() *
                                  MatrixXd(whole.K(whole.interior, whole.contact));
    const auto condensation = problem.condensation();
    ASSERT_TRUE(condensation->valid()) << condensation->message();
    const MatrixXd& S = condensation->schur();
    EXPECT_EQ(S, S.transpose());
    for (Eigen::Index i = 0; i < S.rows(); ++i)
      for (Eigen::Index j = 0; j < S.cols(); ++j) {
        const int a = whole.contact[i], b = whole.contact[j];  // what cancels is of the size of K
        EXPECT_NEAR(S(i, j), expected(i, j), condensed * std::sqrt(whole.K(a, a) * whole.K(b, b)));
      }
  }
}

TEST(Condensation, ReducesRowsAndExpandsIncrements) {
  for (const auto& scene : problems()) {
    const EngineProblem problem(scene);
    const Whole whole(problem);
    const auto condensation = problem.condensation();
    const MatrixXd rows = problem.rows(3);
    const auto reduced = condensation->reduce(rows);
    const MatrixXd share =
        MatrixXd(whole.K(whole.contact, whole.interior)) * whole.inverse() * MatrixXd(rows(whole.interior, Eigen::all));
    const MatrixXd expected = MatrixXd(rows(whole.contact, Eigen::all)) - share;
    EXPECT_LT((reduced.kept - expected).norm(), condensed * (expected.norm() + share.norm()));

    MatrixXd compact(expected.rows(), 3);
    for (int j = 0; j < 3; ++j) compact.col(j) = derivatives::arbitrary(static_cast<int>(compact.rows()), 40 + j);
    const MatrixXd u = condensation->expand(compact, reduced.others);
    EXPECT_EQ(MatrixXd(u(whole.contact, Eigen::all)), compact);
    const MatrixXd inside = whole.inverse() * (MatrixXd(rows(whole.interior, Eigen::all)) -
                                               MatrixXd(whole.K(whole.interior, whole.contact)) * compact);
    EXPECT_LT((MatrixXd(u(whole.interior, Eigen::all)) - inside).norm(), condensed * inside.norm());
    for (const auto& constraint : problem.model.constraints) {
      const bool in_contact =
          std::find(whole.contact.begin(), whole.contact.end(), constraint.dof) != whole.contact.end();
      EXPECT_TRUE(in_contact || u.row(constraint.dof).norm() == 0);
    }
  }
}

TEST(Condensation, TakesOneFactorisationAndBacksolvesOnlyWhereTheFactorIsNotShown) {
  const EngineProblem problem(scenes::two_boxes(9, 11));
  const Counters counters = problem.condensation()->counters;
  EXPECT_EQ(counters.factorizations, 1);
  const auto contacts = static_cast<long>(problem.model.contact_nodes.size()) * 2;
  EXPECT_EQ(counters.backsolves, has_backend(Backend::cholmod) ? 0 : contacts);
}

TEST(Condensation, OfABodyThatNothingHoldsWithoutContactIsRefused) {
  auto scene = scenes::two_boxes(5, 7);
  BoxMesh loose;
  loose.min = {5.0, 5.0};
  loose.max = {6.0, 6.0};
  loose.cells = {3, 3};
  scene.bodies.push_back({"loose", loose, LinearElastic{1000.0, 0.3}, "", 1.0});
  const EngineProblem problem(scene);
  const auto condensation = problem.condensation();
  EXPECT_FALSE(condensation->valid());
  EXPECT_FALSE(condensation->message().empty());
}

}  // namespace
}  // namespace stickslip::condensation_test
