#include "studies/io/printing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/io/diagnostics.hpp"
#include "studies/io/numerals.hpp"
#include "studies/io/wording.hpp"

namespace stickslip {
namespace {

TEST(Printing, ShowsWhatWouldMoveTheCursor) {
  EXPECT_EQ(printable("plain, \xC3\xA4 and \xE2\x82\xAC"), "plain, \xC3\xA4 and \xE2\x82\xAC");
  EXPECT_EQ(printable("a\x1b[31mb\r\n\t"), "a\\u001b[31mb\\u000d\\n\\t");
  EXPECT_EQ(printable("\x7f\xC2\x9b"), "\\u007f\\u009b");  // the second is an escape sequence of one character
  EXPECT_EQ(printable("\xE2\x80\xAE"), "\\u202e");         // turns the direction of writing
  EXPECT_EQ(printable("\xff\xC3"), "\\xff\\xc3");
  EXPECT_EQ(printable_lines("a\nb\x1b"), "a\nb\\u001b");
}

TEST(Printing, KnowsUtf8) {
  for (const char* text : {"", "a", "\xC3\xA4", "\xE2\x82\xAC", "\xF0\x9F\x98\x80"}) EXPECT_TRUE(is_utf8(text)) << text;
  // a byte alone, cut short, overlong, a surrogate, beyond the last character
  for (const char* text : {"\x80", "\xE2\x82", "\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\xff"})
    EXPECT_FALSE(is_utf8(text)) << text;
}

TEST(Printing, WritesAnyBytesAsJson) { EXPECT_EQ(json_text({{"a", "b\xff"}}), "{\"a\":\"b\xEF\xBF\xBD\"}"); }

TEST(Printing, WritesJsonWithNumbersAsPagesHaveThem) {
  const nlohmann::json method = {{"penalty", {{"scale", "auto"}, {"list", {1, 0.5, true}}, {"stiffness", 1e10}}}};
  EXPECT_EQ(json_with_exact_numbers(method),
            "{\"penalty\":{\"list\":[1,0.5,true],\"scale\":\"auto\",\"stiffness\":1e10}}");
  EXPECT_EQ(json_with_exact_numbers(1e-12), "1e-12");
  EXPECT_EQ(json_with_exact_numbers(nlohmann::json::array()), "[]");
}

/// What bash makes of a word, by bash itself.
std::string through_bash(const std::string& word) {
  const std::string script = "printf %s " + shell_word(word);
  FILE* const pipe = ::popen(("bash <<'END_OF_SCRIPT'\n" + script + "\nEND_OF_SCRIPT\n").c_str(), "r");
  std::string out;
  for (int c; (c = std::fgetc(pipe)) != EOF;) out += static_cast<char>(c);
  ::pclose(pipe);
  return out;
}

TEST(Printing, QuotesWordsForTheShell) {
  EXPECT_EQ(shell_word("results/a-1.json"), "results/a-1.json");
  for (const std::string word : {"a b", "it's", "$HOME `now`", "a\nb", "\xff\x1b", "{}", "", "\\", "~"})
    EXPECT_EQ(through_bash(word), word) << shell_word(word);
}

TEST(Printing, KeepsFormulasOutOfSpreadsheets) {
  EXPECT_EQ(csv_text("press"), "press");
  EXPECT_EQ(csv_text("a,\"b\""), "\"a,\"\"b\"\"\"");
  for (const char* text : {"=1+1", "+1", "-1", "@sum"}) EXPECT_EQ(csv_text(text), "'" + std::string(text));
  EXPECT_EQ(csv_text("\t=1"), "'\t=1");
  EXPECT_EQ(csv_text("=a,b"), "\"'=a,b\"");
}

TEST(Printing, KeepsEscapeSequencesOutOfTables) {
  EXPECT_EQ(csv_text("a\x1b[2J\x07"), "a\\u001b[2J\\u0007");
  EXPECT_EQ(csv_text("a\nb\tc"), "\"a\nb\tc\"");
}

TEST(Printing, EndsAListOfManyNames) {
  std::vector<std::string> names(50, "n");
  EXPECT_THAT(listed(names), testing::EndsWith("n, ... (50 in all)"));
}

TEST(Diagnostics, TellAHundredFaultsAndCountTheRest) {
  Diagnostics diagnostics;
  for (int i = 0; i < 20'000; ++i) {
    diagnostics.error({{"a.json", i + 1, 1}, "/x/" + std::to_string(i), "is wrong"});
    diagnostics.error({{"a.json", i + 1, 1}, "/x/" + std::to_string(i), "is wrong"});
  }
  EXPECT_EQ(diagnostics.error_count(), 20'000u);
  const std::string text = diagnostics.text();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 101);
  EXPECT_THAT(text, testing::EndsWith("a.json:100:1: /x/99: is wrong\n... and 19900 more faults\n"));
  EXPECT_TRUE(diagnostics.has_error_in("/x"));
  EXPECT_TRUE(diagnostics.has_error_in("/x/7"));
  EXPECT_FALSE(diagnostics.has_error_in("/x/7/a"));
  EXPECT_FALSE(diagnostics.has_error_in("/"));
}

TEST(Diagnostics, AreOneLineEach) {
  Diagnostics diagnostics;
  diagnostics.error({{"a\n.json"}, "/\x1b[2J", "is wrong"});
  EXPECT_EQ(diagnostics.text(), "a\\n.json: /\\u001b[2J: is wrong\n");
}

TEST(Wrapped, BreaksBetweenPiecesAndIndentsWhatGoesOn) {
  const std::vector<std::string> row{"  pull  1.0", "d/dmu  2.0", "d/dE  3.0"};
  EXPECT_EQ(wrapped(row, "   ", 4, 1000), "  pull  1.0   d/dmu  2.0   d/dE  3.0");
  EXPECT_EQ(wrapped(row, "   ", 4, 24), "  pull  1.0   d/dmu  2.0\n    d/dE  3.0");
  EXPECT_EQ(wrapped(row, "   ", 4, 23), "  pull  1.0\n    d/dmu  2.0\n    d/dE  3.0");
  EXPECT_EQ(wrapped(row, "   ", 4, 5), "  pull  1.0\n    d/dmu  2.0\n    d/dE  3.0");  // no piece is cut
  EXPECT_EQ(wrapped({}, "   ", 4, 5), "");
}

TEST(WrappedLines, BreakAtSingleSpaces) {
  EXPECT_EQ(wrapped_lines("one two three\nfour\n", 2, 7), "one two\n  three\nfour\n");
  EXPECT_EQ(wrapped_lines("one two three\nfour\n", 2, 1000), "one two three\nfour\n");
  EXPECT_EQ(wrapped_lines("  a      12 b  34", 2, 12), "  a      12\n  b  34");
  EXPECT_EQ(wrapped_lines("", 2, 10), "");
}

TEST(Printing, WrapsRowsSoThatColumnsStayUnderOneAnother) {
  const std::string table = "name      time     error  verdict\npress      1.5   2.0e-13  agrees\n";
  EXPECT_EQ(wrapped_rows(table, 2, 100), table);
  EXPECT_EQ(wrapped_rows(table, 2, 16),
            "name      time\n       error\n    verdict\npress      1.5\n     2.0e-13\n    agrees\n");
  EXPECT_EQ(wrapped_rows(table, 2, 25),
            "name      time     error\n    verdict\npress      1.5   2.0e-13\n    agrees\n");
  EXPECT_EQ(wrapped_rows("one two three", 2, 9), "one two\n  three");
  EXPECT_EQ(wrapped_rows("{\"a\":1,\"b\":2}", 2, 9), "{\"a\":1,\n  \"b\":2}");
  EXPECT_EQ(wrapped_rows("unbreakable\n\n", 2, 4), "unbreakable\n\n");
}

}  // namespace
}  // namespace stickslip
