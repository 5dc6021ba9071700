#include "studies/sweep/workers.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

namespace stickslip {
namespace {

[[noreturn]] void fail(const char* action) {
  throw std::system_error(errno, std::generic_category(), std::string("cannot ") + action);
}

/// A number that parent and children share.
class SharedCounter {
 public:
  SharedCounter() {
    void* page =
        ::mmap(nullptr, sizeof(std::atomic<std::size_t>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (page == MAP_FAILED) fail("share memory with the workers");
    value_ = new (page) std::atomic<std::size_t>(0);
    static_assert(std::atomic<std::size_t>::is_always_lock_free);
  }
  ~SharedCounter() { ::munmap(value_, sizeof(*value_)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;
  std::size_t next() { return value_->fetch_add(1); }

 private:
  std::atomic<std::size_t>* value_;
};

void write_all(int file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(file, text.data() + at, text.size() - at);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) ::_exit(1);  // the parent is gone
    at += static_cast<std::size_t>(written);
  }
}

/// A child's life. Two lines a piece: "> INDEX" as it begins, then "INDEX TEXT", or "! MESSAGE" where the work threw.
[[noreturn]] void serve(int out, SharedCounter& counter, std::size_t count,
                        const std::function<std::string(std::size_t)>& work) {
  try {
    for (std::size_t i = counter.next(); i < count; i = counter.next()) {
      write_all(out, "> " + std::to_string(i) + "\n");
      write_all(out, std::to_string(i) + " " + work(i) + "\n");
    }
  } catch (const std::exception& error) {
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    write_all(out, "! " + message + "\n");
    ::_exit(1);
  }
  ::_exit(0);
}

/// The children; none outlives this.
class Pool {
 public:
  struct Worker {
    pid_t process;
    int input;
    std::string unread;
    std::optional<std::size_t> piece;  ///< that it works on
  };

  ~Pool() {
    for (const auto& worker : workers) {
      if (worker.process > 0) {
        ::kill(worker.process, SIGKILL);
        ::waitpid(worker.process, nullptr, 0);
      }
      if (worker.input >= 0) ::close(worker.input);
    }
  }

  void add(SharedCounter& counter, std::size_t count, const std::function<std::string(std::size_t)>& work) {
    int ends[2];
    if (::pipe(ends) != 0) fail("make a pipe to a worker");
    const pid_t parent = ::getpid(), process = ::fork();
    if (process < 0) fail("start a worker");
    if (process == 0) {
#ifdef __linux__
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // a killed study leaves no process behind
      if (::getppid() != parent) ::_exit(1);
#endif
      ::close(ends[0]);
      for (const auto& other : workers) ::close(other.input);
      serve(ends[1], counter, count, work);
    }
    ::close(ends[1]);
    workers.push_back({process, ends[0], {}, {}});
  }

  /// Forgets a worker that closed its pipe and returns the signal that ended it, 0 for none.
  int dismiss(Worker& worker) {
    ::close(worker.input);
    worker.input = -1;
    int status = 0;
    ::waitpid(worker.process, &status, 0);
    worker.process = 0;
    if (WIFSIGNALED(status)) return WTERMSIG(status);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("a worker ended without a word");
    return 0;
  }

  std::vector<Worker> workers;
};

/// Hands the whole lines that have arrived on.
void deliver(Pool::Worker& worker, const std::function<void(std::size_t, const std::string&)>& done) {
  std::size_t begin = 0;
  for (std::size_t end; (end = worker.unread.find('\n', begin)) != std::string::npos; begin = end + 1) {
    const std::string line = worker.unread.substr(begin, end - begin);
    if (line.starts_with("! ")) throw std::runtime_error(line.substr(2));
    const auto space = line.find(' ');
    if (line.starts_with("> ")) {
      worker.piece = std::stoul(line.substr(2));
    } else {
      worker.piece.reset();
      done(std::stoul(line.substr(0, space)), line.substr(space + 1));
    }
  }
  worker.unread.erase(0, begin);
}

}  // namespace

void run_in_processes(int jobs, std::size_t count, const std::function<std::string(std::size_t)>& work,
                      const std::function<void(std::size_t, const std::string&)>& done,
                      const std::function<void(std::size_t, int)>& lost) {
  if (jobs <= 1 || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) done(i, work(i));
    return;
  }
  std::fflush(nullptr);  // what is buffered would be written by each child too
  SharedCounter counter;
  Pool pool;
  for (int j = 0; j < jobs && static_cast<std::size_t>(j) < count; ++j) pool.add(counter, count, work);
  std::size_t open = pool.workers.size();
  while (open > 0) {
    std::vector<pollfd> ready;
    for (const auto& worker : pool.workers)
      ready.push_back({worker.input, POLLIN, 0});  // a negative one is passed over
    if (::poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR) fail("wait for the workers");
    for (std::size_t w = 0; w < ready.size(); ++w) {
      if (ready[w].fd < 0 || ready[w].revents == 0) continue;
      auto& worker = pool.workers[w];
      char block[65536];
      const ssize_t size = ::read(worker.input, block, sizeof block);
      if (size < 0 && errno == EINTR) continue;
      if (size < 0) fail("read from a worker");
      worker.unread.append(block, static_cast<std::size_t>(size));
      deliver(worker, done);
      if (size > 0) continue;
      --open;
      const int signal = pool.dismiss(worker);
      const auto piece = std::exchange(worker.piece, std::nullopt);
      if (signal == 0 || !piece) continue;
      lost(*piece, signal);
      pool.add(counter, count, work);
      ++open;
    }
  }
}

}  // namespace stickslip
