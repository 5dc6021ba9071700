#include "studies/io/interrupts.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <mutex>

namespace stickslip {
namespace {

struct Entry {
  std::atomic<void (*)(const char*)> act;  ///< none where the place is free
  const char* of;
  pid_t owner;
};
constexpr int places = 16;  // threads of Python may each write to a directory; beyond, a lock's file stays behind
Entry entries[places];
std::mutex changing;
int living = 0;

void on_signal(int signal) {  // only what a signal handler may call
  for (int i = places - 1; i >= 0; --i)
    if (const auto act = entries[i].act.load(); act && entries[i].owner == ::getpid()) act(entries[i].of);
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// Gives the signals whose handler is `from` the handler `to`.
void exchange_handlers(void (*from)(int), void (*to)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction now {
    }, next{};
    next.sa_handler = to;
    if (::sigaction(signal, nullptr, &now) == 0 && now.sa_handler == from) ::sigaction(signal, &next, nullptr);
  }
}

}  // namespace

AtInterrupt::AtInterrupt(void (*act)(const char*), const char* of) : place_(0) {
  const std::lock_guard one_at_a_time(changing);
  while (place_ < places && entries[place_].act.load()) ++place_;
  if (place_ == places) return;
  entries[place_].of = of;
  entries[place_].owner = ::getpid();
  entries[place_].act = act;
  if (living++ == 0) exchange_handlers(SIG_DFL, on_signal);
}

AtInterrupt::~AtInterrupt() {
  if (place_ == places) return;
  const std::lock_guard one_at_a_time(changing);
  entries[place_].act = nullptr;
  if (--living == 0) exchange_handlers(on_signal, SIG_DFL);
}

}  // namespace stickslip
