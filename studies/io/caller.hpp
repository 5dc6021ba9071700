/// How a message names what its reader can ask for: options of the command line, or arguments of Python.
#pragma once

#include <string>

namespace stickslip {

struct Caller {
  std::string set, method;  ///< before "POINTER=VALUE"; before the name of a method
  std::string shard, jobs;  ///< before their values
  std::string resume, restart, directory;
};

inline const Caller command_line{"--set ", "-m ", "--shard ", "--jobs ", "--resume", "--restart", "-o DIR"};
inline const Caller python_arguments{"set ", "method ", "shard ", "jobs ", "resume=True", "restart=True", "folder=DIR"};

}  // namespace stickslip
