#include "core/algebra/reverse.hpp"

#include <algorithm>

namespace stickslip {

std::vector<int> Tape::fold(int start, const std::vector<int>& results) {
  std::vector<int> arguments;
  for (int i = start; i < size(); ++i)
    for (int argument : {entries_[i].a, entries_[i].b})
      if (argument >= 0 && argument < start) arguments.push_back(argument);
  std::sort(arguments.begin(), arguments.end());
  arguments.erase(std::unique(arguments.begin(), arguments.end()), arguments.end());
  const auto place = [&](int argument) {
    return std::lower_bound(arguments.begin(), arguments.end(), argument) - arguments.begin();
  };
  std::vector<std::vector<double>> partials;  // by result and argument
  for (int result : results) {
    auto& partial = partials.emplace_back(arguments.size(), 0.0);
    if (result >= 0 && result < start) continue;
    std::vector<double> by(std::max(result + 1 - start, 0), 0.0);
    if (result >= start) by.back() = 1;
    for (int i = result; i >= start; --i) {
      const Entry& entry = entries_[i];
      const double derivative = by[i - start];
      const auto add = [&](int argument, double share) {
        if (argument >= start)
          by[argument - start] += share;
        else if (argument >= 0)
          partial[place(argument)] += share;
      };
      if (derivative == 0) continue;
      add(entry.a, derivative * entry.by_a);
      add(entry.b, derivative * entry.by_b);
    }
  }
  rewind(start);
  std::vector<int> folded;
  for (std::size_t k = 0; k < results.size(); ++k) {
    int sum = results[k] < start ? results[k] : -1;
    for (std::size_t m = 0; m < arguments.size(); ++m)
      if (partials[k][m] != 0) sum = record(arguments[m], partials[k][m], sum, 1);
    folded.push_back(sum);
  }
  return folded;
}

}  // namespace stickslip
