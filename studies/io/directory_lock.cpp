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

DirectoryLock::DirectoryLock(const std::filesystem::path& directory) {
  std::filesystem::create_directories(directory);
  const auto& path = path_ = directory / ".lock";
  file_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), "cannot open '" + path.string() + "'");
  auto lock = whole_file(F_WRLCK);
  if (::fcntl(file_, F_SETLK, &lock) == 0) return;
  const int error = errno;
  auto owner = whole_file(F_WRLCK);
  const bool known = ::fcntl(file_, F_GETLK, &owner) == 0 && owner.l_type != F_UNLCK;
  ::close(file_);
  if (error != EACCES && error != EAGAIN)
    throw std::system_error(error, std::generic_category(), "cannot lock '" + path.string() + "'");
  throw DirectoryInUse(directory.string() + ": another stickslip writes here" +
                       (known ? " (process " + std::to_string(owner.l_pid) + ")" : std::string()) +
                       "; wait for it, or use another directory");
}

void DirectoryLock::check() const {
  struct stat held {
  }, there{};
  if (::fstat(file_, &held) == 0 && ::stat(path_.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
      held.st_dev == there.st_dev)
    return;
  throw InputFault(path_.parent_path().string() + ": was deleted or moved while this ran; what was not yet written " +
                   "is lost; run the command again");
}

DirectoryLock::~DirectoryLock() { ::close(file_); }

}  // namespace stickslip
