/// Analysis, factorisation and solves of each backend on the matrices of 2D frictional contact: two stacked elastic
/// blocks of unit Q4 cells, each slave node of the upper one between two nodes of the lower one.
///   spd       penalty, frictionless: symmetric positive definite
///   stuck     augmented Lagrangian, every node sticks: symmetric saddle point, zero diagonal in the multiplier rows
///   sliding   augmented Lagrangian, half the nodes slip, a third stick, the rest are open: unsymmetric saddle point
/// The pattern holds every coupling of every state. CPU time, one BLAS thread. The argument is the cells along a side.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <vector>

#include "core/algebra/linear_solver.hpp"

namespace stickslip::linear_solver_bench {
namespace {

enum class Kind { spd, stuck, sliding };

struct System {
  std::shared_ptr<const Pattern> pattern;
  std::vector<double> values;
  Symmetry symmetry;
};

/// Stiffness of the unit Q4 in plane strain, E = 1, nu = 0.3, 2 x 2 Gauss points; nodes counter-clockwise.
Eigen::Matrix<double, 8, 8> unit_cell() {
  const double nu = 0.3, factor = 1 / ((1 + nu) * (1 - 2 * nu));
  Eigen::Matrix3d elasticity;
  elasticity << 1 - nu, nu, 0, nu, 1 - nu, 0, 0, 0, (1 - 2 * nu) / 2;
  elasticity *= factor;
  const double corner[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, gauss = 1 / std::sqrt(3.0);
  Eigen::Matrix<double, 8, 8> k = Eigen::Matrix<double, 8, 8>::Zero();
  for (const auto& point : corner) {
    const double x = gauss * point[0], y = gauss * point[1];
    Eigen::Matrix<double, 3, 8> b = Eigen::Matrix<double, 3, 8>::Zero();
    for (int a = 0; a < 4; ++a) {
      const double dx = corner[a][0] * (1 + corner[a][1] * y) / 2, dy = corner[a][1] * (1 + corner[a][0] * x) / 2;
      b(0, 2 * a) = b(2, 2 * a + 1) = dx;
      b(1, 2 * a + 1) = b(2, 2 * a) = dy;
    }
    k += b.transpose() * elasticity * b / 4;
  }
  return k;
}

/// `cells` along a side, half of them high in each block. The lower block is clamped at its bottom, the upper one at
/// its top (a large spring, so that both matrices keep every unknown).
System stacked_blocks(int cells, Kind kind) {
  const double rho = 1, friction = 0.3, spring = 1e3;
  const int across = cells + 1, rows = cells / 2 + 1, block = across * rows;
  const int displacements = 4 * block;
  const int size = kind == Kind::spd ? displacements : displacements + 2 * across;
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int i, int j, double value) { entries.emplace_back(i, j, value); };
  const auto node = [&](int body, int i, int j) { return body * block + j * across + i; };
  const auto cell = unit_cell();
  for (int body = 0; body < 2; ++body) {
    for (int j = 0; j + 1 < rows; ++j)
      for (int i = 0; i + 1 < across; ++i) {
        const int nodes[4] = {node(body, i, j), node(body, i + 1, j), node(body, i + 1, j + 1), node(body, i, j + 1)};
        for (int a = 0; a < 8; ++a)
          for (int b = 0; b < 8; ++b) add(2 * nodes[a / 2] + a % 2, 2 * nodes[b / 2] + b % 2, cell(a, b));
      }
    const int clamped = body == 0 ? 0 : rows - 1;
    for (int i = 0; i < across; ++i)
      for (int c = 0; c < 2; ++c) {
        const int dof = 2 * node(body, i, clamped) + c;
        add(dof, dof, spring);
      }
  }
  for (int i = 0; i < across; ++i) {
    const int left = std::min(i, cells - 1);
    const double weight = i == left ? 0.7 : 0.0;  // of the left master node
    const int nodes[3] = {node(1, i, 0), node(0, left, rows - 1), node(0, left + 1, rows - 1)};
    const double gap[3] = {1, -weight, -(1 - weight)};
    const int state = kind == Kind::sliding ? i % 10 : 9;  // 0-4 slip, 5-7 stick, 8 and 9 open; stuck: all stick
    const bool slip = kind == Kind::sliding && state < 5;
    const bool open = kind == Kind::sliding && state >= 8;
    // Traction t = D (lambda + rho g), g = G u; D = 1 (stick), 0 (open), [0 -mu; 0 1] (slip), unknowns (T, N).
    Eigen::Matrix2d d = Eigen::Matrix2d::Identity();
    if (slip) d << 0, -friction, 0, 1;
    if (open) d.setZero();
    const Eigen::Matrix2d rest = (d - Eigen::Matrix2d::Identity()) / rho;
    for (int r = 0; r < 2; ++r)
      for (int s = 0; s < 2; ++s) {
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            add(2 * nodes[a] + r, 2 * nodes[b] + s,
                kind == Kind::spd ? (r == 1 && s == 1 ? 1e3 * gap[a] * gap[b] : 0.0) : rho * gap[a] * d(r, s) * gap[b]);
        if (kind == Kind::spd) continue;
        for (int a = 0; a < 3; ++a) {
          add(2 * nodes[a] + r, displacements + 2 * i + s, gap[a] * d(r, s));
          add(displacements + 2 * i + r, 2 * nodes[a] + s, d(r, s) * gap[a]);
        }
        add(displacements + 2 * i + r, displacements + 2 * i + s, rest(r, s));
      }
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  auto pattern = std::make_shared<Pattern>();
  pattern->size = size;
  pattern->column_start.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + size + 1);
  pattern->row.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  return {pattern,
          {matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros()},
          kind == Kind::spd     ? Symmetry::positive_definite
          : kind == Kind::stuck ? Symmetry::indefinite
                                : Symmetry::general};
}

enum class Task { analyse, factorise, solve, transposed, solve_8 };

void run(benchmark::State& state, Backend backend, Kind kind, Task task) {
  set_blas_threads(1);
  const System system = stacked_blocks(static_cast<int>(state.range(0)), kind);
  LinearSolver<double> solver(backend);
  solver.analyse(system.pattern, system.symmetry);
  if (!solver.factorise(system.values.data())) {
    state.SkipWithError(solver.message().c_str());
    return;
  }
  const Matrix<double> b = Matrix<double>::Random(system.pattern->size, task == Task::solve_8 ? 8 : 1);
  for (auto _ : state) switch (task) {
      case Task::analyse:
        solver.analyse(system.pattern, system.symmetry);
        break;
      case Task::factorise:
        benchmark::DoNotOptimize(solver.factorise(system.values.data()));
        break;
      case Task::solve:
      case Task::solve_8:
        benchmark::DoNotOptimize(solver.solve(b));
        break;
      case Task::transposed:
        benchmark::DoNotOptimize(solver.solve(b, Taken::transposed));
        break;
    }
  state.SetLabel(solver.name());
  state.counters["n"] = system.pattern->size;
  state.counters["nonzeros"] = system.pattern->nonzeros();
  if (task == Task::analyse) return;
  state.counters["factor"] = static_cast<double>(solver.factor_nonzeros());
  if (task != Task::factorise) state.counters["backward_error"] = solver.backward_error();
}

void register_all() {
  constexpr std::array<std::pair<const char*, Backend>, 3> backends{
      {{"cholmod", Backend::cholmod}, {"mumps", Backend::mumps}, {"eigen", Backend::eigen}}};
  constexpr std::array<std::pair<const char*, Kind>, 3> kinds{
      {{"spd", Kind::spd}, {"stuck", Kind::stuck}, {"sliding", Kind::sliding}}};
  constexpr std::array<std::pair<const char*, Task>, 5> tasks{{{"analyse", Task::analyse},
                                                               {"factorise", Task::factorise},
                                                               {"solve", Task::solve},
                                                               {"transposed", Task::transposed},
                                                               {"solve_8", Task::solve_8}}};
  for (const auto& [kind_name, kind] : kinds)
    for (const auto& [backend_name, backend] : backends) {
      if (!has_backend(backend) || (backend == Backend::cholmod && kind != Kind::spd)) continue;
      for (const auto& [task_name, task] : tasks)
        benchmark::RegisterBenchmark(
            (std::string(kind_name) + "/" + backend_name + "/" + task_name).c_str(),
            [backend = backend, kind = kind, task = task](benchmark::State& s) { run(s, backend, kind, task); })
            ->Unit(benchmark::kMillisecond)
            ->Arg(2)
            ->Arg(10)
            ->Arg(32)
            ->Arg(100)
            ->Arg(222);
    }
}

}  // namespace
}  // namespace stickslip::linear_solver_bench

int main(int argc, char** argv) {
  stickslip::linear_solver_bench::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::AddCustomContext("blas", stickslip::blas_name());
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
