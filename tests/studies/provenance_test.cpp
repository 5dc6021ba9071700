#include "studies/io/provenance.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "core/algebra/linear_solver.hpp"

namespace stickslip {
namespace {

TEST(Provenance, NamesEverythingThatSecondsAndLastDigitsDependOn) {
  const nlohmann::json p = provenance(3);
  for (const char* key : {"version", "git", "compiler", "flags", "build_type", "cpu", "blas", "date"}) {
    ASSERT_TRUE(p.contains(key)) << key;
    EXPECT_TRUE(p[key].is_string()) << key;
    EXPECT_FALSE(p[key].get<std::string>().empty()) << key;
  }
  EXPECT_EQ(p["threads"], 3);
  EXPECT_TRUE(p["load_average"].is_number() || p["load_average"].is_null());
  EXPECT_NE(p["flags"].get<std::string>().find("-ffp-contract=off"), std::string::npos);
}

TEST(Provenance, ListsEachLinearSolverWithItsVersion) {
  const nlohmann::json libraries = provenance(1)["libraries"];
  for (const std::string& library : linear_solver_libraries()) {
    const std::string name = library.substr(0, library.find(' '));
    ASSERT_TRUE(libraries.contains(name)) << library;
    EXPECT_EQ(name + " " + libraries[name].get<std::string>(), library);
  }
}

TEST(Provenance, TellsTheTimeInUtcByIso8601) {
  const std::string date = provenance(1)["date"];
  EXPECT_TRUE(std::regex_match(date, std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)"))) << date;
}

TEST(VersionText, NamesTheTermsThatTheLinkedLibrariesSet) {
  const std::string text = version_text();
  const bool gpl = has_backend(Backend::cholmod);
  EXPECT_EQ(text.find("GPL-2.0-or-later") != std::string::npos, gpl) << text;
  EXPECT_EQ(text.find("CeCILL-C") != std::string::npos, has_backend(Backend::mumps)) << text;
  EXPECT_NE(text.find("BSD-3-Clause"), std::string::npos);
  EXPECT_EQ(text.substr(0, 10), "stickslip ");
}

}  // namespace
}  // namespace stickslip
