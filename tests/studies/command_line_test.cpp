#include "studies/app/command_line.hpp"

#include <gtest/gtest.h>

namespace stickslip {
namespace {

using Words = std::vector<std::string>;

TEST(SetInTwoWords, IsToBeJoined) {
  EXPECT_EQ(set_in_two_words({"stickslip", "run", "a.json", "--set", "/contacts/sole/friction", "0.4"}),
            "--set /contacts/sole/friction 0.4: is two words; must be one, with = between: "
            "--set /contacts/sole/friction=0.4");
  EXPECT_NE(set_in_two_words({"--set", "/offset", "-0.4", "a.json"}), "");
  EXPECT_NE(set_in_two_words({"--set", "/a=1", "--set", "/b", "2"}), "");
}

TEST(SetInTwoWords, MayHaveSpacesAroundItsSign) {
  for (const Words& words :
       {Words{"--set", "/a/b", "=", "0.4"}, {"--set", "/a/b", "=0.4"}, {"--set", "/a/b=", "0.4"}}) {
    const std::string text = set_in_two_words(words);
    EXPECT_TRUE(text.ends_with(": must be one word, without spaces: --set /a/b=0.4")) << text;
  }
}

TEST(SetInTwoWords, IsNotFoundWhereItIsOneWord) {
  EXPECT_EQ(set_in_two_words({"--set", "/a=1", "a.json"}), "");
  EXPECT_EQ(set_in_two_words({"--set", "/a", "a.json"}), "");  // its own fault names the missing value
  EXPECT_EQ(set_in_two_words({"--set", "/a", "--json"}), "");
  EXPECT_EQ(set_in_two_words({"--set", "/a"}), "");
}

const Words options{"--output", "--method", "--set", "--json"};

TEST(UnexpectedWord, MayBeAnOptionOfAMethod) {
  const std::string text =
      "--stiffness is no option of run, but one of the method penalty; try -m penalty --set "
      "/method/penalty/stiffness=100";
  EXPECT_EQ(unexpected_word("run", options, {"--stiffness", "100"}), text);
  EXPECT_EQ(unexpected_word("run", options, {"--stiffness=100"}), text);
  EXPECT_EQ(unexpected_word("run", options, {"--stiffness", "a.json"}),
            "--stiffness is no option of run, but one of the method penalty; try -m penalty --set "
            "/method/penalty/stiffness=VALUE");
  EXPECT_EQ(unexpected_word("run", options, {"--scale", "2"}),
            "--scale is no option of run, but one of the method uzawa_al and of monolithic_al; try -m uzawa_al --set "
            "/method/uzawa_al/scale=2");
}

TEST(UnexpectedWord, GetsTheNearestOption) {
  EXPECT_EQ(unexpected_word("run", options, {"--metod=penalty"}),
            "run has no option \"--metod\"; did you mean \"--method\"? allowed: --output, --method, --set, --json");
  EXPECT_EQ(unexpected_word("run", {"--set"}, {"--stifness=4"}),
            "run has no option \"--stifness\"; did you mean \"--stiffness\"? allowed: --set");
  EXPECT_EQ(unexpected_word("report", {"--pdf"}, {"--stiffness"}),
            "report has no option \"--stiffness\"; allowed: --pdf");
}

TEST(UnexpectedWord, MayBeOneTooMany) {
  EXPECT_EQ(unexpected_word("run", options, {"b.json"}),
            "run takes no further word \"b.json\"; see stickslip run --help");
}

}  // namespace
}  // namespace stickslip
