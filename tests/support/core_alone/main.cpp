// The nearest traction of the cone, and the alignment that the libraries were compiled for.
#include <cstdio>

#include "core/algebra/linear_solver.hpp"
#include "core/contact/friction_cone.hpp"

int main() {
  using namespace stickslip;
  Traction<double, 1> trial;
  trial.normal = -2;
  trial.tangential[0] = 5;
  const auto t = project_onto_cone(trial, 0.5, classify(trial, 0.5, 0));
  std::printf("t = %g %g, backends: %d\n", t.normal, t.tangential[0], has_backend(Backend::eigen));
}
