/// No answer may hang on a path that rounding chooses: the scenes that the tests share, solved with coordinates a few
/// roundings off and with everything numbered otherwise. (Those of files: tests/studies/rounding_test.cpp.)
#include <gtest/gtest.h>

#include "core/model/response.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/perturbed.hpp"
#include "tests/support/solved.hpp"

namespace stickslip::rounding_test {
namespace {

using perturbed::Perturbation;

/// Relative to the largest value of a response in the run. Coordinates are 1e-15 off, gaps of 1e-3 of them 1e-12, and
/// the conditions of the scenes make up to 1e3 of that.
constexpr double same_answer = 1e-9;

struct Answers {
  Status status;
  std::string message;
  long cutbacks;
  std::vector<std::string> names;
  Matrix<double> values;  ///< responses x increments
};

Answers answers(const Scene& scene, const Method& method, const Perturbation& by) {
  const Model model = make_model(perturbed::scene_of(scene, by));
  const auto slots = perturbed::slots_of(model, by);
  const auto trajectory = solve(model, slots, method);
  Answers out{trajectory.status, trajectory.message, trajectory.counters.cutbacks, {}, {}};
  for (const auto& response : scene.responses) out.names.push_back(response.name);
  out.values.resize(scene.responses.size(), trajectory.increments.size());
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n)
    out.values.col(n) = evaluate_responses(model, slots, trajectory.increments[n].state, trajectory.increments[n].time);
  return out;
}

void expect_same(const Answers& a, const Answers& reference, const std::string& what) {
  EXPECT_TRUE(is_converged(a.status)) << what << ": " << a.message;
  EXPECT_EQ(a.cutbacks, reference.cutbacks) << what;
  ASSERT_EQ(a.values.cols(), reference.values.cols()) << what;
  const double largest = largest_entry(reference.values);
  for (Eigen::Index i = 0; i < a.values.rows(); ++i) {
    double size = largest_entry(reference.values.row(i));
    if (size <= 1e-12 * largest) size = largest;  // zero throughout
    EXPECT_LE(largest_entry(a.values.row(i) - reference.values.row(i)), same_answer * size)
        << what << " " << reference.names[i];
  }
}

void expect_rounding_does_not_matter(const std::vector<Scene>& scenes) {
  UzawaAL uzawa;
  uzawa.tolerance = 1e-12;
  uzawa.max_augmentations = 2000;
  std::vector<Method> methods{Penalty{}, uzawa};
  for (const double scale : {0.01, 1.0, 100.0}) methods.push_back(MonolithicAL{scenes::relative(scale)});
  for (std::size_t s = 0; s < scenes.size(); ++s)
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const std::string what =
          "scene " + std::to_string(s) + ", " + std::string(name_of(methods[m])) + " " + std::to_string(m) + " ";
      const auto reference = answers(scenes[s], methods[m], {});
      EXPECT_TRUE(is_converged(reference.status)) << what << reference.message;
      if (!is_converged(reference.status)) continue;
      expect_same(answers(scenes[s], methods[m], {1e-15, false, 1}), reference, what + "moved");
      expect_same(answers(scenes[s], methods[m], {0, true, 1}), reference, what + "numbered backwards");
      expect_same(answers(scenes[s], methods[m], {1e-15, true, 2}), reference, what + "moved and numbered backwards");
    }
}

TEST(RoundingOfSharedScenes, DoesNotChooseTheAnswer) { expect_rounding_does_not_matter(scenes::all()); }
TEST(RoundingOfEveryElement, DoesNotChooseTheAnswer) { expect_rounding_does_not_matter(scenes::of_every_element()); }
TEST(RoundingOfThePulledBar, DoesNotChooseTheAnswer) {
  std::vector<Scene> bars;
  for (const int nodes : {10, 30}) bars.push_back(scenes::pull_out(nodes, {0, 1, 0}, 4));
  expect_rounding_does_not_matter(bars);
}

}  // namespace
}  // namespace stickslip::rounding_test
