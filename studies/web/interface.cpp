/// The solver for a page in a browser: four C functions, texts in JSON in and out.
#include <emscripten/emscripten.h>

#include <exception>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "studies/app/exit_codes.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/explain.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/picture_json.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/view.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

constexpr int stopped = 4;  ///< after the exit codes of the program: stickslip_cancel() ended the run

/// What the functions below keep between calls.
struct Session {
  std::string result;
  void (*on_step)(int done, int steps) = nullptr;
  bool is_cancelled = false;
};
Session session;

/// Ends a run that stickslip_cancel() was called for.
struct Cancelled {
  int done, steps;
};

json diagnostics_json(const std::vector<Diagnostic>& diagnostics) {
  json out = json::array();
  for (const auto& d : diagnostics)
    out.push_back({{"line", d.place.line},
                   {"column", d.place.column},
                   {"pointer", d.pointer},
                   {"message", d.message},
                   {"text", d.text()}});
  return out;
}

/// Unknowns of a scene, before it is solved, and the diagonal of the box around its bodies (length).
json size_of(const Simulation& simulation) {
  const Model& model = simulation.problem->model;
  const auto& points = simulation.problem->slots.points;
  return {{"extent", (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm()},
          {"displacements", model.free_dofs.size()},
          {"contact_points", model.points.size()},
          {"steps", model.most_steps()},
          {"bytes", needed_bytes(*simulation.problem, simulation.input)}};
}

/// Force per area on the slave at each contact point, as the picture shows it.
json tractions_json(const Problem& problem, const State<double>& state) {
  const auto view = view_of(problem);
  json out = json::array();
  for (int p = 0; p < static_cast<int>(problem.model.points.size()); ++p) {
    Vector<double> t = traction_vector(problem, state, p);
    if (view) t = view->seen(t);
    out.push_back(std::vector<double>(t.data(), t.data() + t.size()));
  }
  return out;
}

/// picture.json as the program writes it, with the tractions of its contact points.
json picture_of(const CaseResult& result, int every) {
  json picture = picture_json(result, every);
  if (picture.is_null()) return picture;
  picture["interface"] = interface_json(result);
  const auto moments = kept_moments(result, every);
  for (std::size_t i = 0; every > 0 && i < moments.size(); ++i)
    picture["frames"][i]["traction"] = tractions_json(*result.problem, moments[i].state);
  if (!moments.empty()) picture["traction"] = tractions_json(*result.problem, moments.back().state);
  return picture;
}

/// result.json and picture.json of a run.
json answer_of(const Simulation& simulation, int& code) {
  int done_steps = 0;
  const int steps = static_cast<int>(simulation.problem->model.most_steps());
  const int every = simulation.input.fields_every;
  const auto result = simulate(simulation, [&] {
    ++done_steps;
    if (session.on_step) session.on_step(done_steps, steps);
    if (session.is_cancelled) throw Cancelled{done_steps, steps};
  });
  json answer = {{"result", result_json(simulation, result)},
                 {"scales", scales_json(result)},
                 {"picture", picture_of(result, every)}};
  code = is_converged(result.status()) ? done : not_solved;
  return answer;
}

/// Answers a request; `code`: what the program would return to the shell.
json answer_to(const json& request, int& code) {
  Diagnostics diagnostics;
  json answer = json::object();
  const auto document = JsonDocument::parse(request.at("scene").get<std::string>(), request.at("file"), diagnostics);
  std::optional<std::string> method;
  if (request.contains("method")) method = request["method"].get<std::string>();
  std::optional<Simulation> simulation;
  if (document) simulation = prepare(*document, request.value("set", Overrides()), method, diagnostics);
  if (simulation) {
    answer["size"] = size_of(*simulation);
    answer["document"] = simulation->input.document;
    if (request.value("explain", false)) answer["explain"] = explain(simulation->input, *simulation->problem);
    if (request.value("solve", true)) {
      simulation->input.fields_every = request.value("every", 0);
      answer.update(answer_of(*simulation, code));
    }
  } else {
    code = bad_input;
  }
  answer["faults"] = diagnostics_json(diagnostics.errors());
  answer["notes"] = diagnostics_json(diagnostics.notes());
  return answer;
}

}  // namespace
}  // namespace stickslip

extern "C" {

/// Scene in. `request` is {"scene": text of the file, "file": its name in messages, "method": name, "set":
/// ["POINTER=VALUE", ...], "every": fields of every so many-th step, "explain": bool, "solve": bool}; all but the first
/// two may be left out. Returns what the command `run` would return to the shell (docs/commands.md), or 4 if
/// stickslip_cancel() ended the run.
EMSCRIPTEN_KEEPALIVE int stickslip_scene(const char* request) {
  using namespace stickslip;
  session.is_cancelled = false;
  json answer;
  int code = done;
  try {
    answer = answer_to(json::parse(request), code);
  } catch (const Cancelled& at) {
    answer = {{"cancelled", {{"done", at.done}, {"steps", at.steps}}}};
    code = stopped;
  } catch (const std::exception& error) {
    answer = {{"broken", error.what()}};
    code = our_bug;
  }
  session.result = json_text(answer);
  return code;
}

/// Result out, of the last stickslip_scene(). Valid until the next call. Its keys:
/// - "faults": [{"line", "column", "pointer", "message", "text"}], and "notes", the same;
/// - if the scene has no fault, "size": {"displacements", "contact_points", "steps", "bytes", "extent"}, and
/// "document":
///   the scene as it was run;
/// - if it was solved, "result": result.json, "scales": scales_json() of it, and "picture": picture.json, with the
///   `traction` vectors of its contact points.
/// After code 4 it is {"cancelled": {"done", "steps"}}, after code 1 {"broken": why}.
EMSCRIPTEN_KEEPALIVE const char* stickslip_result() { return stickslip::session.result.c_str(); }

/// Progress: `report` is called after each step of a run; nullptr: nothing is.
EMSCRIPTEN_KEEPALIVE void stickslip_progress(void (*report)(int done, int steps)) {
  stickslip::session.on_step = report;
}

/// Cancel: the run ends after its present step. To be called by `report`, since nothing else runs meanwhile.
EMSCRIPTEN_KEEPALIVE void stickslip_cancel() { stickslip::session.is_cancelled = true; }

}  // extern "C"
