#include "studies/io/other_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

extern "C" char** environ;

namespace stickslip {
namespace {

[[noreturn]] void refuse(int error, const std::string& program) {
  throw std::system_error(error, std::generic_category(), program + ": cannot be started");
}

/// The texts as a program is given them. They must outlive it.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (auto& text : texts) out.push_back(text.data());
  out.push_back(nullptr);
  return out;
}

/// The environment of this process with other values of some variables.
std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>>& variables) {
  std::vector<std::string> out;
  for (const auto& [name, value] : variables) out.push_back(name + "=" + value);
  for (char** entry = environ; *entry; ++entry) {
    const std::string text = *entry;
    bool set = false;
    for (const auto& [name, value] : variables) set = set || text.starts_with(name + "=");
    if (!set) out.push_back(text);
  }
  return out;
}

/// All that comes out of a pipe until its other end is closed.
std::string read_all(int pipe) {
  std::string out;
  std::array<char, 65536> part;
  for (ssize_t n = 0; (n = ::read(pipe, part.data(), part.size())) != 0;) {
    if (n > 0) out.append(part.data(), static_cast<std::size_t>(n));
    if (n < 0 && errno != EINTR) break;
  }
  return out;
}

}  // namespace

std::optional<std::string> output_of(std::vector<std::string> words,
                                     const std::vector<std::pair<std::string, std::string>>& variables) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) refuse(errno, words.front());
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, pipe[1], STDOUT_FILENO);
  auto environment = environment_with(variables);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, words.front().c_str(), &files, nullptr, pointers_to(words).data(),
                                   pointers_to(environment).data());
  posix_spawn_file_actions_destroy(&files);
  ::close(pipe[1]);
  const std::string out = error == 0 ? read_all(pipe[0]) : "";
  ::close(pipe[0]);
  if (error == ENOENT || error == EACCES) return std::nullopt;
  if (error != 0) refuse(error, words.front());
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? std::optional(out) : std::nullopt;
}

}  // namespace stickslip
