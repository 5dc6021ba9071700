/// What a linear solver says where memory ends.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>
#include <random>

#include "core/algebra/linear_solver.hpp"

namespace stickslip::memory_test {
namespace {

/// A symmetric positive definite matrix of which every row is joined with four others at random, which no ordering can
/// help: of 12 000 rows the factor has some 10 million entries.
struct Tangle {
  std::shared_ptr<Pattern> pattern = std::make_shared<Pattern>();
  std::vector<double> values;

  explicit Tangle(int n) {
    std::vector<std::vector<int>> columns(n);
    std::mt19937 generator(1);
    for (int j = 0; j < n; ++j) {
      columns[j].push_back(j);
      for (int k = 0; k < 4; ++k) {
        const int i = static_cast<int>(generator() % n);
        columns[j].push_back(i);
        columns[i].push_back(j);
      }
    }
    pattern->size = n;
    pattern->column_start.push_back(0);
    for (int j = 0; j < n; ++j) {
      auto& column = columns[j];
      std::sort(column.begin(), column.end());
      column.erase(std::unique(column.begin(), column.end()), column.end());
      for (int i : column) {
        pattern->row.push_back(i);
        values.push_back(i == j ? 100.0 : -1.0);
      }
      pattern->column_start.push_back(pattern->nonzeros());
    }
  }
};

/// Factorises with 40 MB more of address space than the process has; the factor alone takes 80. Ends the process: 0
/// where that was told by std::bad_alloc.
[[noreturn]] void factorise_in_little_memory(Backend backend) {
  const Tangle small(500), tangle(12000);
  LinearSolver<double> solver(backend);
  solver.analyse(small.pattern, Symmetry::positive_definite);
  solver.factorise(small.values.data());  // the BLAS takes its own memory now: it waits for ever where there is none
  solver.analyse(tangle.pattern, Symmetry::positive_definite);
  std::ifstream statm("/proc/self/statm");
  rlim_t pages = 0;
  statm >> pages;
  const rlim_t limit = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (40u << 20);
  const rlimit bound{limit, limit};
  setrlimit(RLIMIT_AS, &bound);
  try {
    std::_Exit(solver.factorise(tangle.values.data()) ? 1 : 2);
  } catch (const std::bad_alloc&) {
    std::_Exit(0);
  } catch (...) {
    std::_Exit(3);
  }
}

TEST(LinearSolver, TellsTheEndOfMemoryFromASingularMatrix) {
  for (Backend backend : {Backend::cholmod, Backend::mumps, Backend::eigen}) {
    if (!has_backend(backend)) continue;
    EXPECT_EXIT(factorise_in_little_memory(backend), testing::ExitedWithCode(0), "") << static_cast<int>(backend);
  }
}

}  // namespace
}  // namespace stickslip::memory_test
