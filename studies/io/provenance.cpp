#include "studies/io/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/algebra/linear_solver.hpp"
#include "studies/version.hpp"

namespace stickslip {
namespace {

/// The processor as Linux names it; "unknown" elsewhere.
std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "unknown";
}

/// {"CHOLMOD": "3.0.14", ...}
nlohmann::json libraries() {
  nlohmann::json out = nlohmann::json::object();
  for (const std::string& library : linear_solver_libraries()) {
    const std::size_t space = library.find(' ');
    out[library.substr(0, space)] = space == std::string::npos ? "" : library.substr(space + 1);
  }
  out["fmt"] = fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100);
  out["nlohmann_json"] =
      fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
  return out;
}

}  // namespace

nlohmann::json provenance(int threads) {
  double load = 0;
  const bool has_load = ::getloadavg(&load, 1) == 1;
  return {{"version", version::number},
          {"git", version::git},
          {"compiler", version::compiler},
          {"flags", version::flags},
          {"build_type", version::build_type},
          {"cpu", cpu_model()},
          {"cores", std::thread::hardware_concurrency()},
          {"blas", blas_name()},
          {"libraries", libraries()},
          {"threads", threads},
          {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
          {"load_average", has_load ? nlohmann::json(load) : nlohmann::json(nullptr)}};
}

std::string version_text() {
  return fmt::format(
      "stickslip {} ({})\n"
      "built by {}, {}: {}\n"
      "linear solvers: {}; BLAS: {}\n"
      "licence of this binary: {}\n",
      version::number, version::git, version::compiler, version::build_type, version::flags,
      fmt::join(linear_solver_libraries(), ", "), blas_name(), version::licence);
}

}  // namespace stickslip
