/// The exported system against the state that it is of.
#include "studies/run/export_system.hpp"

#include <gtest/gtest.h>

#include <unsupported/Eigen/SparseExtra>

#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"
#include "tests/support/largest.hpp"
#include "tests/support/scenes.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

struct System {
  Eigen::SparseMatrix<double> K, G;
  Vector<double> lambda, f, u, g;

  explicit System(const fs::path& folder) {
    for (auto [name, matrix] : {std::pair{"K.mtx", &K}, {"G.mtx", &G}})
      if (!Eigen::loadMarket(*matrix, (folder / name).string())) throw std::runtime_error(name);
    for (auto [name, vector] : {std::pair{"lambda.mtx", &lambda}, {"f.mtx", &f}, {"u.mtx", &u}, {"g.mtx", &g}})
      if (!Eigen::loadMarketVector(*vector, (folder / name).string())) throw std::runtime_error(name);
  }
};

void expect_solution(const CaseResult& result) {
  const TemporaryFolder own;
  const fs::path& folder = own.path;
  export_system(folder, result);
  const System s(folder);
  const auto& [model, slots, unused] = *result.problem;
  ASSERT_EQ(s.K.rows(), static_cast<Eigen::Index>(model.free_dofs.size()));
  ASSERT_EQ(s.G.cols(), model.multiplier_count);

  // Rows balance to the solver's tolerance of 1e-12, relative to the largest force in them.
  const Vector<double> inner = s.K * s.u, contact = s.G * s.lambda;
  const double force = larger(larger(largest_entry(inner), largest_entry(contact)), largest_entry(s.f));
  EXPECT_LE(largest_entry(inner + contact - s.f), 1e-11 * force);

  // Kinematics: a few roundings of displacements and coordinates.
  const auto& state = result.trajectory.increments.back().state;
  const Vector<double> moved = s.G.transpose() * s.u + s.g;
  const double length = std::max(largest_entry(s.u), largest_entry(slots.points));
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const double area = slots.geometry[p].area;
    EXPECT_NEAR(moved[model.points[p].multiplier] / area, state.contact.gap[p], 1e-14 * length) << p;
    for (int a = 0; a < model.points[p].tangents; ++a)
      EXPECT_NEAR(moved[model.points[p].multiplier + 1 + a] / area,
                  state.history.placement[tangential_offset(model, static_cast<int>(p)) + a], 1e-14 * length)
          << p;
  }
  for (const char* name : {"rows.csv", "points.csv", "README"}) EXPECT_GT(fs::file_size(folder / name), 0u) << name;
}

class Exported : public testing::TestWithParam<std::string> {};

TEST_P(Exported, SystemHasTheSolutionThatTheRunFound) {
  const fs::path file = cases::shipped / (GetParam() + ".json");
  expect_solution(cases::run(cases::load(file), {{"monolithic_al", nlohmann::json::object()}}, file));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Exported,
                         testing::Values("stop", "stop_bars", "slider", "tractrix", "greco_plate", "belt", "press_fit"),
                         [](const auto& info) { return info.param; });

TEST(ExportedFrames, SystemHasTheSolutionWhereSupportsAreInclinedAndObstaclesTurn) {
  for (const auto& scene : {scenes::driven_block(), scenes::turned_point(), scenes::segment_boxes(5, 7)}) {
    std::shared_ptr<Condensation<double>> condensation;
    expect_solution(run_case(std::make_shared<const Problem>(scene), MonolithicAL{}, {}, condensation));
  }
}

}  // namespace
}  // namespace stickslip
