#include "studies/io/json_document.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace stickslip {
namespace {

using testing::HasSubstr;

std::string place_of(const JsonDocument& document, const std::string& pointer) {
  const Place place = document.place(pointer);
  return std::to_string(place.line) + ":" + std::to_string(place.column);
}

JsonDocument parsed(const std::string& text) {
  Diagnostics diagnostics;
  auto document = JsonDocument::parse(text, "file.json", diagnostics);
  EXPECT_EQ(diagnostics.text(), "");
  return document.value();
}

std::string faults_of(const std::string& text) {
  Diagnostics diagnostics;
  EXPECT_FALSE(JsonDocument::parse(text, "file.json", diagnostics).has_value());
  return diagnostics.text();
}

TEST(JsonDocument, KnowsWhereEachValueBegins) {
  const auto document = parsed(
      "{\n  \"a\": 1, // a comment, with \"quotes\"\n  /* two\n lines */ \"b\": {\"c\" : [true,\n"
      "null, -1.5e3 , \"x\\\"y\"], \"d\":{}}\n}\n");
  EXPECT_EQ(place_of(document, ""), "1:1");
  EXPECT_EQ(place_of(document, "/a"), "2:8");
  EXPECT_EQ(place_of(document, "/b"), "4:16");
  EXPECT_EQ(place_of(document, "/b/c"), "4:23");
  EXPECT_EQ(place_of(document, "/b/c/0"), "4:24");
  EXPECT_EQ(place_of(document, "/b/c/1"), "5:1");
  EXPECT_EQ(place_of(document, "/b/c/2"), "5:7");
  EXPECT_EQ(place_of(document, "/b/c/3"), "5:16");
  EXPECT_EQ(place_of(document, "/b/d"), "5:29");
  EXPECT_EQ(document.root()["b"]["c"][2], -1500.0);
  EXPECT_EQ(document.key_place("/b/c").column, 17);
}

TEST(JsonDocument, CountsCharactersNotBytes) {
  // a byte order mark, then a key of two characters in five bytes
  const auto document = parsed("\xEF\xBB\xBF{\"\xC3\xA9\xE2\x82\xAC\": 1, \"b\": 2}");
  EXPECT_EQ(place_of(document, "/\xC3\xA9\xE2\x82\xAC"), "1:8");
  EXPECT_EQ(place_of(document, "/b"), "1:16");
}

TEST(JsonDocument, EndsALineAtLineFeedsOfEitherKind) {
  const auto document = parsed("{\r\n\"a\":\r\n 1}");
  EXPECT_EQ(place_of(document, "/a"), "3:2");
}

TEST(JsonDocument, EscapesSlashAndTildeInPointers) {
  const auto document = parsed(R"({"a/b": {"c~d": 7}})");
  EXPECT_EQ(place_of(document, "/a~1b/c~0d"), "1:17");
  ASSERT_NE(value_at(document.root(), "/a~1b/c~0d"), nullptr);
  EXPECT_EQ(*value_at(document.root(), "/a~1b/c~0d"), 7);
}

TEST(JsonDocument, GivesThePlaceOfWhatIsAroundAValueThatIsMissing) {
  EXPECT_EQ(place_of(parsed("{\"a\": {}}"), "/a/b/c"), "1:7");
}

struct BadText {
  const char* name;
  std::string text, first_line;
};
class BadTexts : public testing::TestWithParam<BadText> {};

TEST_P(BadTexts, AreRefusedWithTheirPlace) {
  EXPECT_THAT(faults_of(GetParam().text), testing::StartsWith("file.json:" + GetParam().first_line));
}

INSTANTIATE_TEST_SUITE_P(
    JsonDocument, BadTexts,
    testing::Values(
        BadText{"trailing_comma", "{\"a\": 1,\n}",
                "1:8: is not JSON: a comma stands before the } that ends the object; take the comma out"},
        BadText{"trailing_comma_of_a_list", "{\"a\": [1, 2 , // two\n ]}",
                "1:13: is not JSON: a comma stands before the ] that ends the list; take the comma out"},
        BadText{"no_comma", "{\"a\": {\"b\": 1} // one\n  \"c\": 2}",
                "1:15: is not JSON: a comma is missing here, before the next key"},
        BadText{"no_comma_in_a_list", "{\"a\": [1\n-2]}",
                "1:9: is not JSON: a comma is missing here, before the next value"},
        BadText{"no_digit_before_the_point", "{\"a\": .5}",
                "1:7: /a: is .5, which is not JSON; must be 0.5, with a digit before the point"},
        BadText{"negative_without_a_digit", "[-.25]",
                "1:2: /0: is -.25, which is not JSON; must be -0.25, with a digit before the point"},
        BadText{"no_value", "{\"a\": }", "1:7: is not JSON: syntax error while parsing value"},
        BadText{"two_commas", "[1,, 2]", "1:4: is not JSON: syntax error while parsing value - unexpected ','"},
        BadText{"missing_colon", "{\"a\" 1}", "1:6: is not JSON: "},
        BadText{"bare_word", "{\n \"a\": yes}", "2:7: is not JSON: "},
        BadText{"open_text", "{\"a\":\n  \"abc", "2:3: is not JSON: "},
        BadText{"line_in_text", "{\"a\": \"ab\nc\"}", "1:10: is not JSON: "},
        BadText{"bad_escape", "{\"a\": \"\\q\"}", "1:9: is not JSON: "},
        BadText{"ends_early", "{\"a\": [1, 2", "1:12: is not JSON: "}, BadText{"empty", "", "1:1: is not JSON: "},
        BadText{"more_after_the_end", "{} {}", "1:4: is not JSON: "},
        BadText{"nan", "{\"a\": NaN}", "1:7: /a: is NaN; must be a finite number"},
        BadText{"infinity", "{\"a\": [0, Infinity]}", "1:11: /a/1: is Infinity; must be a finite number"},
        BadText{"minus_infinity", "[-Infinity]", "1:2: /0: is -Infinity; must be a finite number"},
        BadText{"overflow", "{\"a\":\n 1e999}", "2:2: /a: is a number beyond the range of a double"},
        BadText{"hexadecimal", "{\"friction\": 0x3\n\n\n}", "1:14: /friction: is 0x3, which is not JSON"},
        BadText{"number_in_letters", "{\"a\": {\"steps\": 12abc\n}}", "1:17: /a/steps: is 12abc, which"},
        BadText{"two_zeros", "[1,\n 00.3\n]", "2:2: /1: is 00.3, which is not JSON"},
        BadText{"two_numbers", "[1 2\n]", "1:3: is not JSON: a comma is missing here, before the next value"},
        BadText{"open_comment", "{\"a\": 1 /* }", "1:13: is not JSON: "},
        BadText{"too_deep", std::string(100000, '['), "1:65: is nested deeper"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(JsonDocument, ReportsEveryKeyThatIsGivenTwice) {
  EXPECT_EQ(faults_of("{\"a\": 1,\n \"b\": {\"c\": 1, \"c\": 2},\n \"a\": 2}"),
            "file.json:2:16: /b/c: the key \"c\" is given twice, first in line 2\n"
            "file.json:3:2: /a: the key \"a\" is given twice, first in line 1\n");
}

TEST(JsonDocument, AllowsAKeyInSeveralObjects) { parsed(R"([{"a": 1}, {"a": {"a": 2}}])"); }

TEST(JsonDocument, SaysThatAFileIsEmptyOrNoText) {
  const auto file = std::filesystem::path(testing::TempDir()) / fmt::format("stickslip_{}_no_text.json", ::getpid());
  const auto fault_of = [&](const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
    Diagnostics diagnostics;
    EXPECT_FALSE(JsonDocument::read(file.string(), diagnostics).has_value());
    return diagnostics.text();
  };
  EXPECT_EQ(fault_of(" \n"), file.string() + ":1:1: is empty; must be a JSON object, {...}\n");
  for (const std::string& content : {std::string("{\0}", 3), std::string("\xFF\xFE{")})
    EXPECT_EQ(fault_of(content),
              file.string() + ":1:1: is no text, or not in UTF-8; must be a JSON object, {...}, in UTF-8\n");
  std::filesystem::remove(file);
}

TEST(JsonDocument, NamesTheFileBesideAMissingOne) {
  Diagnostics diagnostics;
  EXPECT_FALSE(JsonDocument::read(STICKSLIP_SOURCE_DIR "/studies/scenes/slidr.json", diagnostics).has_value());
  EXPECT_EQ(diagnostics.text(), STICKSLIP_SOURCE_DIR
            "/studies/scenes/slidr.json: cannot be read: there is no such file; did you mean \"slider.json\"?\n");
}

TEST(JsonDocument, ReportsAFileThatCannotBeRead) {
  Diagnostics diagnostics;
  EXPECT_FALSE(JsonDocument::read("no/such/file.json", diagnostics).has_value());
  EXPECT_EQ(diagnostics.text(), "no/such/file.json: cannot be read: there is no such file\n");
  Diagnostics of_directory;
  EXPECT_FALSE(JsonDocument::read(".", of_directory).has_value());
  EXPECT_EQ(of_directory.text(), ".: is a directory; must be a file\n");
}

TEST(JsonDocument, SurvivesEveryTruncationOfAText) {
  const std::string text = "{\"a\": [1, -2.5e-3, \"\\u00e9\\n\", {\"b\": null}], // end\n \"c\": {\"d\": true}}";
  for (std::size_t length = 0; length < text.size(); ++length) {
    Diagnostics diagnostics;
    EXPECT_FALSE(JsonDocument::parse(text.substr(0, length), "f", diagnostics).has_value()) << length;
    EXPECT_EQ(diagnostics.error_count(), 1u) << length;
  }
}

TEST(Override, ChangesAValueAndTakesItsPlace) {
  auto document = parsed(R"({"a": {"b": [1, 2]}, "s": "x"})");
  Diagnostics diagnostics;
  document.override_value("/a/b/1=0.5", diagnostics);
  document.override_value("/s=plain text", diagnostics);
  EXPECT_EQ(diagnostics.text(), "");
  EXPECT_EQ(document.root(), nlohmann::json::parse(R"({"a": {"b": [1, 0.5]}, "s": "plain text"})"));
  EXPECT_EQ(document.place("/a/b/1").source, "--set /a/b/1=0.5");
  EXPECT_EQ(document.place("/a/b/0").source, "file.json");
  document.override_value("/a/b=[[0, 0], [1, 3]]", diagnostics);
  EXPECT_EQ(document.root()["a"]["b"][1][1], 3);
  EXPECT_EQ(document.place("/a/b/1/1").source, "--set /a/b=[[0, 0], [1, 3]]");
}

TEST(Override, RefusesWhatNamesNoValue) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"/contacts/sloe/friction=1", "has no \"sloe\"; did you mean \"sole\"? it has sole"},
      {"/contacts/sole=1", "names an object"},
      {"/contacts/sole/friction", "is not POINTER=VALUE"},
      {"contacts=1", "is no JSON pointer"},
      {"=1", "is no JSON pointer; must begin with /"},
      {"/contacts/sole/~=1", "in a name ~ is written ~0"},
      {"/contacts/s~ole/friction=1", "in a name ~ is written ~0"},
      {"/none/0=1", "/none is empty"},
      {R"(/list/0={"a": 1, "a": 2})", "the key \"a\" is given twice"},
      {"/list/7=1", "/list has elements 0 to 1"},
      {"/list/01=1", "/list has elements 0 to 1"},
      {"/contacts/sole/friction/x=1", "/contacts/sole/friction is 0.3 and holds no \"x\""},
      {"/contacts/sole/friction=abc", "\"abc\" is not a value of JSON"},
      {"/contacts/sole/friction=NaN", "\"NaN\" is not a value of JSON"},
      {"/contacts/sole/friction=1e999", "\"1e999\" is not a value of JSON"},
  };
  for (const auto& [assignment, message] : faults) {
    auto document = parsed(R"({"contacts": {"sole": {"friction": 0.3}}, "list": [1, 2], "none": []})");
    const auto before = document.root();
    Diagnostics diagnostics;
    document.override_value(assignment, diagnostics);
    EXPECT_THAT(diagnostics.text(), testing::StartsWith("--set " + assignment + ": "));
    EXPECT_THAT(diagnostics.text(), HasSubstr(message));
    EXPECT_EQ(document.root(), before);
  }
}

TEST(Override, MayAddAnOptionalKeyToAnObjectThatIsThere) {
  auto document = parsed(R"({"contacts": {"sole": {"friction": 0.3}}})");
  Diagnostics diagnostics;
  document.override_value("/contacts/sole/offset=0.1", diagnostics);
  EXPECT_FALSE(diagnostics.has_errors()) << diagnostics.text();
  EXPECT_EQ(document.root()["contacts"]["sole"]["offset"], 0.1);
}

TEST(Diagnostics, ListsFaultsInTheOrderOfTheFile) {
  Diagnostics diagnostics;
  diagnostics.error({{"a.json", 7, 1}, "/x", "late"});
  diagnostics.error({{"a.json", 2, 9}, "/y", "early"});
  diagnostics.error({{"a.json", 2, 3}, "", "first"});
  EXPECT_EQ(diagnostics.text(), "a.json:2:3: first\na.json:2:9: /y: early\na.json:7:1: /x: late\n");
  EXPECT_TRUE(diagnostics.has_error_in("/x"));
  EXPECT_FALSE(diagnostics.has_error_in("/z"));
}

TEST(Suggestion, NamesTheNearestWithinTwoEditsOrTheOneThatHoldsTheOther) {
  const std::vector<std::string> names{"friction", "slave", "on"};
  EXPECT_EQ(suggestion("fricton", names), " did you mean \"friction\"?");
  EXPECT_EQ(suggestion("slaev", names), " did you mean \"slave\"?");
  EXPECT_EQ(suggestion("fric", names), " did you mean \"friction\"?");
  EXPECT_EQ(suggestion("xy", names), "");
  EXPECT_EQ(suggestion("friction_coefficient", names), " did you mean \"friction\"?");
  EXPECT_EQ(suggestion("in", names), " did you mean \"on\"?");
  EXPECT_EQ(suggestion("uu", {"u/N", "u"}), " did you mean \"u\"?");
  EXPECT_EQ(suggestion("monolithic", {"penalty", "monolithic_al"}), " did you mean \"monolithic_al\"?");
  EXPECT_EQ(suggestion("width", {"contact_force", "contact_half_width"}), " did you mean \"contact_half_width\"?");
  EXPECT_EQ(suggestion(std::string(100000, 'x'), names), "");
}

TEST(Fingerprint, IsThePublishedHash) {  // test vectors of the FNV reference code
  EXPECT_EQ(fingerprint(""), "cbf29ce484222325");
  EXPECT_EQ(fingerprint("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(fingerprint("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace stickslip
