#include "studies/io/directory_lock.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/studies/temporary_folder.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;

class DirectoryLocks : public InOwnFolder {
 protected:
  /// The signal that ended a process in which this was done; 0 where none did.
  template <class F>
  static int signal_that_ends(F&& work) {
    const pid_t child = ::fork();
    if (child == 0) {
      work();
      ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  }

  const fs::path directory_ = folder_ / "results", file_ = directory_ / ".lock";
};

TEST_F(DirectoryLocks, LeaveNoFileBehind) {
  {
    const DirectoryLock lock(directory_);
    EXPECT_TRUE(fs::exists(file_));
  }
  EXPECT_FALSE(fs::exists(file_));
  EXPECT_TRUE(fs::exists(directory_));
}

TEST_F(DirectoryLocks, LeaveNoFileBehindWhereASignalEndsTheProcess) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int end = signal_that_ends([&] {
      ::signal(signal, SIG_DFL);
      const DirectoryLock lock(directory_);
      if (fs::exists(file_)) ::raise(signal);
    });
    EXPECT_EQ(end, signal);
    EXPECT_FALSE(fs::exists(file_)) << signal;
  }
}

TEST_F(DirectoryLocks, StayWithTheirProcessWhereASignalEndsItsChild) {
  const DirectoryLock lock(directory_);
  EXPECT_EQ(signal_that_ends([] { ::raise(SIGTERM); }), SIGTERM);
  EXPECT_NO_THROW(lock.check());
}

TEST_F(DirectoryLocks, AreFreeAfterAKilledProcessAndTakeItsFileAway) {
  const int end = signal_that_ends([&] {
    const DirectoryLock lock(directory_);
    ::raise(SIGKILL);
  });
  EXPECT_EQ(end, SIGKILL);
  EXPECT_TRUE(fs::exists(file_));
  { EXPECT_NO_THROW(DirectoryLock{directory_}); }
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(DirectoryLocks, GoOnWhereTheJobIgnoresTheSignal) {
  const int end = signal_that_ends([&] {
    ::signal(SIGHUP, SIG_IGN);
    const DirectoryLock lock(directory_);
    ::raise(SIGHUP);
    lock.check();
  });
  EXPECT_EQ(end, 0);
  EXPECT_FALSE(fs::exists(file_));
}

TEST_F(DirectoryLocks, GiveTheSignalsBack) {
  struct sigaction before {
  }, after{};
  ASSERT_EQ(::sigaction(SIGTERM, nullptr, &before), 0);
  { const DirectoryLock lock(directory_); }
  ASSERT_EQ(::sigaction(SIGTERM, nullptr, &after), 0);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

TEST_F(DirectoryLocks, LeaveTheFileOfAnotherDirectoryOfTheSameName) {
  {
    const DirectoryLock lock(directory_);
    fs::remove_all(directory_);
    fs::create_directories(directory_);
    const int end = signal_that_ends([&] {  // another process locks it, and is killed
      const DirectoryLock other(directory_);
      ::raise(SIGKILL);
    });
    EXPECT_EQ(end, SIGKILL);
  }
  EXPECT_TRUE(fs::exists(file_));
}

}  // namespace
}  // namespace stickslip
