/// What time was spent on.
#pragma once

#include <chrono>

namespace stickslip {

/// Seconds by what they were spent on.
struct Seconds {
  double setup = 0;           ///< model, slots and engine
  double contact_search = 0;  ///< what points face
  double contact = 0;         ///< gaps, tractions, forces and tangents of points
  double bodies = 0;          ///< forces and tangents of bodies
  double factorization = 0, backsolve = 0, total = 0;
  double assembly() const { return contact + bodies; }
};

/// Adds the seconds of its own life to a total.
class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace stickslip
