/// One process at a time in a directory of results.
#pragma once

#include <filesystem>

#include "studies/io/input_fault.hpp"

namespace stickslip {

/// Another process holds the directory; what() names it.
struct DirectoryInUse : InputFault {
  using InputFault::InputFault;
};

/// Holds DIR/.lock, which is made where it is missing, until the end of the scope or of the process, however it ends:
/// the kernel drops the lock of a process that is killed. A child made by fork() does not hold it. POSIX record lock,
/// so it works over NFS too. Throws DirectoryInUse, or std::system_error where the disk refuses.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  /// Throws InputFault where the directory was deleted or moved since: what is written would be alone in a new one.
  void check() const;
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  std::filesystem::path path_;  ///< of the file that is locked
  int file_;
};

}  // namespace stickslip
