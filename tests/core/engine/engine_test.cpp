/// The two engines alone: tangents that belong to the residual, and the condensation against the bodies in full.
#include <gtest/gtest.h>

#include "core/model/contact_assembly.hpp"
#include "tests/support/compiled_slots.hpp"
#include "tests/support/engine_problem.hpp"
#include "tests/support/largest.hpp"

namespace stickslip::engine_test {
namespace {

std::vector<Scene> scenes_with_and_without_friction() {
  auto without = scenes::two_boxes(5, 7);
  without.contacts[0].friction.reset();
  return {scenes::two_boxes(5, 7), scenes::two_boxes(6, 6, "T3"), scenes::greco_plate(4), without};
}

/// Derivative of all rows of the residual along an increment (all dofs, scaled multipliers), in the problem's branches.
BlockVector<double> along(const EngineProblem& problem, const Vector<double>& du, const Vector<double>& dl,
                          bool unknown) {
  auto lift = [](double x) { return Direction(x); };
  const auto slots = make_slots<Direction>(problem.model, problem.scene.as<Direction>());
  RegularisationField<Direction> rho;
  for (const auto& r : problem.rho) rho.push_back({Direction(r.normal), Direction(r.tangential)});
  History<Direction> previous;
  for_each_part([&](Vector<Direction>& part, const Vector<double>& values) { part = values.unaryExpr(lift); }, previous,
                problem.previous);
  Vector<Direction> u = problem.u.unaryExpr(lift), multiplier = problem.multiplier.unaryExpr(lift);
  for (Eigen::Index i = 0; i < u.size(); ++i) u[i].d[0] = du[i];
  for (std::size_t p = 0; unknown && p < rho.size(); ++p)
    for (int c = 0; c < problem.model.points[p].components(); ++c) {
      const int k = problem.model.points[p].multiplier + c;
      multiplier[k].d[0] = dl[k] * (c == 0 ? problem.rho[p].normal : problem.rho[p].tangential);
    }
  const ContactInput<Direction> input{problem.model, slots, rho, previous, ConeRadius::augmented, 1.0};
  const auto field = evaluate_contact<Direction>(input, to_compact(problem.model, u), multiplier, &problem.states);
  Vector<Direction> rows = bulk_forces(problem.model, slots, u, {});
  add_compact(problem.model, contact_forces(problem.model, slots, field), rows);
  const Vector<Direction> rows_l = multiplier_residual(problem.model, slots, field.traction, multiplier);
  auto derivative = [](const Direction& x) { return x.d[0]; };
  return {rows.unaryExpr(derivative), rows_l.unaryExpr(derivative)};
}

TEST(Engines, SolveWithTheDerivativeOfTheResidual) {
  for (const auto& scene : scenes_with_and_without_friction())
    for (bool unknown : {false, true}) {
      const EngineProblem problem(scene);
      const Matrix<double> r = problem.rows(1);
      const Matrix<double> l =
          unknown ? Matrix<double>(derivatives::arbitrary(problem.model.multiplier_count, 20)) : Matrix<double>();
      auto check = [&](auto engine) {
        Counters counters;
        engine.begin(1.0, problem.u, {});
        ASSERT_TRUE(engine.factorise(problem.tangents(), counters)) << engine.message();
        const auto reduced = engine.reduce(r);
        const auto step = engine.solve({reduced.kept, l});
        const Vector<double> du = engine.expand(step.u, reduced.others);
        auto rows = along(problem, du, step.l.size() ? Vector<double>(step.l) : Vector<double>(), unknown);
        for (const auto& constraint : problem.model.constraints) {
          EXPECT_EQ(du[constraint.dof], 0);
          rows.u.row(constraint.dof).setZero();
        }
        EXPECT_LE(derivatives::relative_difference(rows.u, r), solved) << engine.name();
        if (unknown) {
          EXPECT_LE(derivatives::relative_difference(rows.l, l), solved) << engine.name();
        }
      };
      check(problem.sparse(unknown));
      check(problem.condensed(unknown));
    }
}

TEST(Engines, SolveSeveralColumnsAsTheySolveEach) {
  const EngineProblem problem(scenes::two_boxes(5, 7));
  auto check = [&](auto engine) {
    Counters counters;
    ASSERT_TRUE(engine.factorise(problem.tangents(), counters));
    const Matrix<double> r = problem.rows(3), l = derivatives::arbitrary(3 * problem.model.multiplier_count, 30)
                                                      .reshaped(problem.model.multiplier_count, 3);
    const Matrix<double> reduced = engine.reduce(r).kept;
    const auto all = engine.solve({reduced, l});
    for (int j = 0; j < 3; ++j) {
      const auto one = engine.solve({reduced.col(j), l.col(j)});
      EXPECT_LE(derivatives::relative_difference(all.u.col(j), one.u), solved);
      EXPECT_LE(derivatives::relative_difference(all.l.col(j), one.l), solved);
    }
  };
  check(problem.sparse(true));
  check(problem.condensed(true));
}

TEST(Engines, HaveOneResidualOnceTheInteriorIsInEquilibrium) {
  auto scene = scenes::two_boxes(5, 7);
  scene.loads = {scenes::traction("upper.left", {3.0, -2.0})};
  const EngineProblem problem(scene);
  const double time = 2.5;  // the supports have moved
  auto sparse = problem.sparse(false);
  auto condensed = problem.condensed(false);
  const Vector<double> u0 = sparse.begin(time, problem.u, {}), compact = condensed.begin(time, problem.u, {});
  EXPECT_EQ(compact, to_compact(problem.model, u0));
  const Vector<double> all = condensed.all(compact);
  EXPECT_EQ(to_compact(problem.model, all), compact);
  for (const auto& constraint : problem.model.constraints) EXPECT_EQ(all[constraint.dof], u0[constraint.dof]);
  const Vector<double> contact = derivatives::arbitrary(static_cast<int>(compact.size()), 4);
  ForceScale scale_of_sparse, scale_of_condensed;
  const Vector<double> rows = sparse.residual(all, contact, scale_of_sparse);
  const Vector<double> reduced = condensed.residual(compact, contact, scale_of_condensed);
  // forces of E times 0.01 that cancel in the interior, some fifty to a row, and the condition of the bodies
  const double rounding = 1e-12 * scale_of_sparse.force;
  std::vector<bool> at_contact(problem.model.node_count, false);
  for (std::size_t n = 0; n < problem.model.contact_nodes.size(); ++n) {
    const int node = problem.model.contact_nodes[n];
    at_contact[node] = true;
    EXPECT_LE((rows.segment<2>(2 * node) - reduced.segment<2>(2 * n)).norm(), rounding);
  }
  for (int dof : problem.model.free_dofs)
    if (!at_contact[dof / 2]) {
      EXPECT_LE(std::abs(rows[dof]), rounding);
    }
}

TEST(Engines, ApplyTheStiffnessThatTheyCondense) {
  for (const auto& scene : scenes_with_and_without_friction()) {
    const EngineProblem problem(scene);
    auto sparse = problem.sparse(false);
    auto condensed = problem.condensed(false);
    const int contacts = static_cast<int>(problem.model.contact_nodes.size()) * 2;
    Matrix<double> du(contacts, 2);
    du << derivatives::arbitrary(contacts, 5), derivatives::arbitrary(contacts, 6);
    for (int i = 0; i < contacts; ++i)
      if (!condensed.is_free(i)) du.row(i).setZero();
    const Matrix<double> none = Matrix<double>::Zero(problem.model.dof_count(), 2);
    const Matrix<double> full = sparse.apply_stiffness(condensed.expand(du, condensed.reduce(none).others));
    const Matrix<double> small = condensed.apply_stiffness(du);
    const double largest = largest_entry(small);
    for (int i = 0; i < contacts; ++i)
      if (condensed.is_free(i)) {
        const int dof = problem.model.contact_nodes[i / 2] * 2 + i % 2;
        EXPECT_LE(largest_entry(full.row(dof) - small.row(i)), solved * largest);
      }
    // forces that the bulk has for the same displacements
    const Vector<double> whole = condensed.expand(du.col(0), condensed.reduce(none.col(0)).others);
    const Vector<double> forces = bulk_forces(problem.model, problem.slots, whole, {});
    for (int dof : problem.model.free_dofs) EXPECT_NEAR(full(dof, 0), forces[dof], solved * largest);
  }
}

TEST(Engines, ReduceRowsToTheWorkTheyDoOnContactMotions) {
  // r_c - K_ci K_ii^-1 r_i is the work of r on the motions that contact dofs cause
  const EngineProblem problem(scenes::two_boxes(5, 7));
  auto condensed = problem.condensed(false);
  const Matrix<double> r = problem.rows(1), none = Matrix<double>::Zero(r.rows(), 1);
  const Vector<double> reduced = condensed.reduce(r).kept;
  for (Eigen::Index i = 0; i < reduced.size(); ++i) {
    if (!condensed.is_free(i)) continue;
    const Vector<double> motion =
        condensed.expand(Vector<double>::Unit(reduced.size(), i), condensed.reduce(none).others);
    EXPECT_NEAR(reduced[i], motion.dot(r.col(0)), solved * motion.norm() * r.norm());
  }
}

TEST(Engines, ScatterForcesToTheContactNodes) {
  const EngineProblem problem(scenes::two_boxes(5, 7));
  const auto sparse = problem.sparse(false);
  const auto condensed = problem.condensed(false);
  const Vector<double> forces = derivatives::arbitrary(static_cast<int>(problem.model.contact_nodes.size()) * 2);
  EXPECT_EQ(condensed.scatter(forces), forces);
  const Vector<double> all = sparse.scatter(forces);
  EXPECT_EQ(to_compact(problem.model, all), forces);
  EXPECT_EQ((all.array() != 0).count(), forces.size());
}

TEST(Engines, CountTheirUnknowns) {
  const EngineProblem problem(scenes::two_boxes(5, 7));
  const int free = static_cast<int>(problem.model.free_dofs.size()), multipliers = problem.model.multiplier_count;
  const int contacts = 2 * static_cast<int>(problem.model.contact_nodes.size());
  EXPECT_EQ(problem.sparse(false).unknowns(), free);
  EXPECT_EQ(problem.sparse(true).unknowns(), free + multipliers);
  EXPECT_EQ(problem.condensed(false).unknowns(), contacts);
  EXPECT_EQ(problem.condensed(true).unknowns(), contacts + multipliers);
}

TEST(Condensation, HasASymmetricSchurComplementWithTheRigidModesOfAFreeBody) {
  const EngineProblem problem(floating(5, false));
  const auto condensation = problem.condensation();
  ASSERT_TRUE(condensation->valid());
  const Matrix<double>& S = condensation->schur();
  EXPECT_EQ(S, S.transpose());
  Vector<double> aside = Vector<double>::Zero(S.rows());
  for (std::size_t n = 0; n < problem.model.contact_nodes.size(); ++n)
    if (problem.model.contact_nodes[n] < problem.model.bodies[1].first_node) aside[2 * n] = 1;
  EXPECT_LE(largest_entry(S * aside), solved * largest_entry(S));
}

}  // namespace
}  // namespace stickslip::engine_test
