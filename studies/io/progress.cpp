#include "studies/io/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <utility>

namespace stickslip {
namespace {

constexpr int bar_width = 20;

/// Share done, in `parts`, rounded down, so that all is told only when all is done.
long share(const ProgressState& state, long parts) {
  return state.total > 0 ? std::clamp(state.done * parts / state.total, 0L, parts) : parts;
}

std::string times(const ProgressState& state) {
  std::string text = format_duration(state.elapsed) + " elapsed";
  const double remaining = estimate_remaining(state);
  if (remaining > 0) text += ", about " + format_duration(remaining) + " to go";
  return text;
}

}  // namespace

double estimate_remaining(const ProgressState& state) {
  const long now = state.done - state.earlier;
  if (now <= 0) return -1;
  return state.elapsed / static_cast<double>(now) * static_cast<double>(std::max(0L, state.total - state.done));
}

std::string format_duration(double seconds) {
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string progress_bar(const ProgressState& state) {
  const auto full = static_cast<std::size_t>(share(state, bar_width));
  return fmt::format("[{}{}] {}/{} done, {} left, {}", std::string(full, '#'), std::string(bar_width - full, '.'),
                     state.done, state.total, state.total - state.done, times(state));
}

std::string progress_line(const ProgressState& state) {
  return fmt::format("{} %: {} of {} done, {} left, {}", share(state, 100), state.done, state.total,
                     state.total - state.done, times(state));
}

Progress::Progress(std::ostream& out, Style style, std::string label, long total, Clock clock)
    : out_(out), style_(style), label_(std::move(label)), total_(total), clock_(std::move(clock)), start_(clock_()) {
  if (style_ == Style::bar) draw();
}

Progress::~Progress() {
  if (style_ == Style::bar && drawn_) out_ << '\n' << std::flush;
}

ProgressState Progress::state() const {
  return {done_, total_, std::chrono::duration<double>(clock_() - start_).count(), earlier_};
}

void Progress::draw() {
  // Back to the start of the line, and the rest of the old text erased.
  out_ << '\r' << label_ << ' ' << progress_bar(state()) << "\x1b[K" << std::flush;
  last_drawn_ = clock_();
  drawn_ = true;
}

void Progress::advance(long pieces) {
  const std::scoped_lock lock(mutex_);
  done_ += pieces;
  if (style_ == Style::bar) {
    if (done_ >= total_ || clock_() - last_drawn_ >= std::chrono::milliseconds(100)) draw();
    return;
  }
  tell_tenths();
}

void Progress::skip(long pieces) {
  const std::scoped_lock lock(mutex_);
  done_ += pieces;
  earlier_ += pieces;
  if (style_ == Style::bar)
    draw();
  else
    tell_tenths();
}

void Progress::tell_tenths() {
  const long tenths = share(state(), 10);
  if (tenths <= tenths_told_) return;
  out_ << label_ << ": " << progress_line(state()) << '\n' << std::flush;
  tenths_told_ = tenths;
}

void Progress::note(std::string_view message) {
  const std::scoped_lock lock(mutex_);
  if (style_ == Style::bar) {
    out_ << '\r' << message << "\x1b[K\n";
    draw();
  } else {
    out_ << message << '\n' << std::flush;
  }
}

Progress::Style progress_style_of_stderr() {
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return ::isatty(STDERR_FILENO) == 1 && !dumb ? Progress::Style::bar : Progress::Style::lines;
}

}  // namespace stickslip
