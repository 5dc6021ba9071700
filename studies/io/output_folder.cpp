#include "studies/io/output_folder.hpp"

#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>

#include "studies/io/atomic_file.hpp"
#include "studies/io/json_document.hpp"
#include "studies/io/printing.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

constexpr const char* list_name = ".stickslip";
constexpr std::string_view list_head = "Files that stickslip wrote here: sum, process, name. It replaces no others.";
constexpr std::string_view without_sum = "lines";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Whether a pattern stands for the name.
bool stands_for(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() != '*' && pattern.front() != '#')
    return !name.empty() && name.front() == pattern.front() && stands_for(pattern.substr(1), name.substr(1));
  const bool digits = pattern.front() == '#';
  if (!digits && stands_for(pattern.substr(1), name)) return true;
  for (std::size_t n = 0; n < name.size() && (!digits || is_digit(name[n])); ++n)
    if (stands_for(pattern.substr(1), name.substr(n + 1))) return true;
  return false;
}

bool is_regular(const fs::path& path) {
  std::error_code none;
  return fs::is_regular_file(fs::symlink_status(path, none));
}

/// A folder, and no link to one.
bool is_folder(const fs::path& path) {
  std::error_code none;
  return fs::is_directory(fs::symlink_status(path, none));
}

bool is_there(const fs::path& path) {
  std::error_code none;
  return fs::exists(fs::symlink_status(path, none));
}

/// The list of a folder.
class List {
 public:
  struct Entry {
    std::string sum, process, name;
  };

  /// Throws InputFault if the file of its name is another's.
  explicit List(fs::path folder) : folder_(std::move(folder)) {
    if (!is_there(path())) return;
    const auto lines = is_regular(path()) ? read_lines(path()) : std::vector<std::string>();
    if (lines.empty() || lines.front() != list_head)
      throw InputFault(path().string() +
                       ": is not the list that stickslip keeps under this name; move it, or name another directory");
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const std::string& line = lines[i];
      const std::size_t first = line.find(' '), second = line.find(' ', first + 1);
      if (first == std::string::npos || second == std::string::npos) continue;
      entries_.push_back({line.substr(0, first), line.substr(first + 1, second - first - 1), line.substr(second + 1)});
    }
  }

  bool names(const std::string& name) const {
    return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.name == name; });
  }

  /// The sum by which a file that is there is the program's own; "" if it is not.
  std::string own_sum(const std::string& name) const {
    if (!names(name) || !is_regular(folder_ / name)) return "";
    const auto is_listed = [&](std::string_view sum) {
      return std::any_of(entries_.begin(), entries_.end(),
                         [&](const Entry& entry) { return entry.name == name && entry.sum == sum; });
    };
    if (is_listed(without_sum)) return std::string(without_sum);
    const std::string sum = fingerprint(read_file(folder_ / name));
    return is_listed(sum) ? sum : "";
  }

  bool owns(const std::string& name) const { return !own_sum(name).empty(); }

  /// What is to be said of a file that is not the program's own.
  std::string fault(const std::string& name) const {
    const fs::path file = folder_ / name;
    std::error_code none;
    const auto status = fs::symlink_status(file, none);
    if (fs::is_symlink(status)) return "is a link";
    if (fs::is_directory(status)) return "is a directory";
    if (!fs::is_regular_file(status)) return "is no file";
    return names(name) ? "was edited since stickslip wrote it" : "was not written by stickslip, as far as it knows";
  }

  /// Lists what the file is to hold beside what it holds now. Throws InputFault if that is not the program's own.
  void add(const std::string& name, std::string_view content, Sums sums) {
    const std::string now = own_sum(name);
    if (now.empty() && is_there(folder_ / name))
      throw InputFault((folder_ / name).string() + ": " + fault(name) + "; move it, or name another directory");
    const std::string next = sums == Sums::whole ? fingerprint(content) : std::string(without_sum);
    std::erase_if(entries_, [&](const Entry& entry) { return entry.name == name; });
    for (const auto& sum : std::set<std::string>{now, next})
      if (!sum.empty()) entries_.push_back({sum, std::to_string(::getpid()), name});
  }

  /// Deletes a file that is the program's own.
  bool remove(const std::string& name) {
    if (!owns(name)) return false;
    fs::remove(folder_ / name);
    std::erase_if(entries_, [&](const Entry& entry) { return entry.name == name || !is_there(folder_ / entry.name); });
    return true;
  }

  void write() const {
    if (entries_.empty()) {
      fs::remove(path());
      return;
    }
    std::string text(list_head);
    text += "\n";
    for (const auto& entry : entries_) text += entry.sum + " " + entry.process + " " + entry.name + "\n";
    write_file_atomically(path(), text);
  }

  /// Takes away the temporary files of processes that ended while they wrote. pre: no other process writes here.
  void sweep() const {
    std::set<std::string> left;
    for (const auto& entry : entries_) left.insert(temporary_of(entry.name, entry.process));
    for (const auto& entry : fs::directory_iterator(folder_))
      if (const std::string name = entry.path().filename();
          (left.count(name) > 0 || stands_for(temporary_of(list_name, "#"), name)) && is_regular(entry.path()))
        fs::remove(entry.path());
  }

 private:
  fs::path path() const { return folder_ / list_name; }

  fs::path folder_;
  std::vector<Entry> entries_;
};

/// Files of a folder that names stand for, by the folder within that they are in ("" for the folder itself). A link, or
/// a file, that has the name of a folder within stands for what it hides.
std::map<std::string, std::vector<std::string>> files_of(const fs::path& folder,
                                                         const std::vector<std::string>& names) {
  std::map<std::string, std::vector<std::string>> patterns, files;
  for (const auto& name : names) {
    const auto slash = name.rfind('/');
    const bool within = slash != std::string::npos;
    patterns[within ? name.substr(0, slash) : ""].push_back(within ? name.substr(slash + 1) : name);
  }
  for (const auto& [inner, of_inner] : patterns) {
    const fs::path place = inner.empty() ? folder : folder / inner;
    if (!inner.empty() && !is_folder(place)) {
      if (is_there(place)) files[""].push_back(inner);
      continue;
    }
    for (const auto& entry : fs::directory_iterator(place)) {
      const std::string name = entry.path().filename();
      if (name == list_name) continue;
      if (std::any_of(of_inner.begin(), of_inner.end(), [&](const auto& pattern) { return stands_for(pattern, name); }))
        files[inner].push_back(name);
    }
  }
  return files;
}

/// What of the names is in the way, a line each; "" where nothing is.
std::string in_the_way(const fs::path& folder, const std::vector<std::string>& names) {
  std::set<std::string> faults;
  for (const auto& [inner, files] : files_of(folder, names)) {
    const List list(inner.empty() ? folder : folder / inner);
    for (const auto& file : files)
      if (!list.owns(file)) faults.insert(printable((fs::path(inner) / file).string()) + ": " + list.fault(file));
  }
  constexpr std::size_t most = 100;
  std::string text;
  std::size_t listed = 0;
  for (const auto& fault : faults) {
    if (++listed > most) return text + "  and " + std::to_string(faults.size() - most) + " more\n";
    text += "  " + fault + "\n";
  }
  return text;
}

void make_folder(const fs::path& folder) {
  check_folder(folder);
  std::error_code error;
  fs::create_directories(folder, error);
  const bool denied = error == std::errc::permission_denied || error == std::errc::read_only_file_system;
  if (error)
    throw InputFault(folder.string() + ": cannot be made: " + error.message() +
                     (denied ? "; must be where you may write" : ""));
}

void check_writable(const fs::path& folder) {
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputFault(folder.string() + ": cannot be written to; must be a directory that you may write to");
}

/// Folders within that names are in, and that are there.
std::set<fs::path> folders_of(const fs::path& folder, const std::vector<std::string>& names) {
  std::set<fs::path> all{folder};
  for (const auto& name : names)
    if (const fs::path inner = folder / fs::path(name).parent_path(); is_folder(inner)) all.insert(inner);
  return all;
}

}  // namespace

struct OutputFolder::Made {
  std::vector<fs::path> folders;  ///< each in the next
  explicit Made(const fs::path& folder) {
    for (fs::path each = folder; !each.empty() && !is_there(each); each = each.parent_path()) folders.push_back(each);
    make_folder(folder);
  }
  ~Made() {
    std::error_code none;
    for (const auto& folder : folders)
      if (!fs::is_empty(folder, none) || none || !fs::remove(folder, none)) return;
  }
  Made(const Made&) = delete;
  Made& operator=(const Made&) = delete;
};

OutputFolder::OutputFolder(const fs::path& folder, const std::vector<std::string>& names)
    : made_(std::make_shared<const Made>(folder)) {
  check_writable(folder);
  lock_ = std::make_unique<const DirectoryLock>(folder);
  if (const std::string faults = in_the_way(folder, names); !faults.empty())
    throw InputFault(folder.string() + ": files would be replaced that are not stickslip's own" +
                     (is_there(folder / list_name) ? ""
                                                   : " (there is no list of its files, " + std::string(list_name) +
                                                         ", as beside results of earlier versions)") +
                     ":\n" + faults + "move them, or name another directory");
  for (const auto& each : folders_of(folder, names)) {
    check_writable(each);
    List(each).sweep();
  }
}

void write_outputs(const fs::path& folder, const NamedContents& files, Sums sums) {
  fs::create_directories(folder);
  List list(folder);
  for (const auto& [name, content] : files) list.add(name, content, sums);
  list.write();
  for (const auto& [name, content] : files) write_file_atomically(folder / name, content);
}

void write_output(const fs::path& path, std::string_view content, Sums sums) {
  write_outputs(path.parent_path(), {{path.filename(), content}}, sums);
}

void append_output(const fs::path& path, std::string_view line) {
  if (!List(path.parent_path()).owns(path.filename())) write_output(path, "", Sums::of_each_line);
  append_line(path, line);
}

void remove_outputs(const fs::path& folder, const std::vector<std::string>& names) {
  for (const auto& [inner, files] : files_of(folder, names)) {
    const fs::path place = inner.empty() ? folder : folder / inner;
    List list(place);
    bool changed = false;
    for (const auto& file : files) changed = list.remove(file) || changed;
    if (!changed) continue;
    list.write();
    if (!inner.empty() && fs::is_empty(place)) fs::remove(place);
  }
}

}  // namespace stickslip
