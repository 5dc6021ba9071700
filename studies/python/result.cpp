#include "studies/python/result.hpp"

#include <limits>
#include <tuple>

#include "studies/run/contact_points.hpp"
#include "studies/run/fields.hpp"

namespace stickslip {
namespace {

void gather_series(RunResult& run) {
  const auto& scene = run.simulation.problem->model.scene;
  const auto& steps = run.result.steps;
  const auto count = static_cast<Eigen::Index>(steps.size());
  const auto responses = static_cast<Eigen::Index>(scene.responses.size());
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  run.times.resize(count);
  run.responses.resize(count, responses);
  run.sensitivities.assign(responses, Matrix<double>::Constant(count, scene.parameters.size(), unknown));
  for (Eigen::Index n = 0; n < count; ++n) {
    run.times[n] = steps[n].increment->time;
    if (!steps[n].increment->solved()) {
      run.responses.row(n).setConstant(unknown);  // an iterate is no answer
      continue;
    }
    run.responses.row(n) = steps[n].responses.transpose();
    for (Eigen::Index i = 0; i < steps[n].sensitivities.rows(); ++i)
      run.sensitivities[i].row(n) = steps[n].sensitivities.row(i);
  }
}

ContactTable contact_table(const Problem& problem, const State<double>& state, int contact) {
  const auto& model = problem.model;
  std::vector<int> points;
  int tangents = 0;
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p)
    if (model.points[p].contact == contact) {
      points.push_back(p);
      tangents = std::max(tangents, model.points[p].tangents);
    }
  const auto count = static_cast<Eigen::Index>(points.size());
  ContactTable table{{}, {}, Vector<double>(count), Vector<double>(count), Vector<double>(count), {}, {}, {}, {}};
  table.traction.resize(model.dimension, count);
  table.shear = table.slip = Matrix<double>::Zero(tangents, count);
  table.tangent = Matrix<double>::Zero(static_cast<Eigen::Index>(tangents) * model.dimension, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const int p = points[i];
    const auto& point = model.points[p];
    table.nodes.push_back(point.nodes[0]);
    table.state.push_back(static_cast<unsigned char>(state_code(state.contact.state[p])));
    table.pressure[i] = -state.contact.traction[point.multiplier];
    table.gap[i] = state.contact.gap[p];
    table.area[i] = problem.slots.geometry[p].area;
    table.traction.col(i) = traction_vector(problem, state, p);
    table.shear.col(i).head(point.tangents) = -state.contact.traction.segment(point.multiplier + 1, point.tangents);
    table.slip.col(i).head(point.tangents) =
        state.contact.slip.segment(point.tangents ? tangential_offset(model, p) : 0, point.tangents);
    for (int a = 0; a < point.tangents; ++a)
      table.tangent.col(i).segment(static_cast<Eigen::Index>(a) * model.dimension, model.dimension) =
          geometry_in(state.contact, problem.slots, p).tangents.col(a);
  }
  return table;
}

}  // namespace

RunResult gather(Simulation simulation, CaseResult result) {
  RunResult run{std::move(simulation), std::move(result), {}, {}, {}, {}, {}};
  gather_series(run);
  const auto& model = run.simulation.problem->model;
  for (const auto& step : run.result.steps) {
    run.contacts.emplace_back();
    for (int c = 0; c < static_cast<int>(model.scene.contacts.size()); ++c)
      run.contacts.back().push_back(contact_table(*run.simulation.problem, step.increment->state, c));
  }
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& [mesh, first] = std::tie(model.bodies[b].mesh, model.bodies[b].first_node);
    ElementTable table{model.scene.bodies[b].name, nodes_of(mesh.shape), mesh.connectivity};
    for (int& node : table.nodes) node += first;
    run.elements.push_back(std::move(table));
  }
  return run;
}

}  // namespace stickslip
