/// Points that go to and fro between two facets, and are kept on one (methods/newton/kept_patches.hpp).
#include <gtest/gtest.h>

#include "core/engine/engine.hpp"
#include "core/model/contact_assembly.hpp"
#include "methods/newton/residuals.hpp"
#include "tests/support/sliding_scenes.hpp"

namespace stickslip::vertices_test {
namespace {

TEST(KeptPatches, AreWrongWhereThePointFacesAnother) {
  Scene scene = scenes::sliding_die();
  scene.contacts[0].smoothing = Smoothing::none;
  const Model model = make_model(scene);
  const auto slots = make_slots<double>(model, scene.as<double>());
  auto engine =
      sparse_engine(model, slots, system_kind(model, Multipliers::unknown, ConeRadius::augmented, Backend::automatic));
  const RegularisationField<double> rho(model.points.size(), {1, 1});
  const auto start = initial_state<double>(model, slots);
  const ContactInput<double> input{model, slots, rho, start.history, ConeRadius::augmented, 0.1};
  const Anchor<double> none;
  const EquilibriumTask<double> task{input, Multipliers::unknown, none};
  Account account;
  Evaluator<double> evaluate(engine, task, account);
  const Unknowns<double> unknowns{engine.begin(0.1, start.displacement, {}), start.multiplier};
  auto at = evaluate(unknowns);
  auto& point = at.field.facing[2];
  at.field.state[2] = ContactState::stick;
  const int first = point.patch;
  ASSERT_NE(first, no_patch);
  const auto is_wrong = [&](const Unknowns<double>& u) {
    return evaluate.patches().is_wrong(input, engine.compact(u.u), at.field);
  };
  EXPECT_FALSE(evaluate.patches().keep(model));
  for (const int patch : {first, first + 1, first}) {
    point.patch = patch;
    evaluate.patches().accept(at.field);
  }
  ASSERT_TRUE(evaluate.patches().keep(model));
  // At the start the point faces `first`, on which it is kept; moved by a facet it faces the next.
  EXPECT_FALSE(is_wrong(unknowns));
  auto moved = unknowns;
  for (int node : {model.contact_nodes[model.points[2].places[0]]}) moved.u[node * 2] += model.points[2].mesh_size;
  EXPECT_TRUE(is_wrong(moved));
  at.field.state[2] = ContactState::open;
  EXPECT_FALSE(is_wrong(moved));
}

}  // namespace
}  // namespace stickslip::vertices_test
