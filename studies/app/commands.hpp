/// The commands of the program. Each returns the exit code: 0 done, 2 bad input, 3 the solve failed in a diagnosed way.
/// Faults go to standard error, results to files and standard output.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/sweep/run_study.hpp"

namespace stickslip {

struct RunArguments {
  std::string scene;
  std::optional<std::string> method;
  std::vector<std::string> overrides;
  std::string output;     ///< directory; empty: results/NAME OF THE SCENE (with `json`: nothing is written)
  bool json = false;      ///< one JSON document on standard output and nothing else
  bool report = false;    ///< write report.html, and picture.json, which it draws
  bool trace = false;     ///< print every iterate, and write trace.csv
  std::string export_to;  ///< directory for the linear system of the last step; empty: none
  bool writes_results() const { return !json || !output.empty(); }
};

struct CompareArguments {
  std::string before, after;  ///< directories
  double relative = 0.05, rounding = 1e-11;
  bool json = false;
};

struct VerifyArguments {
  std::string directory;
  std::string solution;  ///< file of another program's solution; empty: that of the run
  bool json = false;
};

struct ReportArguments {
  std::string directory;
  bool pdf = false;  ///< figures also as PDF
};

int run_command(const RunArguments& arguments);
int explain_command(const RunArguments& arguments);
int gradcheck_command(const RunArguments& arguments);
int methods_command(bool json);
int schema_command(const std::string& kind);  ///< "scene" or "study"
int study_command(const StudyArguments& arguments);
int merge_command(const std::vector<std::string>& directories, const std::string& output);
int compare_command(const CompareArguments& arguments);
int verify_command(const VerifyArguments& arguments);
int report_command(const ReportArguments& arguments);

}  // namespace stickslip
