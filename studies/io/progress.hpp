/// Progress of long work for people: a bar where they watch a terminal, one line per 10 % where a log is kept.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>
#include <string_view>

namespace stickslip {

/// What is to be told at a moment.
struct ProgressState {
  long done = 0;
  long total = 0;
  double elapsed = 0;  ///< seconds
  long earlier = 0;    ///< of those done: before the work began, in none of these seconds
};

/// Seconds still to go if the rest takes as long per piece as what was done in `elapsed`; negative where nothing was.
double estimate_remaining(const ProgressState& state);

/// A time for people: "8.3 s", "2 min 05 s", "3 h 07 min".
std::string format_duration(double seconds);

/// "[######..............] 12/40 done, 28 left, 31 s elapsed, about 1 min 12 s to go": for a terminal.
std::string progress_bar(const ProgressState& state);

/// "30 %: 12 of 40 done, 28 left, 31 s elapsed, about 1 min 12 s to go": for a log.
std::string progress_line(const ProgressState& state);

/// Counts pieces of work and writes how far they are. Several threads may advance it.
class Progress {
 public:
  enum class Style { bar, lines };
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// Writes to `out`, which outlives it. `label` opens each text. pre: total >= 0.
  Progress(std::ostream& out, Style style, std::string label, long total, Clock clock = std::chrono::steady_clock::now);
  /// Ends the line of a bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `pieces` more are done. A bar is redrawn at most ten times a second, and at the end.
  void advance(long pieces = 1);

  /// `pieces` were done before, in no time that tells how long the rest takes.
  void skip(long pieces);

  /// A message on a line of its own, which does not tear the bar.
  void note(std::string_view message);

 private:
  ProgressState state() const;
  void draw();
  void tell_tenths();

  std::ostream& out_;
  const Style style_;
  const std::string label_;
  const long total_;
  const Clock clock_;
  const std::chrono::steady_clock::time_point start_;
  std::mutex mutex_;
  long done_ = 0, earlier_ = 0;
  long tenths_told_ = 0;                              ///< of a log
  std::chrono::steady_clock::time_point last_drawn_;  ///< of a bar
  bool drawn_ = false;
};

/// A bar where standard error is a terminal, lines otherwise.
Progress::Style progress_style_of_stderr();

}  // namespace stickslip
