/// What is still to be done where a signal from outside ends the process.
#pragma once

namespace stickslip {

/// While this lives, SIGINT, SIGTERM, SIGHUP and SIGPIPE call `act(of)` before they end the process that made it; a
/// child made by fork() they end as ever. Not where a job ignores them, nor where a program that this is part of
/// (Python) handles them. `act` may do only what a signal handler may; of several the last made is called first.
class AtInterrupt {
 public:
  AtInterrupt(void (*act)(const char*), const char* of);
  ~AtInterrupt();
  AtInterrupt(const AtInterrupt&) = delete;
  AtInterrupt& operator=(const AtInterrupt&) = delete;

 private:
  int place_;
};

}  // namespace stickslip
