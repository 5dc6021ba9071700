/// The compiled half of the Python package `stickslip`, as stickslip._stickslip: scenes and studies in, arrays and JSON
/// texts out. The other half, stickslip/*.py, gives these their classes and is what users see.
#include <pybind11/iostream.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <nlohmann/json.hpp>
#include <system_error>

#include "core/algebra/linear_solver.hpp"
#include "studies/io/input_fault.hpp"
#include "studies/io/printing.hpp"
#include "studies/python/arrays.hpp"
#include "studies/python/result.hpp"
#include "studies/report/labels.hpp"
#include "studies/report/records.hpp"
#include "studies/run/explain.hpp"
#include "studies/run/gradient_report.hpp"
#include "studies/sweep/run_study.hpp"
#include "studies/version.hpp"

namespace py = pybind11;

namespace stickslip {
namespace {

using nlohmann::json;
using Path = std::filesystem::path;
using Text = std::optional<std::string>;

// ---- faults ---------------------------------------------------------------------------------------------------------

/// Makes stickslip.InputError the exception that Python raises.
void set_input_error(const std::vector<std::string>& faults, const std::string& text) {
  const py::object type = py::module_::import("stickslip._stickslip").attr("InputError");
  const py::object error = type(text);
  error.attr("faults") = faults;
  PyErr_SetObject(type.ptr(), error.ptr());
}

[[noreturn]] void raise_input_error(const Diagnostics& diagnostics) {
  std::vector<std::string> faults;
  std::string text;
  for (const auto& fault : diagnostics.errors()) {
    faults.push_back(fault.text());
    text += (text.empty() ? "" : "\n") + faults.back();
  }
  set_input_error(faults, text);
  throw py::error_already_set();
}

/// An error of the operating system is one of Python's too.
void translate_exception(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputFault& fault) {
    const std::string text = printable_lines(fault.what());
    set_input_error({text}, text);
  } catch (const std::system_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

/// Lets Python's signal handlers run: Ctrl-C ends the work after the step, or the run, at hand.
void check_signals() {
  const py::gil_scoped_acquire locked;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

// ---- scenes ---------------------------------------------------------------------------------------------------------

/// JSON of a value of dicts, lists, texts and numbers (stickslip/_arguments.py).
std::string json_text_of(const py::handle& value) {
  return py::module_::import("json").attr("dumps")(value).cast<std::string>();
}

/// A scene as it is written, and as its faults name it: of a dict without the lines of a text that nobody sees.
struct Given {
  JsonDocument written, named;
};

/// The scene as a document: a dict, or the file of a name.
std::optional<Given> document_of(const py::object& scene, Diagnostics& diagnostics) {
  const bool is_dict = py::isinstance<py::dict>(scene);
  auto document = is_dict ? JsonDocument::parse(json_text_of(scene), "scene", diagnostics)
                          : JsonDocument::read(scene.cast<std::string>(), diagnostics);
  if (!document) return std::nullopt;
  auto named = is_dict ? JsonDocument::of(document->root(), "scene") : *document;
  return Given{*std::move(document), std::move(named)};
}

struct Loaded {
  Simulation simulation;
  std::string name;  ///< of the file, or "scene"
  std::vector<std::string> notes;
};

Loaded load(const py::object& scene, const Text& method, const py::dict& set) {
  Diagnostics diagnostics(python_arguments);
  Overrides overrides;
  for (const auto& [pointer, value] : set) overrides.push_back(pointer.cast<std::string>() + "=" + json_text_of(value));
  const auto given = document_of(scene, diagnostics);
  auto simulation = given ? prepare(given->named, overrides, method, diagnostics) : std::nullopt;
  if (!simulation) raise_input_error(diagnostics);
  simulation->order = order_of(simulation->problem->model.scene.parameters, given->written);
  std::vector<std::string> notes;
  for (const auto& note : diagnostics.notes()) notes.push_back(note.text());
  return {*std::move(simulation), given->named.file(), std::move(notes)};
}

// ---- what the package calls -----------------------------------------------------------------------------------------

py::dict run(const py::object& scene, const Text& method, const py::dict& set, const std::optional<Path>& folder) {
  auto [simulation, name, notes] = load(scene, method, set);
  std::string document;
  RunResult run;
  {
    const py::gil_scoped_release unlocked;
    std::optional<OutputFolder> held;
    if (folder) held = folder_of_run(*folder, {}, python_arguments);
    auto result = simulate(simulation, check_signals);
    if (folder) remove_run(*folder);
    document = json_text(folder ? write_result(*folder, simulation, result) : result_json(simulation, result));
    run = gather(std::move(simulation), std::move(result));
  }
  py::dict out = arrays_of(py::cast(std::move(run)));
  out["notes"] = notes;
  out["document"] = document;
  return out;
}

std::string explain_scene(const py::object& scene, const Text& method, const py::dict& set) {
  const auto loaded = load(scene, method, set);
  return explain(loaded.simulation.input, *loaded.simulation.problem);
}

/// (JSON, table, why it did not pass).
std::tuple<std::string, std::string, std::string> gradcheck(const py::object& scene, const Text& method,
                                                            const py::dict& set) {
  const auto loaded = load(scene, method, set);
  const py::gil_scoped_release unlocked;
  const auto check = check_gradients(loaded.simulation, loaded.name, [](int, int) { check_signals(); });
  return {json_text(check_json(check)), check_table(check), check_faults(check)};
}

/// The directory, how many cells have no row, and a line for each certificate that does not hold.
std::tuple<Path, long, std::vector<std::string>> study(const StudyArguments& arguments) {
  std::ostream log(nullptr);
  const py::scoped_ostream_redirect to_python(log, py::module_::import("sys").attr("stderr"));
  Diagnostics diagnostics(python_arguments);
  std::optional<StudyOutcome> outcome;
  {
    const py::gil_scoped_release unlocked;
    outcome = run_study(arguments, log, diagnostics, check_signals);
  }
  if (!outcome) raise_input_error(diagnostics);
  return {outcome->directory, outcome->lost, outcome->refuted};
}

/// What a study recorded, with the work and the curves that its report shows, as JSON.
std::string study_cells(const Path& folder) {
  const py::gil_scoped_release unlocked;
  auto study = report::read_study(folder);
  json cells = json::array();
  for (auto& cell : study.cells) {
    json knobs = json::object();
    for (const auto& knob : cell.knobs) knobs[knob.name] = knob.value ? json(*knob.value) : json(knob.text);
    const std::string knob = report::running_knob(study, cell.family);
    const auto* running = report::find_knob(cell, knob);
    cells.push_back({{"row", std::move(cell.record)},
                     {"method", cell.family},
                     {"label", cell.label},
                     {"curve", report::series_of(cell, knob)},
                     {"along", running && running->value ? json(*running->value) : json(nullptr)},
                     {"converged", cell.converged},
                     {"knobs", std::move(knobs)},
                     {"r", report::ratio_of(study.ratio, cell)},
                     {"work", cell.work},
                     {"sensitivity_work", cell.sensitivity_work},
                     {"seconds", cell.seconds},
                     {"sensitivity_seconds", cell.sensitivity_seconds}});
  }
  return json_text({{"cells", std::move(cells)}, {"faults", study.faults}, {"unrecorded", study.unrecorded}});
}

}  // namespace
}  // namespace stickslip

PYBIND11_MODULE(_stickslip, module) {
  using namespace stickslip;
  set_blas_threads(1);  // results that repeat to the last bit; numpy's too, where both use one BLAS
  module.attr("__version__") = std::string(version::number);
  module.attr("InputError") = py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
      "stickslip.InputError",
      "A scene, a study or a folder that is not valid. str() has all faults, one a line; `faults` lists them, each "
      "with\n"
      "its place: FILE:LINE:COL: POINTER: what is wrong, or of a dict \"scene: POINTER: what is wrong\".",
      PyExc_ValueError, nullptr));
  py::register_local_exception_translator(translate_exception);
  py::class_<RunResult>(module, "Memory", "What the arrays of a result look into; it lives as long as any of them.");
  module.def("run", &run);
  module.def("explain", &explain_scene);
  module.def("gradcheck", &gradcheck);
  module.def("study", [](const std::string& file, const std::string& folder, bool resume, bool restart,
                         const std::string& shard, int jobs) {
    return study({file, folder, resume, restart, shard, jobs});
  });
  module.def("study_cells", &study_cells);
}
