#include "studies/io/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <ostream>
#include <stop_token>
#include <utility>

namespace stickslip {
namespace {

constexpr int bar_width = 20;
constexpr double shown_from = 5;  // seconds of a piece, before which it is as others are

/// Share done, in `parts`, rounded down, so that all is shown only when all is done.
long share(const ProgressState& state, long parts) {
  return state.total > 0 ? std::clamp(state.done * parts / state.total, 0L, parts) : parts;
}

std::string times(const ProgressState& state) {
  std::string text = format_duration(state.elapsed) + " elapsed";
  const double remaining = estimate_remaining(state);
  if (remaining > 0) text += ", about " + format_duration(remaining) + " to go";
  if (state.present >= shown_from) text += ", " + format_duration(state.present) + " in the present one";
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

Progress::Progress(std::ostream& out, Style style, std::string label, long total, Clock clock,
                   std::chrono::steady_clock::duration quiet)
    : out_(out),
      style_(style),
      label_(std::move(label)),
      total_(total),
      clock_(std::move(clock)),
      start_(clock_()),
      quiet_(quiet),
      piece_start_(start_) {
  if (style_ == Style::bar && !is_quiet()) draw();
}

Progress::~Progress() {
  if (style_ == Style::bar && drawn_) out_ << '\n' << std::flush;
}

ProgressState Progress::state() const {
  const auto now = clock_();
  const auto seconds_since = [&](auto time) { return std::chrono::duration<double>(now - time).count(); };
  return {done_, total_, seconds_since(start_), earlier_, done_ < total_ ? seconds_since(piece_start_) : 0};
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
  piece_start_ = clock_();
  next_line_ = first_line;
  if (is_quiet()) return;
  if (style_ == Style::bar) {
    if (done_ >= total_ || clock_() - last_drawn_ >= std::chrono::milliseconds(100)) draw();
    return;
  }
  write_tenths();
}

void Progress::tick() {
  const std::scoped_lock lock(mutex_);
  const ProgressState now = state();
  if (is_quiet() || done_ >= total_) return;
  if (style_ == Style::bar) return draw();
  if (now.present < next_line_) return;
  next_line_ *= 2;
  out_ << label_ << ": " << progress_line(now) << '\n' << std::flush;
}

void Progress::skip(long pieces) {
  const std::scoped_lock lock(mutex_);
  done_ += pieces;
  earlier_ += pieces;
  if (style_ == Style::bar)
    draw();
  else
    write_tenths();
}

void Progress::write_tenths() {
  const long tenths = share(state(), 10);
  if (tenths <= tenths_written_) return;
  out_ << label_ << ": " << progress_line(state()) << '\n' << std::flush;
  tenths_written_ = tenths;
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

Ticker::Ticker(Progress& progress)
    : thread_([&progress](const std::stop_token& stop) {
        constexpr std::chrono::milliseconds pause(500);
        std::mutex mutex;
        std::condition_variable_any wake;
        std::unique_lock lock(mutex);
        while (!wake.wait_for(lock, stop, pause, [&] { return stop.stop_requested(); })) progress.tick();
      }) {}

Progress::Style progress_style_of_stderr() {
  const char* terminal = std::getenv("TERM");
  const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
  return ::isatty(STDERR_FILENO) == 1 && !dumb ? Progress::Style::bar : Progress::Style::lines;
}

}  // namespace stickslip
