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
#include <cstring>
#include <numeric>
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

/// Whether such a signal comes from outside.
bool from_outside(int signal) {
  return signal == SIGKILL || signal == SIGTERM || signal == SIGINT || signal == SIGHUP || signal == SIGXCPU;
}

/// Of the status of a process that ended; none where it did what there was to do.
std::optional<Loss> loss_of(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return Loss{signal, "its process was ended by signal " + std::to_string(signal) + " (" + ::strsignal(signal) + ")",
                from_outside(signal)};
  }
  if (WEXITSTATUS(status) == 0) return std::nullopt;
  return Loss{0, "its process ended itself with exit code " + std::to_string(WEXITSTATUS(status)), false};
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

  /// Forgets a worker that closed its pipe and returns what was amiss; none where it had nothing left to do.
  std::optional<Loss> dismiss(Worker& worker) {
    ::close(worker.input);
    worker.input = -1;
    int status = 0;
    ::waitpid(worker.process, &status, 0);
    worker.process = 0;
    return loss_of(status);
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

/// Has the pieces done whose numbers are given, and returns those that nobody began: of a process that ended between
/// two of them.
std::vector<std::size_t> work_off(int jobs, std::vector<std::size_t> pieces,
                                  const std::function<std::string(std::size_t)>& work,
                                  const std::function<void(std::size_t, const std::string&)>& done,
                                  const std::function<void(std::size_t, const Loss&)>& lost) {
  const std::vector<std::size_t> given = pieces;
  const auto work_on = [&](std::size_t k) { return work(given[k]); };
  const auto settle = [&](std::size_t k) { std::erase(pieces, given[k]); };
  const auto take = [&](std::size_t k, const std::string& text) {
    settle(k);
    done(given[k], text);
  };
  SharedCounter counter;
  Pool pool;
  for (int j = 0; j < jobs && static_cast<std::size_t>(j) < given.size(); ++j) pool.add(counter, given.size(), work_on);
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
      deliver(worker, take);
      if (size > 0) continue;
      --open;
      const auto loss = pool.dismiss(worker);
      const auto piece = std::exchange(worker.piece, std::nullopt);
      if (!loss || !piece) continue;
      settle(*piece);
      lost(given[*piece], *loss);
      pool.add(counter, given.size(), work_on);
      ++open;
    }
  }
  return pieces;
}

}  // namespace

void run_in_processes(int jobs, std::size_t count, const std::function<std::string(std::size_t)>& work,
                      const std::function<void(std::size_t, const std::string&)>& done,
                      const std::function<void(std::size_t, const Loss&)>& lost) {
  std::fflush(nullptr);  // what is buffered would be written by each child too
  std::vector<std::size_t> pieces(count);
  std::iota(pieces.begin(), pieces.end(), 0);
  while (!pieces.empty()) {
    auto left = work_off(jobs, pieces, work, done, lost);
    if (left.size() == pieces.size()) throw std::runtime_error("the workers end before they begin");
    pieces = std::move(left);
  }
}

}  // namespace stickslip
