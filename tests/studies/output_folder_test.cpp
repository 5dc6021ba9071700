#include "studies/io/output_folder.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "studies/io/atomic_file.hpp"
#include "studies/report/report.hpp"
#include "studies/sweep/run_study.hpp"
#include "tests/studies/temporary_folder.hpp"

namespace stickslip::output_folder {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class OutputFolders : public InOwnFolder {
 protected:
  /// Why the folder is refused; "" where it is not.
  static std::string refusal(const fs::path& folder, const std::vector<std::string>& names) {
    try {
      const OutputFolder held(folder, names);
      return "";
    } catch (const InputFault& fault) {
      return fault.what();
    }
  }
  std::string refusal(const std::vector<std::string>& names) const { return refusal(folder_, names); }

  void put(const std::string& name, const std::string& text = "mine") const {
    write_file_atomically(folder_ / name, text);
  }
};

/// Files of all names and kinds: what is in the way of a study is named, and nothing is touched.
TEST_F(OutputFolders, LeaveFilesOfOthersAlone) {
  const std::vector<std::string> in_the_way = {"report.html",         "picture.json",  "study.json",    "results.jsonl",
                                               "results.stale.jsonl", "timings.jsonl", "fields.pvd",    "fields_1.vtu",
                                               "fields_0060.vtu",     "figures/a.svg", "figures/b.pdf", "figures/c.pgf",
                                               "figures/d.csv",       "figures/.e.svg"};
  const std::vector<std::string> beside = {
      "README",          "report.htm",    "notes.html",  "fields_a.vtu", "fields_.vtu", "fields_1_2.vtu",
      "fields.vtu",      "trace.csv",     "cones.svg",   "result.json",  "a.part",      "report.html.1234567.part",
      ".stickslip.part", "figures/e.png", "figures/svg", "data/f.svg",   ".hidden"};
  for (const auto& name : in_the_way) put(name);
  for (const auto& name : beside) put(name);
  const std::string told = refusal(study_files());
  for (const auto& name : in_the_way) EXPECT_THAT(told, HasSubstr("  " + name + ": was not written by stickslip"));
  for (const auto& name : beside) EXPECT_THAT(told, Not(HasSubstr("  " + name + ":")));
  remove_outputs(folder_, study_files());
  remove_outputs(folder_, {"*", "figures/*", "data/*"});
  for (const auto& name : in_the_way) {
    EXPECT_THROW(write_output(folder_ / name, "ours"), InputFault) << name;
    EXPECT_THROW(append_output(folder_ / name, "ours"), InputFault) << name;
    EXPECT_EQ(read_file(folder_ / name), "mine") << name;
    fs::remove(folder_ / name);
  }
  EXPECT_EQ(refusal(study_files()), "");
  for (const auto& name : beside) EXPECT_EQ(read_file(folder_ / name), "mine") << name;
  for (const auto& entry : fs::directory_iterator(folder_))  // neither a list nor a lock is left
    EXPECT_THAT(entry.path().filename().string(), testing::AnyOf(".hidden", ".stickslip.part", Not(HasSubstr(".st"))));
}

TEST_F(OutputFolders, ReplaceAndDeleteWhatTheProgramWrote) {
  {
    const OutputFolder held(folder_, {"a.json", "figures/*"});
    write_output(folder_ / "a.json", "1");
    write_outputs(folder_ / "figures", {{"a.svg", "2"}, {"b.svg", "3"}});
    append_output(folder_ / "rows", "4");
  }
  EXPECT_EQ(refusal({"a.json", "rows", "figures/*"}), "");
  write_output(folder_ / "a.json", "5");
  append_output(folder_ / "rows", "6");
  EXPECT_EQ(read_file(folder_ / "a.json"), "5");
  EXPECT_EQ(read_file(folder_ / "rows"), "4\n6\n");
  EXPECT_EQ(refusal({"a.json", "rows", "figures/*"}), "");
  remove_outputs(folder_, {"a.json", "rows", "figures/*"});
  EXPECT_TRUE(fs::is_empty(folder_));  // the lists are gone too
}

TEST_F(OutputFolders, TakeAFileThatWasEditedForItsEditors) {
  write_output(folder_ / "report.html", "ours");
  put("report.html", "ours, and a word of mine");
  EXPECT_THAT(refusal({"report.html"}), HasSubstr("  report.html: was edited since stickslip wrote it\n"));
  EXPECT_EQ(refusal({"other"}), "");
  remove_outputs(folder_, {"*"});
  EXPECT_THROW(write_output(folder_ / "report.html", "new"), InputFault);
  EXPECT_EQ(read_file(folder_ / "report.html"), "ours, and a word of mine");
  put("report.html", "ours");
  EXPECT_EQ(refusal({"report.html"}), "");
}

TEST_F(OutputFolders, FollowNoLinks) {
  put("elsewhere/a.svg");
  fs::create_directory_symlink("elsewhere", folder_ / "figures");
  fs::create_symlink("elsewhere/a.svg", folder_ / "report.html");
  fs::create_symlink("elsewhere/new", folder_ / "results.jsonl");  // that leads nowhere
  const std::string told = refusal(study_files());
  for (const char* name : {"figures", "report.html", "results.jsonl"})
    EXPECT_THAT(told, HasSubstr("  " + std::string(name) + ": is a link\n"));
  remove_outputs(folder_, report_files());
  EXPECT_THROW(write_output(folder_ / "report.html", "ours"), InputFault);
  EXPECT_THROW(append_output(folder_ / "results.jsonl", "ours"), InputFault);
  EXPECT_EQ(read_file(folder_ / "elsewhere" / "a.svg"), "mine");
  EXPECT_FALSE(fs::exists(folder_ / "elsewhere" / "new"));
}

TEST_F(OutputFolders, NameFoldersThatStandWhereFilesGo) {
  fs::create_directories(folder_ / "report.html");
  put("figures");
  const std::string told = refusal(report_files());
  EXPECT_THAT(told, HasSubstr("  report.html: is a directory\n"));
  EXPECT_THAT(told, HasSubstr("  figures: was not written by stickslip"));
  EXPECT_EQ(refusal(folder_ / "figures", {}),
            (folder_ / "figures").string() + ": is a file; must be a directory, or a name that is free");
  EXPECT_THAT(refusal(folder_ / "figures" / "in", {}), HasSubstr(": cannot be made: Not a directory"));
  EXPECT_THAT(refusal(folder_ / std::string(300, 'x'), {}), HasSubstr(": cannot be made: File name too long"));
}

TEST_F(OutputFolders, KeepAListOrLockOfAnotherProgram) {
  put(".stickslip", "a diary\n");
  put(".lock", "of another program");
  EXPECT_THAT(refusal({"a"}), HasSubstr(".stickslip: is not the list"));
  EXPECT_THROW(write_output(folder_ / "a", "1"), InputFault);
  EXPECT_EQ(read_file(folder_ / ".stickslip"), "a diary\n");
  fs::remove(folder_ / ".stickslip");
  EXPECT_EQ(refusal({"a"}), "");
  EXPECT_EQ(read_file(folder_ / ".lock"), "of another program");
  fs::remove(folder_ / ".lock");
  fs::create_symlink("new", folder_ / ".lock");
  EXPECT_THAT(refusal({"a"}), HasSubstr(".lock: is a link or no file"));
  EXPECT_FALSE(fs::exists(folder_ / "new"));
}

/// What a killed process left half written is known by the list, which was written first.
TEST_F(OutputFolders, AreRidOfWhatKilledProcessesLeft) {
  write_output(folder_ / "a.vtu", "whole");
  const std::string process = std::to_string(::getpid());
  put("a.vtu." + process + ".part", "half");
  put(".stickslip." + process + ".part", "half");
  put("b.vtu." + process + ".part");
  put("a.vtu.1.part");
  EXPECT_EQ(refusal({"a.vtu"}), "");
  EXPECT_FALSE(fs::exists(folder_ / ("a.vtu." + process + ".part")));
  EXPECT_FALSE(fs::exists(folder_ / (".stickslip." + process + ".part")));
  EXPECT_TRUE(fs::exists(folder_ / ("b.vtu." + process + ".part")));
  EXPECT_TRUE(fs::exists(folder_ / "a.vtu.1.part"));
}

TEST_F(OutputFolders, AreHeldByOneRunAtATime) {
  const OutputFolder held(folder_, {"a"});
  EXPECT_THAT(refusal({"b"}), HasSubstr("another stickslip writes here (in this process)"));
  const pid_t child = ::fork();
  if (child == 0)
    ::_exit(refusal({"b"}).find("(process " + std::to_string(::getppid()) + ")") == std::string::npos ? 1 : 0);
  int status = -1;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
  held.check();
}

TEST_F(OutputFolders, AreGoneWhereNothingCameOfThem) {
  { const OutputFolder held(folder_ / "new" / "results", {"a"}); }
  EXPECT_FALSE(fs::exists(folder_ / "new"));
  {
    const OutputFolder held(folder_ / "new" / "results", {"a"});
    write_output(folder_ / "new" / "results" / "a", "1");
  }
  EXPECT_TRUE(fs::exists(folder_ / "new" / "results" / "a"));
  { const OutputFolder held(folder_, {"a"}); }
  EXPECT_TRUE(fs::exists(folder_));
}

}  // namespace
}  // namespace stickslip::output_folder
