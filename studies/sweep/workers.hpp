/// Independent pieces of work by several processes. Processes, not threads: not every linear solver may run in two
/// threads at once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace stickslip {

/// How a process ended before its piece of work was done.
struct Loss {
  int signal = 0;             ///< that ended it; 0: it ended itself
  std::string words;          ///< "its process was ended by signal 11 (Segmentation fault)"
  bool from_outside = false;  ///< by the user, a scheduler, or the kernel where memory runs out; else by its own fault
};

/// Calls `work(i)` for i = 0 ... count - 1, each once, and `done(i, text)` with what it returned, in the caller's
/// process and in the order in which they finish. `jobs` processes take the next piece each as they become free; one
/// job is a process of its own too, so that nothing that `work` does can end the caller's. What `work` changes in
/// memory stays in its process. Throws std::runtime_error where a piece throws; all processes have ended then, and they
/// end with the caller's. Where a process ends before its piece is done, `lost` is called for that, and another process
/// goes on with the rest, a piece that it was about to begin among them. pre: `work` returns no newline; the caller's
/// other threads hold nothing that `work` needs.
void run_in_processes(int jobs, std::size_t count, const std::function<std::string(std::size_t)>& work,
                      const std::function<void(std::size_t, const std::string&)>& done,
                      const std::function<void(std::size_t, const Loss&)>& lost);

}  // namespace stickslip
