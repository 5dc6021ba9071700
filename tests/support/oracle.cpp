#include "tests/support/oracle.hpp"

#include <complex>

#include "core/model/response.hpp"
#include "methods/all_methods.hpp"
#include "methods/rescue/find_equilibrium.hpp"
#include "methods/stepping/solve.hpp"
#include "tests/support/carried_complex.hpp"
#include "tests/support/compiled_slots.hpp"

namespace stickslip::oracle {

using Complex = std::complex<double>;

namespace {

Matrix<double> along(const Vector<double>& motion, const Model& model, const Method& method, const RunOptions& replay) {
  constexpr double h = 1e-30;
  auto numbers = model.scene.as<Complex>();
  for (std::size_t j = 0; j < model.scene.parameters.size(); ++j)
    for (const auto& [slot, weight] : model.scene.parameters[j].slots)
      numbers.at_slot[slot] += Complex(0, h * weight * motion[static_cast<Eigen::Index>(j)]);
  const auto slots = make_slots<Complex>(model, numbers);
  RunOptions options = replay;
  options.linear_algebra.engine = LinearAlgebra::Engine::sparse;
  options.backend = Backend::eigen;
  Workspace<Complex> workspace;
  const auto trajectory = solve_in<Complex>(model, slots, method, options, workspace);
  Matrix<double> out(model.scene.responses.size(), trajectory.increments.size());
  for (std::size_t n = 0; n < trajectory.increments.size(); ++n) {
    const auto& increment = trajectory.increments[n];
    const auto responses = evaluate_responses(model, slots, increment.state, increment.time);
    for (Eigen::Index i = 0; i < responses.size(); ++i) out(i, n) = responses[i].imag() / h;
  }
  return out;
}

RunOptions repeated(const std::vector<double>& step_table) {
  RunOptions replay;
  replay.replay = step_table;
  return replay;
}

}  // namespace

Matrix<double> complex_step(const Model& model, const Method& method, const std::vector<double>& step_table,
                            const Vector<double>& motion) {
  return along(motion, model, method, repeated(step_table));
}

Matrix<double> complex_step(const Model& model, const Method& method, const RunOptions& replay, int j) {
  return along(Vector<double>::Unit(static_cast<Eigen::Index>(model.scene.parameters.size()), j), model, method,
               replay);
}

Matrix<double> complex_step(const Model& model, const Method& method, const std::vector<double>& step_table, int j) {
  return complex_step(model, method, repeated(step_table), j);
}

}  // namespace stickslip::oracle
