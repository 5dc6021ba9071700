#include "studies/io/atomic_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "studies/io/input_fault.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* action) {
  throw std::system_error(errno, std::generic_category(), std::string(action) + " '" + path.string() + "'");
}

/// An open file, closed at the end of the scope.
class Descriptor {
 public:
  /// `called`: its name in faults.
  Descriptor(const fs::path& path, int flags, const fs::path& called)
      : path_(called), number_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {
    if (number_ < 0) fail(called, "cannot open");
  }
  ~Descriptor() { ::close(number_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

  void write(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t written = ::write(number_, text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(path_, "cannot write");
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void sync() const {
    // A pipe or a special file has nothing to synchronise and says so.
    if (::fsync(number_) != 0 && errno != EINVAL && errno != EROFS) fail(path_, "cannot synchronise");
  }

 private:
  fs::path path_;
  int number_;
};

void make_folder_of(const fs::path& path) {
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
}

/// Length of the file up to and with its last newline.
off_t length_of_whole_lines(const Descriptor& file, const fs::path& path) {
  off_t end = ::lseek(file.number(), 0, SEEK_END);
  if (end < 0) fail(path, "cannot seek in");
  char block[4096];
  while (end > 0) {
    const off_t begin = end > off_t{sizeof block} ? end - off_t{sizeof block} : 0;
    const ssize_t count = ::pread(file.number(), block, static_cast<std::size_t>(end - begin), begin);
    if (count < 0) fail(path, "cannot read");
    const std::size_t newline = std::string_view(block, static_cast<std::size_t>(count)).rfind('\n');
    if (newline != std::string_view::npos) return begin + static_cast<off_t>(newline) + 1;
    end = begin;
  }
  return 0;
}

}  // namespace

std::string temporary_of(const std::string& name, const std::string& process) { return name + "." + process + ".part"; }

bool holds(const fs::path& folder, const char* file) {
  std::error_code none;
  return fs::exists(folder / file, none);
}

void check_folder(const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored))
    throw InputFault(folder.string() + ": is a file; must be a directory, or a name that is free");
}

void write_file_atomically(const fs::path& path, std::string_view content) {
  make_folder_of(path);
  // In the same folder, since a rename is atomic only within one file system; with the process's number, since two
  // processes may write the same file.
  const fs::path temporary = path.parent_path() / temporary_of(path.filename().string(), std::to_string(::getpid()));
  std::optional<Descriptor> file(std::in_place, temporary, O_WRONLY | O_CREAT | O_EXCL, path);
  try {
    file->write(content);
    file->sync();
    file.reset();
    fs::rename(temporary, path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void append_line(const fs::path& path, std::string_view line) {
  if (line.find('\n') != std::string_view::npos) throw std::invalid_argument("append_line: a line holds no newline");
  make_folder_of(path);
  const Descriptor file(path, O_RDWR | O_CREAT | O_APPEND | O_NOFOLLOW, path);
  const off_t end = length_of_whole_lines(file, path);
  if (::ftruncate(file.number(), end) != 0) fail(path, "cannot truncate");
  try {
    file.write(std::string(line) + "\n");
    file.sync();
  } catch (...) {
    if (::ftruncate(file.number(), end) != 0) fail(path, "cannot truncate");
    throw;
  }
}

std::string unreadable(const fs::path& path, std::uintmax_t most) {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (fs::is_directory(status)) return "is a directory; must be a file";
  if (fs::is_fifo(status) || fs::is_socket(status)) return "is a pipe; must be a file";
  if (fs::is_character_file(status) || fs::is_block_file(status)) return "is a device; must be a file";
  if (!fs::exists(status)) return "cannot be read: there is no such file";
  if (::access(path.c_str(), R_OK) != 0) return "cannot be read: " + std::generic_category().message(errno);
  if (!fs::is_regular_file(status)) return "cannot be read";
  const auto size = fs::file_size(path, error);
  if (error) return "cannot be read";
  if (size <= most) return "";
  return "is too large, " + std::to_string(size) + " bytes; must have " + std::to_string(most) + " at most";
}

std::ifstream open_to_read(const fs::path& path) {
  if (fs::is_directory(path)) throw std::system_error(EISDIR, std::generic_category(), path.string());
  if (fs::exists(path) && !fs::is_regular_file(path))
    throw InputFault(path.string() + ": " + unreadable(path, std::numeric_limits<std::uintmax_t>::max()));
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, "cannot read");
  return file;
}

std::string read_file(const fs::path& path) {
  const std::ifstream file = open_to_read(path);
  std::ostringstream content;
  content << file.rdbuf();
  return std::move(content).str();
}

std::vector<std::string> read_lines(const fs::path& path) {
  std::vector<std::string> lines;
  if (!fs::exists(path)) return lines;
  const std::string content = read_file(path);
  std::size_t begin = 0;
  for (std::size_t end; (end = content.find('\n', begin)) != std::string::npos; begin = end + 1) {
    lines.push_back(content.substr(begin, end - begin));
  }
  return lines;
}

}  // namespace stickslip
