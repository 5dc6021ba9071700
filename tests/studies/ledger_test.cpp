/// The ledger: what is off comes to nothing, what is on adds up, and the forecast holds to what it says of itself.
#include "studies/run/ledger.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "studies/run/explain.hpp"
#include "studies/run/ledger_forecast.hpp"
#include "studies/run/run_files.hpp"
#include "studies/run/simulation.hpp"
#include "tests/studies/cases.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

/// A scene by one method and engine, before and after it ran.
struct Book {
  Ledger foretold, kept;
  CaseResult result;
};

Book book_of(json document, const json& method, const std::string& engine, const std::string& name) {
  document["method"] = method;
  document["linear_solver"]["engine"] = engine;
  const Simulation simulation{cases::read(document, cases::shipped / (name + ".json")), nullptr};
  const auto problem = std::make_shared<const Problem>(simulation.input.scene);
  Book book{forecast(simulation.input, *problem), {}, simulate({simulation.input, problem})};
  book.kept = ledger(book.result);
  return book;
}

json scene(const std::string& name) { return cases::load(cases::shipped / (name + ".json")); }

const json penalty = {{"penalty", json::object()}}, uzawa = {{"uzawa_al", json::object()}},
           truncated = {{"uzawa_al", {{"sensitivity", "truncated"}}}}, monolithic = {{"monolithic_al", json::object()}};
const std::vector<json> ledger_methods = {penalty, uzawa, truncated, monolithic};

const LedgerRow& row(const Ledger& ledger, const std::string& effect) {
  for (const auto& each : ledger)
    if (each.effect == effect) return each;
  throw std::out_of_range(effect);
}

double amount(const std::vector<Amount>& amounts, const std::string& name) {
  for (const auto& each : amounts)
    if (each.name == name) return each.value;
  throw std::out_of_range(name);
}

double sum(const std::vector<Amount>& amounts) {
  double all = 0;
  for (const auto& each : amounts) all += std::abs(each.value);
  return all;
}

void expect_nothing_of_what_is_off(const Ledger& ledger, const std::string& where) {
  for (const auto& each : ledger) {
    if (each.on) continue;
    const std::string what = where + ": " + each.effect;
    EXPECT_EQ(sum(each.unknowns), 0) << what;
    EXPECT_EQ(sum(each.memory), 0) << what;
    EXPECT_EQ(sum(each.counts), 0) << what;
    EXPECT_FALSE(each.seconds > 0) << what;
  }
}

/// Unknowns of all rows, less what is eliminated, are those of the systems that were solved.
void expect_unknowns_to_add_up(const Book& book, const std::string& where) {
  const double all = amount(row(book.kept, "bodies").unknowns, "displacements") +
                     amount(row(book.kept, "contact").unknowns, "normal") +
                     amount(row(book.kept, "friction").unknowns, "tangential") -
                     amount(row(book.kept, "condensed_engine").unknowns, "eliminated");
  EXPECT_EQ(all, book.result.trajectory.reduced_unknowns) << where;
}

void expect_amounts_foretold(const std::vector<Amount>& foretold, const std::vector<Amount>& kept,
                             const std::string& where) {
  ASSERT_EQ(foretold.size(), kept.size()) << where;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Amount &before = foretold[i], &after = kept[i];
    const std::string what = where + " " + after.name;
    EXPECT_EQ(before.name, after.name) << what;
    if (before.spread == 0) continue;
    EXPECT_GE(before.spread, 1) << what;
    constexpr double rounding = 1e-12;  // of the factor itself
    EXPECT_LE(after.value, before.value * before.spread * (1 + rounding)) << what;
    EXPECT_GE(after.value, before.value / before.spread * (1 - rounding)) << what;
  }
}

void expect_foretold(const Book& book, const std::string& where) {
  ASSERT_EQ(book.foretold.size(), book.kept.size()) << where;
  for (std::size_t i = 0; i < book.kept.size(); ++i) {
    const LedgerRow &before = book.foretold[i], &after = book.kept[i];
    const std::string what = where + ": " + after.effect;
    EXPECT_EQ(before.effect, after.effect) << what;
    if (after.effect == "output") continue;  // of a run that wrote nothing
    if (after.effect == "one_sided_search")
      EXPECT_TRUE(before.on || !after.on) << what;  // points may tie, or not
    else
      EXPECT_EQ(before.on, after.on) << what;
    expect_amounts_foretold(before.unknowns, after.unknowns, what);
    expect_amounts_foretold(before.memory, after.memory, what);
    expect_amounts_foretold(before.counts, after.counts, what);
  }
}

class LedgerOf : public testing::TestWithParam<std::string> {};

TEST_P(LedgerOf, AShippedSceneIsForetoldAndAddsUp) {
  for (const auto& method : ledger_methods)
    for (const std::string engine : {"condensed", "sparse"}) {
      const std::string where = GetParam() + " " + method.dump() + " " + engine;
      const Book book = book_of(scene(GetParam()), method, engine, GetParam());
      ASSERT_TRUE(is_converged(book.result.status())) << where;
      ASSERT_EQ(book.result.trajectory.counters.cutbacks, 0) << where;  // which a forecast supposes
      expect_foretold(book, where);
      expect_unknowns_to_add_up(book, where);
      expect_nothing_of_what_is_off(book.kept, where);
      expect_nothing_of_what_is_off(book.foretold, where);
    }
}
INSTANTIATE_TEST_SUITE_P(Shipped, LedgerOf, testing::Values("slider", "stop", "belt", "press_fit", "greco_plate"),
                         [](const auto& each) { return each.param; });

TEST(Ledger, OfBodiesThatChangeIsForetoldWithinWhatItSays) {
  // points that slide along curves, tangents that are condensed, a path that finds its steps
  for (const std::string name : {"ironing", "plastic_bar", "snap", "truss"})
    for (const auto& method : {penalty, uzawa, monolithic})
      for (const std::string engine : {"auto", "sparse"}) {
        const std::string where = name + " " + method.dump() + " " + engine;
        const Book book = book_of(scene(name), method, engine, name);
        ASSERT_TRUE(is_converged(book.result.status())) << where;
        expect_foretold(book, where);
        expect_nothing_of_what_is_off(book.foretold, where);
      }
}

TEST(SlowLedger, OfTheTubeIsForetoldAlthoughItsPatternChanges) {
  for (const auto& method : {penalty, monolithic}) {
    const Book book = book_of(scene("pinched_tube"), method, "auto", "pinched_tube");
    ASSERT_TRUE(is_converged(book.result.status()));
    expect_foretold(book, method.dump());
  }
}

TEST(Ledger, OfASceneWithoutAnEffectHasNothingOfIt) {
  json plain = scene("greco_plate");
  for (auto& contact : plain["contacts"]) contact.erase("friction");
  plain.erase("parameters");
  json loose = plain;
  loose["contacts"] = json::object();
  loose["responses"] = json::object();
  for (const auto& method : ledger_methods)
    for (const std::string engine : {"condensed", "sparse"}) {
      const std::string where = method.dump() + " " + engine;
      const Book with = book_of(scene("greco_plate"), method, engine, "greco_plate");
      const Book without = book_of(plain, method, engine, "greco_plate");
      const Book alone = book_of(loose, method, engine, "greco_plate");
      expect_nothing_of_what_is_off(without.kept, where);
      expect_nothing_of_what_is_off(alone.kept, where + " without contact");
      for (const char* effect : {"friction", "direct_sensitivity"}) {
        EXPECT_TRUE(row(with.kept, effect).on) << where;
        EXPECT_GT(sum(row(with.kept, effect).memory), 0) << where << effect;
        EXPECT_FALSE(row(without.kept, effect).on) << where;
      }
      EXPECT_FALSE(row(alone.kept, "contact").on) << where;
      // what the bodies take is the same
      EXPECT_EQ(sum(row(with.kept, "bodies").unknowns), sum(row(without.kept, "bodies").unknowns)) << where;
    }
}

TEST(Ledger, FrictionTakesTheOtherTriangleOfASparseFactor) {
  json plain = scene("greco_plate");
  for (auto& contact : plain["contacts"]) contact.erase("friction");
  plain["parameters"].erase("mu");
  const Book with = book_of(scene("greco_plate"), penalty, "sparse", "greco_plate");
  const Book without = book_of(plain, penalty, "sparse", "greco_plate");
  const double triangle = amount(row(with.kept, "friction").memory, "factor");
  const double other = amount(row(with.kept, "sparse_engine").memory, "factor");
  EXPECT_GT(triangle, 0);
  EXPECT_LT(triangle, other);  // which has the diagonal
  EXPECT_GT(amount(row(with.kept, "friction").counts, "unsymmetric_factorizations"), 0);
  // LU by one library and Cholesky by another: another ordering, and zeros that are stored
  EXPECT_NEAR(other / amount(row(without.kept, "sparse_engine").memory, "factor"), 1, 1);
}

json with_objective(json document, const std::string& mode) {
  document["objectives"] = {{"J", {{"of", "u"}, {"sum", true}}}};
  document["sensitivity"] = {{"mode", mode}};
  return document;
}

TEST(Ledger, SaysWhichSensitivityTookWhat) {
  for (const auto& method : ledger_methods)
    for (const std::string engine : {"condensed", "sparse"}) {
      const Book adjoint = book_of(with_objective(scene("slider"), "adjoint"), method, engine, "slider");
      const Book direct = book_of(with_objective(scene("slider"), "direct"), method, engine, "slider");
      for (const auto* book : {&adjoint, &direct}) {
        expect_foretold(*book, method.dump() + engine);
        expect_nothing_of_what_is_off(book->kept, method.dump() + engine);
      }
      EXPECT_FALSE(row(adjoint.kept, "direct_sensitivity").on);
      EXPECT_GT(amount(row(adjoint.kept, "adjoint_sensitivity").memory, "tape"), 0);
      EXPECT_EQ(amount(row(adjoint.kept, "adjoint_sensitivity").unknowns, "objectives"), 1);
      EXPECT_GT(amount(row(adjoint.kept, "adjoint_sensitivity").counts, "backsolves"), 0);
      EXPECT_FALSE(row(direct.kept, "adjoint_sensitivity").on);
    }
}

/// Counts of the rows are those of `cost`, each in one row.
TEST(Ledger, SharesOutTheCountsOfTheRun) {
  for (const auto& method : ledger_methods) {
    const Book book = book_of(scene("belt"), method, "condensed", "belt");
    const auto& engine = row(book.kept, "condensed_engine").counts;
    const json counts = cost_json(book.result)["counts"];
    double factorizations = amount(engine, "factorizations"), backsolves = 0;
    for (const char* effect : {"direct_sensitivity", "adjoint_sensitivity", "one_sided_search"}) {
      factorizations += amount(row(book.kept, effect).counts, "factorizations");
      backsolves += amount(row(book.kept, effect).counts, "backsolves");
    }
    EXPECT_EQ(factorizations, counts["factorizations"]);
    EXPECT_EQ(backsolves, counts["sensitivity_backsolves"]);
    EXPECT_EQ(amount(engine, "backsolves"), counts["backsolves"]);
    EXPECT_EQ(amount(engine, "iterations"), counts["newton"]);
  }
}

/// An elastic punch, drawn along a strip that flows.
json punch_on_metal() {
  return json::parse(R"({
    "space": "plane_strain",
    "bodies": {
      "punch": {"mesh": {"box": {"min": [0.2, 1], "max": [1.8, 2], "cells": [8, 8]}},
                "material": {"linear_elastic": {"E": 1000, "nu": 0.3}}},
      "strip": {"mesh": {"box": {"min": [0, 0], "max": [2, 1], "cells": [10, 4]}},
                "material": {"j2_plastic": {"E": 1500, "nu": 0.2, "yield": 4, "hardening": 100}}}
    },
    "contacts": {"sole": {"slave": "punch.bottom", "master": "strip.top", "friction": 0.3}},
    "supports": [{"on": "strip.bottom", "move": {"x": 0, "y": 0}},
                 {"on": "punch.top", "move": {"x": [[0, 0], [1, 0], [2, 0.004]], "y": [[0, 0], [1, -0.01]]}}],
    "time": {"legs": [[1, 4], [2, 4]]},
    "responses": {"press": {"contact_force": {"contact": "sole", "component": "normal"}}},
    "parameters": {"E": "/bodies/punch/material/linear_elastic/E"}
  })");
}

TEST(Ledger, OfAMixedSceneHasWhatIsCondensedBesideTheSparseEngine) {
  for (const auto& method : ledger_methods)
    for (const std::string engine : {"condensed", "sparse"}) {
      const std::string where = method.dump() + " " + engine;
      const Book book = book_of(punch_on_metal(), method, engine, "punch_on_metal");
      ASSERT_TRUE(is_converged(book.result.status())) << where << book.result.message();
      ASSERT_EQ(book.result.trajectory.counters.cutbacks, 0) << where;
      expect_foretold(book, where);
      expect_unknowns_to_add_up(book, where);
      expect_nothing_of_what_is_off(book.kept, where);
      const bool condensed = engine == "condensed";
      const auto& part = row(book.kept, "condensed_engine");
      EXPECT_EQ(part.on, condensed) << where;
      EXPECT_TRUE(row(book.kept, "sparse_engine").on) << where;
      // 9 x 9 nodes of the punch, of which the top row is held and the bottom row is in contact
      EXPECT_EQ(amount(part.unknowns, "eliminated"), condensed ? 2 * 9 * 7 : 0) << where;
      EXPECT_EQ(amount(part.memory, "condensed"), condensed ? sizeof(double) * 18 * 18 : 0) << where;
      // a reduction and an expansion of each step, and derivatives: at the contact alone but for the last step
      if (condensed) {
        EXPECT_GE(amount(part.counts, "body_backsolves"), 8) << where;
      }
    }
}

TEST(Ledger, ExplainSaysWhatIsCondensedOfAMixedScene) {
  const auto explained = [](const std::string& engine) {
    json document = punch_on_metal();
    document["method"] = penalty;
    document["linear_solver"]["engine"] = engine;
    const Input input = cases::read(document, cases::shipped / "punch_on_metal.json");
    return explain(input, Problem(input.scene));
  };
  using testing::HasSubstr;
  const std::string condensed = explained("condensed");
  EXPECT_THAT(condensed, HasSubstr("  punch: condensed once to 18 contact dofs, a dense block\n"));
  EXPECT_THAT(condensed, HasSubstr("  strip: in full, its tangent assembled anew in each iteration\n"));
  EXPECT_THAT(condensed, HasSubstr(" Gflop condensed, "));
  EXPECT_EQ(explained("auto"), condensed);  // which is cheaper
  const std::string sparse = explained("sparse");
  EXPECT_THAT(sparse, HasSubstr("the bodies' part assembled anew\n  predicted: "));
  EXPECT_THAT(sparse, testing::Not(HasSubstr("dense block")));
}

TEST(Ledger, CountsWhatIsWritten) {
  Diagnostics diagnostics;
  const auto simulation = prepare((cases::shipped / "belt.json").string(), {}, std::nullopt, diagnostics);
  ASSERT_TRUE(simulation) << diagnostics.text();
  const TemporaryFolder own;
  const fs::path& directory = own.path;
  const auto result = simulate(*simulation);
  const json written = write_result(directory, *simulation, result)["ledger"].back();
  double bytes = 0, files = 1;
  const auto solution = static_cast<double>(fs::file_size(directory / "solution.json"));
  for (const auto& entry : fs::directory_iterator(directory)) {
    if (!entry.path().filename().string().starts_with("fields")) continue;
    bytes += static_cast<double>(entry.file_size());
    ++files;
  }
  EXPECT_EQ(written["effect"], "output");
  EXPECT_EQ(written["memory"]["fields"], bytes);
  EXPECT_EQ(written["memory"]["solution"], solution);
  EXPECT_EQ(written["counts"]["files"], files);
  const Ledger foretold = forecast(simulation->input, *simulation->problem);
  expect_amounts_foretold(row(foretold, "output").memory,
                          {{"fields", bytes}, {"solution", solution}, {"picture"}, {"trace"}}, "output");
  expect_amounts_foretold(row(foretold, "output").counts, {{"files", files}}, "output");
  EXPECT_FALSE(row(ledger(result), "output").on);
}

TEST(Ledger, AsJsonHasNullWhereNothingIsKnown) {
  const Ledger rows = {{"bodies", true, {{"displacements", 4}}, {{"states", 1500, 2}}, {{"evaluations", 0, 0}}, NAN},
                       {"friction", false, {{"tangential", 0}}, {}, {}, 0}};
  const json out = ledger_json(rows);
  EXPECT_EQ(out[0], (json{{"effect", "bodies"},
                          {"on", true},
                          {"unknowns", {{"displacements", 4}}},
                          {"memory", {{"states", 1500}}},
                          {"counts", {{"evaluations", nullptr}}},
                          {"seconds", nullptr}}));
  EXPECT_FALSE(repeatable_ledger_json(rows)[0].contains("seconds"));
  EXPECT_THAT(ledger_table(rows), testing::AllOf(testing::HasSubstr("+4"), testing::HasSubstr("~1.5 kB"),
                                                 testing::HasSubstr("off, and nothing of it there: friction")));
}

TEST(Ledger, TellsAmountsInWords) {
  EXPECT_EQ(amount_in_words({"analyses", 1}), "1 analysis");
  EXPECT_EQ(amount_in_words({"body_backsolves", 12345}), "12345 body back-solves");
  EXPECT_EQ(amount_in_words({"factor_entries", 213444, 2}), "~2.13e5 factor entries");
  EXPECT_EQ(amount_in_words({"points", 0}), "0 points");
}

TEST(Ledger, IsALineOfWhatIsOn) {
  const json recorded = json::parse(R"([
    {"effect": "bodies", "on": true, "unknowns": {"displacements": 2}, "memory": {"mesh": 200, "slots": 52}},
    {"effect": "contact", "on": true, "unknowns": {"normal": 1}, "memory": {"points": 1100}},
    {"effect": "friction", "on": false, "unknowns": {"tangential": 0}, "memory": {}},
    {"effect": "condensed_engine", "on": true, "unknowns": {"eliminated": 0}, "memory": {}}])");
  EXPECT_EQ(ledger_line(recorded), "bodies: 2 displacements, 252 B; contact: 1 multiplier, 1.1 kB; condensed engine");
}

}  // namespace
}  // namespace stickslip
