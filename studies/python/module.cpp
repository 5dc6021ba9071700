/// The Python module `stickslip`: runs a scene and hands out its result as numpy arrays that look into the memory of
/// the C++ result, which lives as long as any of them. stickslip.pyi is its contract.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "core/algebra/linear_solver.hpp"
#include "studies/python/result.hpp"
#include "studies/version.hpp"

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

const RunResult& run_of(const py::object& self) { return self.cast<const RunResult&>(); }

/// Column by column as rows of an array: D x n gives (n, D).
py::array rows(const py::object& owner, const Matrix<double>& matrix) {
  return view(owner, matrix.data(), {matrix.cols(), matrix.rows()});
}

/// `step` counts from 0, or from the end where it is negative.
std::size_t step_index(const RunResult& run, py::ssize_t step) {
  const auto count = static_cast<py::ssize_t>(run.result.steps.size());
  if (step < -count || step >= count)
    throw py::index_error("step " + std::to_string(step) + " of " + std::to_string(count));
  return static_cast<std::size_t>(step < 0 ? step + count : step);
}

template <class Named>
std::size_t index_of(const std::vector<Named>& all, const std::string& name) {
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return i;
  throw py::key_error(name);
}

py::dict responses(const py::object& self) {
  const auto& run = run_of(self);
  const auto& names = run.simulation.problem->model.scene.responses;
  py::dict out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out[py::str(names[i].name)] = view(self, run.responses.col(i).data(), {run.responses.rows()});
  return out;
}

py::dict sensitivities(const py::object& self) {
  const auto& run = run_of(self);
  const auto& scene = run.simulation.problem->model.scene;
  py::dict out;
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    py::dict of;
    for (std::size_t j = 0; j < scene.parameters.size(); ++j) {
      const auto column = run.sensitivities[i].col(j);
      of[py::str(scene.parameters[j].name)] = view(self, column.data(), {column.size()});
    }
    out[py::str(scene.responses[i].name)] = of;
  }
  return out;
}

py::dict elements(const py::object& self) {
  py::dict out;
  for (const auto& table : run_of(self).elements) {
    const auto count = static_cast<py::ssize_t>(table.nodes.size()) / table.nodes_per_element;
    out[py::str(table.body)] = view(self, table.nodes.data(), {count, table.nodes_per_element});
  }
  return out;
}

py::array displacement(const py::object& self, py::ssize_t step) {
  const auto& run = run_of(self);
  const auto& model = run.simulation.problem->model;
  const auto& u = run.result.steps[step_index(run, step)].increment->state.displacement;
  return view(self, u.data(), {model.node_count, model.dimension});
}

py::array displacement_derivative(const py::object& self, const std::string& parameter) {
  const auto& run = run_of(self);
  const auto& model = run.simulation.problem->model;
  const auto& derivative = run.result.gradients.last_displacement;
  const auto j = static_cast<Eigen::Index>(index_of(model.scene.parameters, parameter));
  if (derivative.cols() <= j) throw py::value_error("the derivatives were not found: " + run.result.message());
  return view(self, derivative.col(j).data(), {model.node_count, model.dimension});
}

py::dict contact(const py::object& self, const std::string& name, py::ssize_t step) {
  const auto& run = run_of(self);
  const auto which = index_of(run.simulation.problem->model.scene.contacts, name);
  const auto& table = run.contacts[step_index(run, step)][which];
  const auto count = static_cast<py::ssize_t>(table.nodes.size());
  py::dict out;
  out["nodes"] = view(self, table.nodes.data(), {count});
  out["state"] = view(self, table.state.data(), {count});
  out["pressure"] = view(self, table.pressure.data(), {count});
  out["traction"] = rows(self, table.traction);
  out["gap"] = view(self, table.gap.data(), {count});
  out["slip"] = rows(self, table.slip);
  out["area"] = view(self, table.area.data(), {count});
  return out;
}

/// JSON of a Python value; numpy's arrays and numbers are taken as lists and numbers.
std::string json_text(const py::handle& value) {
  const py::cpp_function plain([](const py::object& other) { return other.attr("tolist")(); });
  return py::module_::import("json").attr("dumps")(value, py::arg("default") = plain).cast<std::string>();
}

[[noreturn]] void raise_input_error(const Diagnostics& diagnostics) {
  py::list faults;
  for (const auto& fault : diagnostics.errors()) faults.append(fault.text());
  const py::object type = py::module_::import("stickslip").attr("InputError");
  const py::object error = type("\n" + diagnostics.text());
  error.attr("faults") = faults;
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

/// The scene as a document: a dict, or the file at a path.
std::optional<JsonDocument> document_of(const py::object& scene, Diagnostics& diagnostics) {
  if (!py::isinstance<py::dict>(scene))
    return JsonDocument::read(scene.cast<std::filesystem::path>().string(), diagnostics);
  const auto document = JsonDocument::parse(json_text(scene), "scene", diagnostics);
  if (!document) return std::nullopt;
  return JsonDocument::of(document->root(), "scene");  // without the lines of a text that nobody sees
}

/// Lets Python's signal handlers run: Ctrl-C ends the solve after the step at hand.
void check_signals() {
  const py::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

RunResult run(const py::object& scene, const std::optional<std::string>& method, const py::dict& set,
              const std::optional<std::filesystem::path>& folder) {
  Diagnostics diagnostics;
  Overrides overrides;
  for (const auto& [pointer, value] : set) overrides.push_back(pointer.cast<std::string>() + "=" + json_text(value));
  const auto document = document_of(scene, diagnostics);
  auto simulation = document ? prepare(*document, overrides, method, diagnostics) : std::nullopt;
  if (!simulation) raise_input_error(diagnostics);
  const py::gil_scoped_release unlocked;
  auto result = simulate(*simulation, check_signals);
  const auto text =
      folder ? write_result(*folder, *simulation, result) : result_json(result, canonical_text(simulation->input));
  auto run = gather(*std::move(simulation), std::move(result));
  run.document = text.dump();
  for (const auto& note : diagnostics.notes()) run.notes.push_back(note.text());
  return run;
}

void bind_result(py::module_& module) {
  py::class_<RunResult>(module, "Result", "What a run left; its arrays look into it and cannot be written to.")
      .def_property_readonly("status", [](const RunResult& r) { return std::string(name_of(r.result.status())); })
      .def_property_readonly("converged", [](const RunResult& r) { return is_converged(r.result.status()); })
      .def_property_readonly("message", [](const RunResult& r) { return r.result.message(); })
      .def_property_readonly("notes", [](const RunResult& r) { return r.notes; })
      .def_property_readonly("document",
                             [](const RunResult& r) { return py::module_::import("json").attr("loads")(r.document); })
      .def_property_readonly("warnings",
                             [](const RunResult& r) {
                               return py::object(py::module_::import("json").attr("loads")(r.document)["warnings"]);
                             })
      .def_property_readonly(
          "times", [](py::object self) { return view(self, run_of(self).times.data(), {run_of(self).times.size()}); })
      .def_property_readonly("responses", &responses)
      .def_property_readonly("sensitivities", &sensitivities)
      .def_property_readonly("coordinates",
                             [](py::object self) { return rows(self, run_of(self).simulation.problem->slots.points); })
      .def_property_readonly("elements", &elements)
      .def("displacement", &displacement, py::arg("step") = -1)
      .def("displacement_derivative", &displacement_derivative, py::arg("parameter"))
      .def("contact", &contact, py::arg("name"), py::arg("step") = -1);
}

/// An error of the operating system is one of Python's too.
void translate_system_error(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::system_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace
}  // namespace stickslip

PYBIND11_MODULE(stickslip, module) {
  using namespace stickslip;
  set_blas_threads(1);  // results that repeat to the last bit; numpy's too, where both use one BLAS
  module.doc() = "Frictional contact, three ways to enforce it, and their derivatives.";
  module.attr("__version__") = std::string(version::number);
  module.attr("InputError") = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "stickslip.InputError", "A scene with faults; `faults` lists them, each with its place.", PyExc_ValueError,
      nullptr));
  py::register_local_exception_translator(translate_system_error);
  bind_result(module);
  module.def("run", &run, py::arg("scene"), py::arg("method") = py::none(), py::arg("set") = py::dict(),
             py::arg("folder") = py::none(), "Runs a scene, a dict or the path of a file; see stickslip.pyi.");
}
