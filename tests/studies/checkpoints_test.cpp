/// Runs whose adjoint lets states go: all that is read of a run is that of one that keeps them.
#include <gmock/gmock.h>

#include "studies/io/atomic_file.hpp"
#include "studies/run/film.hpp"
#include "studies/run/ledger_forecast.hpp"
#include "studies/run/run_files.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/warnings.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A shipped scene with its first response, over all steps, as objective; `megabytes`: of its states.
json long_scene(const std::string& name, double megabytes) {
  json document = cases::load(cases::shipped / (name + ".json"));
  document.erase("objectives");
  document["objectives"]["J"] = {{"of", document["responses"].begin().key()}, {"sum", true}};
  document["sensitivity"] = {{"mode", "adjoint"}, {"memory", megabytes}};
  document["output"] = {{"fields", 7}};
  if (name == "belt") document["time"]["steps"] = 12;
  return document;
}

struct Done {
  Simulation simulation;
  CaseResult result;
  explicit Done(const json& document, const std::string& scene)
      : simulation{cases::read(document, cases::shipped / (scene + ".json")), nullptr} {
    simulation.problem = std::make_shared<const Problem>(simulation.input.scene);
    result = simulate(simulation);
  }
  long count(const char* name) const { return cost_json(result)["counts"][name]; }
  /// Names and contents of the files of fields.
  std::map<std::string, std::string> fields() const {
    const TemporaryFolder own;
    write_result(own.path, simulation, result);
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(own.path))
      if (entry.path().filename().string().starts_with("fields"))
        files[entry.path().filename()] = read_file(entry.path());
    return files;
  }
};

class LetGo : public testing::TestWithParam<std::string> {};

TEST_P(LetGo, AndTheResultIsThatOfARunThatKeepsAll) {
  constexpr double tiny = 1e-6;  // MB: less than a state
  const Done all(long_scene(GetParam(), 512), GetParam()), few(long_scene(GetParam(), tiny), GetParam());
  ASSERT_TRUE(is_converged(few.result.status())) << few.result.message();
  EXPECT_EQ(all.count("repeated_increments"), 0);
  EXPECT_GT(few.count("repeated_increments"), 0);
  EXPECT_GT(few.count("newton"), all.count("newton"));
  EXPECT_EQ(steps_json(few.result), steps_json(all.result));
  EXPECT_EQ(objectives_json(few.result), objectives_json(all.result));
  EXPECT_EQ(warnings_json(few.result), warnings_json(all.result));
  EXPECT_EQ(interface_json(few.result), interface_json(all.result));
  EXPECT_EQ(film_json(few.result), film_json(all.result));
  EXPECT_EQ(few.fields(), all.fields());
}

Amount amount_of(const Ledger& ledger, const std::string& effect, const std::string& name) {
  for (const auto& row : ledger)
    for (const auto* amounts : {&row.memory, &row.counts})
      for (const auto& amount : *amounts)
        if (row.effect == effect && amount.name == name) return amount;
  throw std::out_of_range(effect);
}
double bytes_of(const Ledger& ledger, const std::string& effect, const std::string& name) {
  return amount_of(ledger, effect, name).value;
}

TEST_P(LetGo, AndTheMemoryIsForetold) {
  const Done few(long_scene(GetParam(), 1e-6), GetParam()), all(long_scene(GetParam(), 512), GetParam());
  const Ledger foretold = forecast(few.simulation.input, *few.simulation.problem), kept = ledger(few.result);
  for (const auto& [effect, name] : {std::pair{"bodies", "states"},
                                     {"plasticity", "history"},
                                     {"adjoint_sensitivity", "states"},
                                     {"adjoint_sensitivity", "repeated_increments"}}) {
    const Amount before = amount_of(foretold, effect, name), after = amount_of(kept, effect, name);
    ASSERT_GE(before.spread, 1) << effect << name;
    EXPECT_LE(after.value, before.value * before.spread) << effect << name;
    EXPECT_GE(after.value, before.value / before.spread) << effect << name;
  }
  EXPECT_LT(bytes_of(kept, "bodies", "states"), 0.6 * bytes_of(ledger(all.result), "bodies", "states"));
  EXPECT_GT(bytes_of(kept, "adjoint_sensitivity", "states"), 0);
  EXPECT_EQ(bytes_of(ledger(all.result), "adjoint_sensitivity", "states"), 0);
}

INSTANTIATE_TEST_SUITE_P(Shipped, LetGo, testing::Values("belt", "plastic_bar", "ironing"),
                         [](const auto& each) { return each.param; });

}  // namespace
}  // namespace stickslip
