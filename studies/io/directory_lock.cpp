#include "studies/io/directory_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

namespace stickslip {
namespace {

/// Content of the files that this program makes.
constexpr std::string_view lock_mark = "stickslip\n";

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

[[noreturn]] void cannot(const char* action, const std::string& path, int error = errno) {
  throw std::system_error(error, std::generic_category(), std::string("cannot ") + action + " '" + path + "'");
}

/// Files that this process holds, by device and number, and which process that is: a record lock does not keep threads
/// apart, and is lost where the process closes the file anywhere else.
std::map<std::pair<dev_t, ino_t>, pid_t> held;
std::mutex of_held;

std::pair<dev_t, ino_t> identity(const struct stat& file) { return {file.st_dev, file.st_ino}; }

bool is_held_here(const std::string& path) {
  struct stat there {};
  if (::stat(path.c_str(), &there) != 0) return false;
  const auto found = held.find(identity(there));
  return found != held.end() && found->second == ::getpid();
}

/// A file made with its lock_mark; -1 where there is one.
int make_file(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file < 0 && errno != EEXIST) cannot("open", path);
  if (file < 0 || ::write(file, lock_mark.data(), lock_mark.size()) == static_cast<ssize_t>(lock_mark.size()))
    return file;
  const int error = errno;
  ::unlink(path.c_str());
  ::close(file);
  cannot("write", path, error);
}

/// The file that is there, or a new one.
int open_file(const std::string& path) {
  for (;;) {
    if (const int made = make_file(path); made >= 0) return made;
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0 && errno == ENOENT) continue;  // its holder took it away
    struct stat there {};
    const bool is_other =
        file < 0 ? errno == ELOOP || errno == EISDIR : ::fstat(file, &there) == 0 && !S_ISREG(there.st_mode);
    if (file < 0 && !is_other) cannot("open", path);
    if (!is_other) return file;
    if (file >= 0) ::close(file);
    throw InputFault(path + ": is a link or no file; the lock goes there. Move it, or name another directory");
  }
}

}  // namespace

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) : path_((directory / ".lock").string()) {
  std::filesystem::create_directories(directory);
  const auto in_use = [&](const std::string& by) {
    return DirectoryInUse(directory.string() + ": another stickslip writes here" + by +
                          "; wait for it, or use another directory");
  };
  const std::lock_guard one_at_a_time(of_held);
  if (is_held_here(path_)) throw in_use(" (in this process)");
  do {  // again where the file was taken away by its last holder between opening and locking
    file_ = open_file(path_);
    auto lock = whole_file(F_WRLCK);
    if (::fcntl(file_, F_SETLK, &lock) != 0) {
      const int error = errno;
      auto owner = whole_file(F_WRLCK);
      const bool known = ::fcntl(file_, F_GETLK, &owner) == 0 && owner.l_type != F_UNLCK;
      ::close(file_);
      if (error != EACCES && error != EAGAIN) cannot("lock", path_, error);
      throw in_use(known ? " (process " + std::to_string(owner.l_pid) + ")" : std::string());
    }
  } while (!is_there() && ::close(file_) == 0);
  struct stat own {};
  if (::fstat(file_, &own) == 0) held[identity(own)] = ::getpid();
  if (is_ours()) at_interrupt_.emplace([](const char* path) { ::unlink(path); }, path_.c_str());
}

/// Whether the locked file is the one at the path.
bool DirectoryLock::is_there() const {
  struct stat own {
  }, there{};
  return ::fstat(file_, &own) == 0 && ::stat(path_.c_str(), &there) == 0 && identity(own) == identity(there);
}

/// Whether this program made the file.
bool DirectoryLock::is_ours() const {
  char content[lock_mark.size() + 1];
  const ssize_t size = ::pread(file_, content, sizeof content, 0);
  return size >= 0 && std::string_view(content, static_cast<std::size_t>(size)) == lock_mark;
}

void DirectoryLock::check() const {
  if (is_there()) return;
  throw InputFault(std::filesystem::path(path_).parent_path().string() +
                   ": was deleted or moved while this ran; what was not yet written is lost; run the command again");
}

DirectoryLock::~DirectoryLock() {
  const std::lock_guard one_at_a_time(of_held);
  at_interrupt_.reset();
  struct stat own {};
  if (::fstat(file_, &own) == 0) held.erase(identity(own));
  if (is_there() && is_ours()) ::unlink(path_.c_str());  // before the lock goes: another's file is not taken away
  ::close(file_);
}

}  // namespace stickslip
