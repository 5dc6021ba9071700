/// Tables: what a scene prescribes as a function of time.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/algebra/number.hpp"

namespace stickslip {

/// Value in time: linear between points, held before the first and after the last. A plain number is one point at
/// t = 0, in force from the first step on (times are not parameters, values are).
struct Table {
  std::vector<std::pair<double, Number>> points;
  int repeat = 1;        ///< how often the points are run through, one time right after the other
  bool goes_on = false;  ///< straight on before its first and behind its last point: of two points
  double start() const { return points.front().first; }
  double period() const { return points.back().first - points.front().first; }
  /// When point i is reached for the n-th time, n = 0, 1, ...
  double time(int n, std::size_t i) const { return points[i].first + n * period(); }
};

/// Calls f(t) with the time of each point of each repeat.
template <class F>
void for_each_breakpoint(const Table& table, F&& f) {
  for (int n = 0; n < table.repeat; ++n)
    for (std::size_t i = 0; i < table.points.size(); ++i) f(table.time(n, i));
}

/// `t` less the periods of a repeated table that went by: the time that its points know. A breakpoint of any repeat is
/// met to the last bit, so that no rounding adds up over the repeats.
inline double time_in_period(const Table& table, double t) {
  if (table.repeat == 1 || t <= table.start()) return t;
  const double period = table.period(), rounding = 4e-16 * std::abs(t);
  const int passed = static_cast<int>(std::min((t - table.start() - rounding) / period, table.repeat - 1.0));
  for (std::size_t i = 0; i < table.points.size(); ++i)
    if (std::abs(t - table.time(passed, i)) <= rounding) return table.points[i].first;
  return t - passed * period;
}

/// The table at time `at`. pre: at least one point; two and equal ends where it is repeated.
template <class T>
T evaluate(const Table& table, double at, const Numbers<T>& numbers) {
  const auto& p = table.points;
  if (table.goes_on) {
    const double s = (at - p.front().first) / (p.back().first - p.front().first);
    return numbers(p.front().second) * T(1 - s) + numbers(p.back().second) * T(s);
  }
  const double t = time_in_period(table, at);
  if (t <= p.front().first) return numbers(p.front().second);
  for (std::size_t i = 1; i < p.size(); ++i)
    if (t <= p[i].first) {
      const double s = (t - p[i - 1].first) / (p[i].first - p[i - 1].first);
      return numbers(p[i - 1].second) * T(1 - s) + numbers(p[i].second) * T(s);
    }
  return numbers(p.back().second);
}

}  // namespace stickslip
