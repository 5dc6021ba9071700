/// One process at a time in a directory of results.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "studies/io/input_fault.hpp"
#include "studies/io/interrupts.hpp"

namespace stickslip {

/// Another process holds the directory; what() names it.
struct DirectoryInUse : InputFault {
  using InputFault::InputFault;
};

/// Holds DIR/.lock until the end of the scope or of the process, however it ends: the kernel drops the lock of a
/// process that is killed. The file is made if it is missing and taken away at the end, an interrupt's included; after
/// SIGKILL it stays, and holds nothing. A file of this name that another program made is locked too, and stays. A child
/// made by fork() does not hold the lock, nor does another thread. POSIX record lock, so it works over NFS too. Throws
/// DirectoryInUse, InputFault if the name is of no file, or std::system_error if the disk refuses.
class DirectoryLock {
 public:
  explicit DirectoryLock(const std::filesystem::path& directory);
  ~DirectoryLock();
  /// Throws InputFault where the directory was deleted or moved since: what is written would be alone in a new one.
  void check() const;
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  bool is_there() const;
  bool is_ours() const;
  std::string path_;  ///< of the file that is locked
  int file_;
  std::optional<AtInterrupt> at_interrupt_;
};

}  // namespace stickslip
