#include "studies/sweep/timing.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace stickslip {
namespace {

using nlohmann::json;

template <class Pick>
json combined(const std::vector<json>& runs, Pick pick) {
  json out = json::object();
  for (const auto& [name, unused] : runs.front().items()) {
    std::vector<double> values;
    for (const auto& run : runs) values.push_back(run.at(name));
    std::sort(values.begin(), values.end());
    out[name] = pick(values);
  }
  return out;
}

}  // namespace

std::vector<TimedRun> timing_plan(const std::vector<std::string>& keys, int repeat) {
  std::vector<TimedRun> plan;
  for (std::size_t begin = 0, end; begin < keys.size(); begin = end) {
    for (end = begin; end < keys.size() && keys[end] == keys[begin];) ++end;
    for (int round = 1; round <= repeat; ++round)
      for (std::size_t i = begin; i < end; ++i) plan.push_back({round % 2 ? i : begin + end - 1 - i, round});
  }
  return plan;
}

json least_seconds(const std::vector<json>& runs) {
  return combined(runs, [](const std::vector<double>& sorted) { return sorted.front(); });
}

json median_seconds(const std::vector<json>& runs) {
  return combined(runs, [](const std::vector<double>& sorted) {
    const std::size_t n = sorted.size();
    return n % 2 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
  });
}

}  // namespace stickslip
