#include "studies/io/directory_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace stickslip {
namespace {

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) : path_((directory / ".lock").string()) {
  std::filesystem::create_directories(directory);
  do {  // again where the file was taken away by its last holder between opening and locking
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "cannot open '" + path_ + "'");
    auto lock = whole_file(F_WRLCK);
    if (::fcntl(file_, F_SETLK, &lock) != 0) {
      const int error = errno;
      auto owner = whole_file(F_WRLCK);
      const bool known = ::fcntl(file_, F_GETLK, &owner) == 0 && owner.l_type != F_UNLCK;
      ::close(file_);
      if (error != EACCES && error != EAGAIN)
        throw std::system_error(error, std::generic_category(), "cannot lock '" + path_ + "'");
      throw DirectoryInUse(directory.string() + ": another stickslip writes here" +
                           (known ? " (process " + std::to_string(owner.l_pid) + ")" : std::string()) +
                           "; wait for it, or use another directory");
    }
  } while (!is_there() && ::close(file_) == 0);
  at_interrupt_.emplace([](const char* path) { ::unlink(path); }, path_.c_str());
}

/// Whether the locked file is the one at the path.
bool DirectoryLock::is_there() const {
  struct stat held {
  }, there{};
  return ::fstat(file_, &held) == 0 && ::stat(path_.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
         held.st_dev == there.st_dev;
}

void DirectoryLock::check() const {
  if (is_there()) return;
  throw InputFault(std::filesystem::path(path_).parent_path().string() +
                   ": was deleted or moved while this ran; what was not yet written is lost; run the command again");
}

DirectoryLock::~DirectoryLock() {
  at_interrupt_.reset();
  if (is_there()) ::unlink(path_.c_str());  // before the lock goes: another's file is not taken away
  ::close(file_);
}

}  // namespace stickslip
