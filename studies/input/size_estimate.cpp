#include "studies/input/size_estimate.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace stickslip {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double from_file(const char* path) {
  std::ifstream file(path);
  double bytes = 0;
  return file >> bytes && bytes > 0 ? bytes : infinite;
}

double from_limit(decltype(RLIMIT_AS) resource) {
  rlimit limit{};
  return ::getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? static_cast<double>(limit.rlim_cur)
                                                                               : infinite;
}

std::string in_words(double bytes) {
  for (const auto& [unit, size] : {std::pair{"TB", 1e12}, {"GB", 1e9}, {"MB", 1e6}, {"kB", 1e3}})
    if (bytes >= size) return fmt::format("{:.{}f} {}", bytes / size, bytes < 10 * size ? 1 : 0, unit);
  return fmt::format("{:.0f} B", bytes);
}

}  // namespace

double estimated_nodes(const MeshDescription& mesh, const std::string& element) {
  // nodes a cell: its corner and, where the sides are curved, their middles; T6 and T10 have those of diagonals too
  const double each = element == "Q8"                        ? 3
                      : element == "T6" || element == "H20"  ? 4
                      : element == "T10" || element == "H27" ? 8
                                                             : 1;
  return std::visit(
      [&]<class M>(const M& kind) -> double {
        if constexpr (std::is_same_v<M, ImportedMesh>)
          return kind.mesh.node_count;
        else
          return each * kind.cell_count();
      },
      mesh);
}

namespace {

/// Of boxes of Q4: 2.7 kB a displacement at 80 000 of them, of which the factor's entries are 12 bytes each; these grow
/// by 8 a displacement with each doubling (docs/decisions.md, "Libraries of linear algebra").
double bytes_of_plane_bodies(double n) {
  constexpr double measured_at = 20'600, least_entries = 63, entries_a_doubling = 8, bytes_an_entry = 12;
  const double doublings = std::log2(std::max(n / measured_at, 1.0));
  return n * (1800 + bytes_an_entry * (least_entries + entries_a_doubling * doublings));
}

/// Of boxes and half balls of H8, 3000 to 100 000 displacements (docs/decisions.md, "Memory in space"). A factor has
/// 800 entries a displacement at 25 600 of them, and grows as their power 1.47.
double bytes_of_solid_bodies(const ProblemSize& size) {
  constexpr double measured_at = 25'600, entries = 800, growth = 0.47;
  const double factors = size.reduced != Reduced::nothing || !size.unsymmetric ? 1 : size.slides ? 4 : 2;
  return size.displacements * (2800 + factors * 8 * entries * std::pow(size.displacements / measured_at, growth));
}

}  // namespace

double estimated_bytes(const ProblemSize& size) {
  const double n = size.displacements;
  double bytes = size.in_space ? bytes_of_solid_bodies(size) : bytes_of_plane_bodies(n);
  // Dense matrices over the contact dofs: measured 14 of them at 1600 and at 2000 dofs; of tangents 6 to 8.
  const double matrices = size.reduced == Reduced::bodies ? 14 : size.reduced == Reduced::tangents ? 7 : 0;
  bytes += matrices * 8 * size.contact_dofs * size.contact_dofs;
  // what a step leaves: displacements, contact points, iterations, its part of the result (11 kB of a single point)
  return bytes + (size.steps - size.thin_steps) * 8 * n + size.steps * (150 * size.contact_points + 11'000);
}

double memory_limit() {
  const double pages = static_cast<double>(::sysconf(_SC_PHYS_PAGES));
  const double machine = pages > 0 ? pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) : infinite;
  return std::min({machine, from_limit(RLIMIT_AS), from_limit(RLIMIT_DATA), from_file("/sys/fs/cgroup/memory.max"),
                   from_file("/sys/fs/cgroup/memory/memory.limit_in_bytes")});
}

std::string about(double bytes) { return "some " + in_words(bytes) + " of memory"; }

std::string too_much(double bytes, double limit) {
  return about(bytes) + ", and there are " + in_words(limit) + " for this process";
}

}  // namespace stickslip
