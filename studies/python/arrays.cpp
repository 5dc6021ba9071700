#include "studies/python/arrays.hpp"

#include <pybind11/numpy.h>

#include "methods/stepping/checkpoints.hpp"
#include "studies/python/result.hpp"

namespace py = pybind11;

namespace stickslip {
namespace {

/// Memory of the result `owner` as an array that keeps it alive and cannot be written to.
template <class T>
py::array view(const py::object& owner, const T* data, std::vector<py::ssize_t> shape) {
  py::array_t<T> array(std::move(shape), data, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// Column by column as rows of an array: D x n gives (n, D).
py::array rows(const py::object& owner, const Matrix<double>& matrix) {
  return view(owner, matrix.data(), {matrix.cols(), matrix.rows()});
}

py::dict responses(const py::object& owner, const RunResult& run) {
  const auto& names = run.simulation.problem->model.scene.responses;
  py::dict out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out[py::str(names[i].name)] = view(owner, run.responses.col(i).data(), {run.responses.rows()});
  return out;
}

py::dict sensitivities(const py::object& owner, const RunResult& run) {
  const auto& scene = run.simulation.problem->model.scene;
  py::dict out;
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    py::dict of;
    for (const int j : run.simulation.order) {
      const auto column = run.sensitivities[i].col(j);
      of[py::str(scene.parameters[j].name)] = view(owner, column.data(), {column.size()});
    }
    out[py::str(scene.responses[i].name)] = of;
  }
  return out;
}

py::dict elements(const py::object& owner, const RunResult& run) {
  py::dict out;
  for (const auto& table : run.elements) {
    const auto count = static_cast<py::ssize_t>(table.nodes.size()) / table.nodes_per_element;
    out[py::str(table.body)] = view(owner, table.nodes.data(), {count, table.nodes_per_element});
  }
  return out;
}

/// None of a step whose state an adjoint let go.
py::list displacements(const py::object& owner, const RunResult& run) {
  const auto& model = run.simulation.problem->model;
  py::list out;
  for (const auto& step : run.result.steps) {
    const auto& state = step.increment->state;
    if (is_whole(state))
      out.append(view(owner, state.displacement.data(), {model.node_count, model.dimension}));
    else
      out.append(py::none());
  }
  return out;
}

/// Values by name, in the order of the scene.
py::dict parameters(const RunResult& run) {
  const auto& all = run.simulation.problem->model.scene.parameters;
  py::dict out;
  for (const int j : run.simulation.order) out[py::str(all[j].name)] = all[j].value;
  return out;
}

/// By parameter; those that were not found are not there.
py::dict displacement_derivatives(const py::object& owner, const RunResult& run) {
  const auto& model = run.simulation.problem->model;
  const auto& derivatives = run.result.gradients.last_displacement;
  py::dict out;
  for (const int j : run.simulation.order)
    if (j < derivatives.cols())
      out[py::str(model.scene.parameters[j].name)] =
          view(owner, derivatives.col(j).data(), {model.node_count, model.dimension});
  return out;
}

py::dict contact(const py::object& owner, const ContactTable& table) {
  const auto count = static_cast<py::ssize_t>(table.nodes.size());
  py::dict out;
  out["nodes"] = view(owner, table.nodes.data(), {count});
  out["state"] = view(owner, table.state.data(), {count});
  out["pressure"] = view(owner, table.pressure.data(), {count});
  out["traction"] = rows(owner, table.traction);
  out["shear"] = rows(owner, table.shear);
  out["gap"] = view(owner, table.gap.data(), {count});
  out["slip"] = rows(owner, table.slip);
  const auto tangents = table.shear.rows();
  const auto dimension = table.traction.rows();
  out["tangent"] = view(owner, table.tangent.data(), {count, tangents, dimension});
  out["area"] = view(owner, table.area.data(), {count});
  return out;
}

/// By name, a table a step.
py::dict contacts(const py::object& owner, const RunResult& run) {
  const auto& all = run.simulation.problem->model.scene.contacts;
  py::dict out;
  for (std::size_t c = 0; c < all.size(); ++c) {
    py::list steps;
    for (const auto& tables : run.contacts) steps.append(contact(owner, tables[c]));
    out[py::str(all[c].name)] = steps;
  }
  return out;
}

}  // namespace

py::dict arrays_of(const py::object& owner) {
  const auto& run = owner.cast<const RunResult&>();
  py::dict out;
  out["times"] = view(owner, run.times.data(), {run.times.size()});
  const auto& steps = run.result.steps;
  const bool failed = !steps.empty() && !steps.back().increment->solved();
  out["failed_at"] = failed ? py::cast(steps.back().increment->time) : py::none();
  out["parameters"] = parameters(run);
  out["responses"] = responses(owner, run);
  out["sensitivities"] = sensitivities(owner, run);
  out["coordinates"] = rows(owner, run.simulation.problem->slots.points);
  out["elements"] = elements(owner, run);
  out["displacements"] = displacements(owner, run);
  out["displacement_derivatives"] = displacement_derivatives(owner, run);
  out["contacts"] = contacts(owner, run);
  return out;
}

}  // namespace stickslip
