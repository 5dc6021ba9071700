/// Folders that results are written to, in which files of others may stand as well.
///
/// FOLDER/.stickslip lists what this program wrote there, each file with the sum of its content, and does so before the
/// file is written: a run that is killed leaves nothing that it would not know again. A file is the program's own if it
/// is listed with the sum that it has. A file of lines, each of which holds a sum of its own, is listed without one.
/// All else is somebody's: what was never listed, what was edited since, links, folders. It is neither replaced nor
/// deleted. (figures/ has a list of its own.)
///
/// Names may be patterns: * stands for any characters (and never for the list), # for digits, "figures/*.svg" for files
/// of a folder within.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "studies/io/directory_lock.hpp"

namespace stickslip {

/// A folder that this process alone writes to, until the end of the scope. If it was made and nothing came of it, it is
/// gone then.
class OutputFolder {
 public:
  /// Makes the folder, locks it, and takes away what killed processes left half written. Throws InputFault if it cannot
  /// be written to, or if a file that `names` stand for is there and not the program's own; each is named with the
  /// reason, and nothing was written. Throws DirectoryInUse if another process holds it.
  OutputFolder(const std::filesystem::path& folder, const std::vector<std::string>& names);
  /// Throws InputFault if the folder was deleted or moved since.
  void check() const { lock_->check(); }

 private:
  /// Folders that were not there.
  struct Made;
  std::shared_ptr<const Made> made_;
  std::unique_ptr<const DirectoryLock> lock_;  // (goes first: its file is in the folder)
};

/// What of a file the list holds.
enum class Sums { whole, of_each_line };

/// Writes a file of results, whole or not at all (write_file_atomically). Throws InputFault if what is there is not the
/// program's own, std::system_error if the disk refuses.
void write_output(const std::filesystem::path& path, std::string_view content, Sums sums = Sums::whole);

/// The same of several files in one folder, by name and content; the list is written once.
using NamedContents = std::vector<std::pair<std::string, std::string_view>>;
void write_outputs(const std::filesystem::path& folder, const NamedContents& files, Sums sums = Sums::whole);

/// Adds a line to a file of lines (append_line).
void append_output(const std::filesystem::path& path, std::string_view line);

/// Deletes the program's own files that the names stand for, and folders within that are empty then.
void remove_outputs(const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace stickslip
