/// Which backends are built in, which one is chosen, and what they tell of themselves.
#include <sys/mman.h>

#include <atomic>
#include <cmath>

#include "core/algebra/backend.hpp"
#include "core/algebra/memory.hpp"

// OpenBLAS where it is loaded, null elsewhere: the BLAS is the system's choice at run time, not ours at link time.
extern "C" {
__attribute__((weak)) char* openblas_get_config();
__attribute__((weak)) int openblas_get_parallel();
__attribute__((weak)) void openblas_set_num_threads(int);
__attribute__((weak)) void dsyrk_(const char* triangle, const char* transposed, const int* n, const int* k,
                                  const double* alpha, const double* a, const int* rows_of_a, const double* beta,
                                  double* c, const int* rows_of_c);
}

namespace stickslip {
namespace {

/// Below this size the fixed cost of a call of MUMPS (40 us) outweighs its faster kernels.
constexpr int small_matrix = 250;

/// The backend that `automatic` stands for; measured in docs/decisions.md, "Libraries of linear algebra".
Backend preferred(Symmetry symmetry, int size) {
  if (symmetry == Symmetry::positive_definite && has_backend(Backend::cholmod)) return Backend::cholmod;
  if (size < small_matrix) return Backend::eigen;
  if (has_backend(Backend::mumps)) return Backend::mumps;
  return Backend::eigen;
}

/// Has OpenBLAS take its work space, once for the process. It would ask for it again and again without an end if there
/// is no room, so whether there is any is found out before. Throws NoWorkSpace.
void take_work_space() {
  static std::atomic<bool> is_taken = false;  // (of two threads each may take it)
  if (is_taken || !openblas_get_config || !dsyrk_) return;
  void* const room =
      ::mmap(nullptr, NoWorkSpace::bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED) throw NoWorkSpace();
  ::munmap(room, NoWorkSpace::bytes);
  const int one = 1;
  const double factor = 1;
  double c = 0;
  dsyrk_("L", "N", &one, &one, &factor, &factor, &one, &factor, &c, &one);
  is_taken = true;
}

}  // namespace

template <class T>
std::unique_ptr<Factor<T>> make_factor(Backend backend, std::shared_ptr<const Pattern> pattern, Symmetry symmetry,
                                       [[maybe_unused]] int kept) {
  if constexpr (std::is_same_v<T, double>) {
    // CHOLMOD knows positive definite matrices alone.
    if (backend == Backend::automatic || (backend == Backend::cholmod && symmetry != Symmetry::positive_definite))
      backend = preferred(symmetry, pattern->size);
    if (backend != Backend::eigen) take_work_space();
#ifdef STICKSLIP_WITH_CHOLMOD
    if (backend == Backend::cholmod) return std::make_unique<Factor<T>>(CholmodFactor(std::move(pattern), kept));
#endif
#ifdef STICKSLIP_WITH_MUMPS
    if (backend == Backend::mumps) return std::make_unique<Factor<T>>(MumpsFactor(std::move(pattern), symmetry));
#endif
  }
  return std::make_unique<Factor<T>>(EigenFactor<T>(std::move(pattern)));
}

template std::unique_ptr<Factor<double>> make_factor<double>(Backend, std::shared_ptr<const Pattern>, Symmetry, int);
template std::unique_ptr<Factor<std::complex<double>>> make_factor<std::complex<double>>(Backend,
                                                                                         std::shared_ptr<const Pattern>,
                                                                                         Symmetry, int);

bool has_backend(Backend backend) {
  switch (backend) {
    case Backend::automatic:
    case Backend::eigen:
      return true;
    case Backend::cholmod:
#ifdef STICKSLIP_WITH_CHOLMOD
      return true;
#else
      return false;
#endif
    case Backend::mumps:
#ifdef STICKSLIP_WITH_MUMPS
      return true;
#else
      return false;
#endif
  }
  return false;
}

FactorSize predict_factor(std::shared_ptr<const Pattern> pattern, [[maybe_unused]] int kept) {
  if (pattern->size == 0) return {};
#ifdef STICKSLIP_WITH_CHOLMOD
  return CholmodFactor::predict(std::move(pattern), kept);
#else
  const double n = pattern->size;  // nested dissection of a square of cells, two unknowns a node
  return {60 * std::pow(n, 1.5), 6 * n * std::log2(n + 1)};
#endif
}

std::vector<std::string> linear_solver_libraries() {
  return {
#ifdef STICKSLIP_WITH_CHOLMOD
      CholmodFactor::library(),
#endif
#ifdef STICKSLIP_WITH_MUMPS
      MumpsFactor::library(),
#endif
      eigen_library()};
}

std::string blas_name() {
  if (!openblas_get_config) {
    if (linear_solver_libraries().size() == 1) return "none (Eigen's own kernels)";
    return "unknown (reference?)";
  }
  std::string name = openblas_get_config();
  if (openblas_get_parallel) {
    const int parallel = openblas_get_parallel();
    name += parallel == 0 ? " serial" : parallel == 1 ? " pthreads" : " OpenMP";
  }
  return name;
}

bool set_blas_threads(int n) {
  if (!openblas_set_num_threads) return false;
  openblas_set_num_threads(n);
  return true;
}

}  // namespace stickslip
