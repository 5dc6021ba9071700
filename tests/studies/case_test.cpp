/// What a run leaves in result.json of Uzawa's iterations.
#include "studies/run/case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "methods/stepping/engine_choice.hpp"
#include "sensitivity/gradcheck.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/tied_nodes.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/solved.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

nlohmann::json last_step(const Method& method) {
  const auto problem = std::make_shared<const Problem>(scenes::greco_plate(8));
  std::shared_ptr<Condensation<double>> condensation;
  return steps_json(run_case(problem, method, {}, condensation)).back();
}

TEST(Case, GivesBothSidesOfALargestValueThatTwoNodesShare) {
  json scene = cases::tied_nodes();
  const json method = {{"monolithic_al", json::object()}};
  const auto at = [&](double shift) {
    json moved = scene;
    moved["obstacles"]["f"]["circle"]["center"][0] = shift;
    return steps_json(cases::run(moved, method, "tie.json")).back();
  };
  const auto step = at(0);
  constexpr double h = 1e-6;
  const auto below = at(-h), above = at(h);
  EXPECT_FALSE(step["differentiable"]);
  for (const char* name : {"most", "farthest"}) {
    const double value = step["responses"][name];
    const double left = (value - below["responses"][name].get<double>()) / h;
    const double right = (above["responses"][name].get<double>() - value) / h;
    const double size = std::abs(right);
    EXPECT_GT(size, 0.1) << name;
    EXPECT_NEAR(step["one_sided"][name]["shift"][0], left, 1e-4 * size) << name << ", h times the second derivative";
    EXPECT_NEAR(step["one_sided"][name]["shift"][1], right, 1e-4 * size) << name;
    EXPECT_NEAR(step["sensitivities"][name]["shift"], 0, 1e-9 * size) << name << ", their mean";
  }
  const auto off = at(1e-3);
  EXPECT_TRUE(off["differentiable"]);
}

TEST(Case, GivesBothSidesOfAFlowThatIsAboutToBegin) {
  // seven steps to 0.035: at the third the bar is at its yield stress, to the last bits
  const std::filesystem::path file = cases::shipped / "plastic_bar.json";
  json scene = cases::load(file);
  scene["time"] = {{"legs", {{1, 7}}}};
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.035}};
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, file);
  ASSERT_EQ(result.steps.size(), 7u);
  for (std::size_t n = 1; n < 7; ++n) {  // (the first closes a gap of zero)
    const auto& step = result.steps[n];
    EXPECT_EQ(step.margins.yield <= weak_margin, n == 2) << n;
    EXPECT_EQ(step.differentiable, n != 2) << n;
    if (n == 2) {
      EXPECT_TRUE(step.backward.allFinite() && step.forward.allFinite());
      EXPECT_EQ(step.forward.rows(), 3);
      EXPECT_GT(largest_entry(step.forward - step.backward), 0.1);  // 1 - E_t / E of the force by the yield stress
    }
  }
}

TEST(Case, GivesBothSidesOfAFlowThatEndsAtACornerOfItsTable) {
  // seven steps to 0.035, a strain of 0.03: 0.02 is reached at the fifth, where the stress is 12 to the last bits
  const std::filesystem::path file = cases::shipped / "plastic_bar.json";
  json scene = cases::load(file);
  auto& metal = scene["bodies"]["bar"]["material"]["j2_plastic"];
  metal["hardening"] = {{0, metal["yield"]}, {0.02 - 12 / metal["E"].get<double>(), 12}, {1, 20}};
  metal.erase("yield");
  scene["parameters"].erase("H");  // (that is the whole table now)
  scene["parameters"]["yield"] = "/bodies/bar/material/j2_plastic/hardening/0/1";
  scene["time"] = {{"legs", {{1, 7}}}};
  scene["supports"][0]["move"]["x"] = {{0, 0}, {1, 0.035}};
  const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, file);
  ASSERT_EQ(result.steps.size(), 7u);
  for (std::size_t n = 3; n < 7; ++n) EXPECT_EQ(result.steps[n].differentiable, n != 4) << n;
}

TEST(Case, RecordsTheContractionAndWhatTheDerivativesTook) {
  UzawaAL method;
  method.scale = scenes::relative(0.3);
  method.adapt = false;
  method.max_augmentations = 1000;
  auto step = last_step(method);
  EXPECT_NEAR(step["contraction"], 0.8, 0.05);
  EXPECT_GT(step["sensitivity_scheme"]["passes"], 50);  // ln(1e-13) / ln(0.8) = 134
  EXPECT_EQ(step["sensitivity_scheme"]["oversize"], 1);
  EXPECT_NEAR(step["sensitivity_scheme"]["contraction"], 0.8, 0.05);

  method.sensitivity = UzawaAL::Sensitivity::preconditioned;
  step = last_step(method);
  EXPECT_LE(step["sensitivity_scheme"]["passes"], 6);
  EXPECT_GT(step["sensitivity_scheme"]["oversize"], 1e3);

  method.sensitivity = UzawaAL::Sensitivity::oversized;
  step = last_step(method);
  EXPECT_EQ(step["sensitivity_scheme"]["passes"], 1);
  EXPECT_EQ(step["sensitivity_scheme"]["oversize"], UzawaAL::automatic_oversize);
}

TEST(Case, OfAMethodWithoutIteratedDerivativesRecordsNothingOfThem) {
  for (const Method& method : {Method(Penalty{}), Method(MonolithicAL{})}) {
    const auto step = last_step(method);
    EXPECT_FALSE(step.contains("sensitivity_scheme")) << name_of(method);
    EXPECT_FALSE(step.contains("contraction")) << name_of(method);
  }
}

TEST(Case, RefusesResponsesOfWhatIsNotThere) {
  const auto fault = [](const Response& response) {
    Scene scene = scenes::greco_plate(8);
    scene.responses = {response};
    try {
      const Problem problem(scene);
    } catch (const ModelError& error) {
      return error.pointer + ": " + error.what();
    }
    return std::string();
  };
  const auto plate = scenes::greco_plate(8);
  const auto& contact = plate.contacts.front();
  EXPECT_THAT(fault(scenes::response("R", Response::Kind::reaction, contact.slave, "x")),
              testing::HasSubstr("/responses/R/reaction/on: no support acts on"));
  auto gap = scenes::response("g", Response::Kind::gap, contact.name);
  gap.at = {1e6, 0.0};
  EXPECT_THAT(fault(gap), testing::HasSubstr("/responses/g: the point of \"at\" is off the contact"));
}

/// No support, no contact: with a load there is no equilibrium. (Without one: a warning.)
TEST(Case, ABodyThatNothingHoldsIsNamed) {
  for (const Method& method : {Method(Penalty{}), Method(UzawaAL{}), Method(MonolithicAL{})}) {
    Scene scene;
    scene.bodies = {{"block", BoxMesh{{0.0, 0.0}, {2.0, 1.0}, {2, 1}}, LinearElastic{100, 0.3}}};
    scene.loads = {scenes::traction("block.top", {0.0, -1.0})};
    scene.legs = {{1, 1}};
    std::shared_ptr<Condensation<double>> condensation;
    const auto result = run_case(std::make_shared<const Problem>(scene), method, {}, condensation);
    EXPECT_EQ(result.status(), Status::no_equilibrium) << name_of(method);
    EXPECT_EQ(result.message(),
              "block is free to move: no support holds it and no contact touches it; add a support or a contact");
  }
}

/// All numbers of a run that says it converged are numbers, in what it writes as well.
bool has_null(const json& value) {
  return value.is_null() || (value.is_structured() && std::any_of(value.begin(), value.end(), has_null));
}

TEST(Case, AForceWhoseSquareOverflowsLeavesNumbersInWhatConverged) {
  auto tractrix = cases::load(cases::shipped / "tractrix.json");
  for (const double force : {-1e100, -1e150, -1e160, -1e200, -1e300, -1.7e308})
    for (const char* method : {"penalty", "uzawa_al", "monolithic_al"}) {
      for (auto& load : tractrix["loads"])
        if (load.contains("force")) load["force"][2] = force;
      const auto result = cases::run(tractrix, {{method, json::object()}}, "tractrix.json");
      const std::string what = std::string(method) + " " + std::to_string(force) + ": " + result.message();
      if (!is_converged(result.status())) continue;
      for (const auto& step : steps_json(result)) {
        EXPECT_FALSE(has_null(step["responses"]) || has_null(step["kkt"]) || has_null(step["sensitivities"])) << what;
      }
    }
}

TEST(Case, DerivativesThatOverflowAreNotFinite) {
  // u = F / k: finite, while du/dk = -F / k^2 is not
  json scene = {{"bodies",
                 {{"a",
                   {{"mesh", {{"point", {{"at", {0, 0}}}}}},
                    {"material", {{"grounded_spring", {{"stiffness", {{1e-160, 0}, {0, 1e-160}}}}}}}}}}},
                {"loads", {{{"on", "a.node"}, {"force", {1, 0}}}}},
                {"time", {{"end", 1}, {"steps", 1}}},
                {"responses", {{"u", {{"displacement", {{"on", "a.node"}, {"component", "x"}}}}}}},
                {"parameters", {{"k", "/bodies/a/material/grounded_spring/stiffness/0/0"}}}};
  for (const char* mode : {"direct", "adjoint"}) {
    scene["sensitivity"] = {{"mode", mode}};
    scene["objectives"] = {{"J", {{"of", "u"}, {"at", 1}}}};
    const auto result = cases::run(scene, {{"monolithic_al", json::object()}}, "soft.json");
    EXPECT_EQ(result.trajectory.status, Status::converged) << mode << result.trajectory.message;
    EXPECT_EQ(result.status(), Status::not_finite) << mode;
    EXPECT_THAT(result.message(), testing::HasSubstr("derivative of")) << mode;
  }
}

TEST(Case, DerivativesThatFailFailARunThatRoundingEnded) {
  CaseResult result;
  result.trajectory.status = Status::converged_at_roundoff;
  result.trajectory.message = "rounding";
  EXPECT_EQ(result.status(), Status::converged_at_roundoff);
  EXPECT_EQ(result.message(), "rounding");
  result.gradients.status = Status::singular;
  result.gradients.message = "the tangent";
  EXPECT_EQ(result.status(), Status::singular);
  EXPECT_EQ(result.message(), "the tangent");
  result.trajectory.status = Status::cap;
  EXPECT_EQ(result.status(), Status::cap);
  EXPECT_EQ(result.message(), "rounding");
}

TEST(Case, AHeldBodyWithoutALoadRests) {
  Scene scene;
  scene.bodies = {{"block", BoxMesh{{0.0, 0.0}, {2.0, 1.0}, {2, 1}}, LinearElastic{100, 0.3}}};
  scene.supports = {
      scenes::support("block.left", {{'x', scenes::table({{0, 0.0}})}, {'y', scenes::table({{0, 0.0}})}})};
  scene.legs = {{1, 1}};
  std::shared_ptr<Condensation<double>> condensation;
  const auto result = run_case(std::make_shared<const Problem>(scene), Penalty{}, {}, condensation);
  EXPECT_EQ(result.status(), Status::converged) << result.message();
  EXPECT_TRUE(result.steps.back().increment->state.displacement.isZero(0));
}

TEST(Case, MethodsThatShareACondensationSolveByIt) {
  // the price of condensing is weighed by a run of its own; one that finds it paid does not factorise the bodies anew
  Scene scene = scenes::greco_plate(30);
  std::get<BoxMesh>(scene.bodies[0].mesh).cells = {120, 2};  // mostly contact, whose dense matrix costs most
  scene.contacts[0].friction.reset();
  scene.supports = {scenes::support("plate.right", {{'x', scenes::table({{0, 0.0}})}})};
  scene.responses.clear();
  scene.parameters.clear();
  scene.legs = {{1, 1}};
  const auto problem = std::make_shared<const Problem>(scene);
  ASSERT_FALSE(condenses(problem->model, MonolithicAL{}, LinearAlgebra::Engine::automatic));
  std::shared_ptr<Condensation<double>> none;
  const auto alone = run_case(problem, MonolithicAL{}, {}, none);
  EXPECT_EQ(none, nullptr);
  EXPECT_THAT(alone.trajectory.engine, testing::StartsWith("sparse"));

  RunOptions condensed;
  condensed.linear_algebra.engine = LinearAlgebra::Engine::condensed;
  auto shared = condense(*problem, condensed);
  ASSERT_NE(shared, nullptr);
  const auto together = run_case(problem, MonolithicAL{}, {}, shared);
  EXPECT_THAT(together.trajectory.engine, testing::StartsWith("condensed"));
  const auto& u = alone.trajectory.increments.back().state.displacement;
  const auto& v = together.trajectory.increments.back().state.displacement;
  EXPECT_LE(largest_entry(u - v), 1e-10 * largest_entry(u));  // both to 1e-12 of the forces, and the plate's condition
  RunOptions sparse;
  sparse.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  EXPECT_THAT(run_case(problem, MonolithicAL{}, sparse, shared).trajectory.engine, testing::StartsWith("sparse"));
}

/// Blocks on matching meshes, the lower one moved along by `shift`: slave nodes face master nodes where it is 0.
nlohmann::json matching_blocks(double shift) {
  using nlohmann::json;
  const json material = {{"linear_elastic", {{"E", 1000}, {"nu", 0.3}}}};
  const auto box = [&](double left, double bottom, double right, int cells) {
    return json{{"mesh", {{"box", {{"min", {left, bottom}}, {"max", {right, bottom + 1}}, {"cells", {cells, 3}}}}}},
                {"material", material}};
  };
  return {{"space", "plane_strain"},
          {"bodies", {{"lower", box(shift, 0, 4 + shift, 8)}, {"upper", box(1, 1, 3, 4)}}},
          {"contacts", {{"sole", {{"slave", "upper.bottom"}, {"master", "lower.top"}, {"friction", 0.2}}}}},
          {"supports",
           {{{"on", "lower.bottom"}, {"move", {{"x", 0}, {"y", 0}}}},
            {{"on", "upper.top"}, {"move", {{"x", {{0, 0}, {1, 0.004}}}, {"y", {{0, 0}, {1, -0.02}}}}}}}},
          {"time", {{"end", 1}, {"steps", 2}}},
          {"responses",
           {{"fx", {{"contact_force", {{"contact", "sole"}, {"component", "x"}}}}},
            {"N", {{"contact_force", {{"contact", "sole"}, {"component", "normal"}}}}},
            {"turn", {{"reaction", {{"on", "upper.top"}, {"component", "moment"}, {"about", {2, 2}}}}}}}},
          {"parameters", {{"shift", {{"/bodies/lower/mesh/box/min/0", 1}, {"/bodies/lower/mesh/box/max/0", 1}}}}}};
}

TEST(Case, GivesTheMeanOfBothDerivativesWhereANodeFacesANode) {
  constexpr double h = 1e-5;
  const nlohmann::json method = {{"monolithic_al", nlohmann::json::object()}};
  const auto at = [&](double shift) { return cases::run(matching_blocks(shift), method, "blocks.json"); };
  const auto here = at(0), ahead = at(h), behind = at(-h);
  const auto& derivative = here.steps.back().sensitivities;
  const Vector<double>&middle = here.steps.back().responses, &after = ahead.steps.back().responses,
        &before = behind.steps.back().responses;
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    const double forward = (after[i] - middle[i]) / h, backward = (middle[i] - before[i]) / h;
    largest = larger(largest, larger(std::abs(forward), std::abs(backward)));
  }
  for (int i = 0; i < 3; ++i)  // h times curvatures of the size of the derivative over a cell
    EXPECT_NEAR(derivative(i, 0), (after[i] - before[i]) / (2 * h), 1e-4 * largest) << i;
  EXPECT_GT(largest, 1);
  // and the program's own differences, which keep the pairing, say the same
  EXPECT_TRUE(check_gradients(here.problem->model, here.method, {}).passed());
}

}  // namespace
}  // namespace stickslip
