/// A study from its file to its rows and their report: what the command line and the Python module share.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "studies/io/diagnostics.hpp"

namespace stickslip {

struct StudyArguments {
  std::string study;
  std::string output;         ///< directory; empty: results/NAME, the name of the file without .json
  bool resume = false;        ///< keep the rows that are there
  bool restart = false;       ///< delete them; with neither they are a fault
  std::string shard = "1/1";  ///< share of the cells, "i/N"
  int jobs = 1;               ///< processes of the accuracy pass
};

/// What a study left.
struct StudyOutcome {
  std::filesystem::path directory;
  long cells = 0;                    ///< of the shard
  long run = 0;                      ///< of these, now
  long failed = 0;                   ///< of those that ran now, without a converged result; each has its row
  long lost = 0;                     ///< without a row: their processes were ended from outside
  std::vector<std::string> refuted;  ///< of the shard, a line for each certificate that does not hold
};

/// What the names of the files of a study are.
std::vector<std::string> study_files();

/// Runs the cells that are missing, times them and writes the report. Progress and notes go to `log`; `on_run` is
/// called after each run, and what it throws ends the study, whose finished cells are on the disk. None where the study
/// or its scene has a fault: all are in the diagnostics, and nothing was written. Throws InputFault where the directory
/// is not to be written to, std::system_error where the disk refuses. Cells run in processes of their own; pre: the
/// caller's other threads hold nothing that a run needs.
std::optional<StudyOutcome> run_study(const StudyArguments& arguments, std::ostream& log, Diagnostics& diagnostics,
                                      const std::function<void()>& on_run = {});

}  // namespace stickslip
