/// Progress of long work for people: a bar where they watch a terminal, one line per 10 % where a log is kept.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace stickslip {

/// How far work is at a moment.
struct ProgressState {
  long done = 0;
  long total = 0;
  double elapsed = 0;  ///< seconds
  long earlier = 0;    ///< of those done: before the work began, in none of these seconds
  double present = 0;  ///< seconds of the piece under way, shown from 5 s on
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

  /// Writes to `out`, which outlives it, but nothing in the first `quiet`. `label` opens each text. pre: total >= 0.
  Progress(std::ostream& out, Style style, std::string label, long total, Clock clock = std::chrono::steady_clock::now,
           std::chrono::steady_clock::duration quiet = {});
  /// Ends the line of a bar.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `pieces` more are done. A bar is redrawn at most ten times a second, and at the end.
  void advance(long pieces = 1);

  /// To be called now and then while a piece is under way. A bar is redrawn; a log gets a line once the piece has taken
  /// 10, 20, 40, ... seconds.
  void tick();

  /// `pieces` were done before, in no time that counts for the estimate.
  void skip(long pieces);

  /// A message on a line of its own, which does not tear the bar.
  void note(std::string_view message);

 private:
  static constexpr double first_line = 10;  ///< seconds
  ProgressState state() const;
  bool is_quiet() const { return clock_() - start_ < quiet_; }
  void draw();
  void write_tenths();

  std::ostream& out_;
  const Style style_;
  const std::string label_;
  const long total_;
  const Clock clock_;
  const std::chrono::steady_clock::time_point start_;
  const std::chrono::steady_clock::duration quiet_;
  std::chrono::steady_clock::time_point piece_start_;
  double next_line_ = first_line;  ///< seconds of a piece at which a log gets its next line
  std::mutex mutex_;
  long done_ = 0, earlier_ = 0;
  long tenths_written_ = 0;                           ///< of a log
  std::chrono::steady_clock::time_point last_drawn_;  ///< of a bar
  bool drawn_ = false;
};

/// Calls tick() of a progress, which outlives it, twice a second from a thread of its own.
class Ticker {
 public:
  explicit Ticker(Progress& progress);

 private:
  std::jthread thread_;
};

/// A bar where standard error is a terminal, lines otherwise.
Progress::Style progress_style_of_stderr();

}  // namespace stickslip
