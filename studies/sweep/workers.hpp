/// Independent pieces of work by several processes. Processes, not threads: not every linear solver may run in two
/// threads at once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace stickslip {

/// Calls `work(i)` for i = 0 ... count - 1, each once, and `done(i, text)` with what it returned, in the caller's
/// process and in the order in which they finish. `jobs` processes take the next piece each as they become free; one
/// job works in the caller's process. What `work` changes in memory stays in its process. Throws std::runtime_error
/// where a piece throws; all processes have ended then, and they end with the caller's. Where a signal ends a process,
/// `lost(i, signal)` is called for the piece it had, and another process goes on with the rest; a piece that it was
/// about to begin is left undone without a call. pre: `work` returns no newline; the caller has one thread.
void run_in_processes(int jobs, std::size_t count, const std::function<std::string(std::size_t)>& work,
                      const std::function<void(std::size_t, const std::string&)>& done,
                      const std::function<void(std::size_t, int)>& lost);

}  // namespace stickslip
