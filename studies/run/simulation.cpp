#include "studies/run/simulation.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <tuple>

#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "studies/input/size_estimate.hpp"
#include "studies/io/printing.hpp"

namespace stickslip {

namespace {

/// What the bodies and their contact need, by sparse matrices.
ProblemSize size_without_steps(const Model& model, const Input& input) {
  return {.displacements = static_cast<double>(model.free_dofs.size()),
          .contact_dofs = static_cast<double>(model.contact_nodes.size()) * model.dimension,
          .contact_points = static_cast<double>(model.points.size()),
          .in_space = model.dimension == 3 && !model.bodies.empty(),
          .unsymmetric = kind_of(input, model).symmetry == Symmetry::general,
          .slides = model.effects.current_geometry};
}

/// What the engine of the run reduces; to find out takes an analysis.
Reduced reduced_by(const Problem& problem, const Input& input) {
  const auto engine = input.linear_algebra.engine;
  if (condenses(problem.model, input.method, engine)) return Reduced::bodies;
  FullBodies<double> bodies(problem.model, problem.slots);
  const auto tangent =
      make_condensed_tangent(problem.model, problem.slots, kind_of(input, problem.model), engine, bodies);
  return tangent ? Reduced::tangents : Reduced::nothing;
}

void add_steps(const Model& model, const Input& input, ProblemSize& size) {
  size.steps = static_cast<double>(model.times.size());
  if (const auto plan = plan_checkpoints(model, run_options(input)))
    size.thin_steps = std::max(0.0, size.steps - static_cast<double>(plan->whole() + plan->stride - 1));
}

}  // namespace

std::vector<int> order_of(const std::vector<Parameter>& parameters, const JsonDocument& scene) {
  using nlohmann::json;
  const auto place_of = [&](const std::string& name) -> std::optional<Place> {
    const json* named = value_at(scene.root(), "/parameters");
    for (const auto& known : {name, name.substr(0, name.rfind('/'))})
      if (named && named->is_object() && named->contains(known))
        return scene.key_place(child_pointer("/parameters", known));
    return std::nullopt;
  };
  std::vector<std::tuple<bool, int, int>> ranks;
  for (const auto& parameter : parameters) {
    const auto place = place_of(parameter.name);
    ranks.emplace_back(!place, place ? place->line : 0, place ? place->column : 0);
  }
  std::vector<int> order(parameters.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return ranks[a] < ranks[b]; });
  return order;
}

std::optional<Simulation> prepare(const JsonDocument& document, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics) {
  auto input = read_scene(document, overrides, method, diagnostics);
  if (!input) return std::nullopt;
  try {
    auto problem = std::make_shared<const Problem>(input->scene);
    check_memory(*problem, *input);
    auto order = order_of(problem->model.scene.parameters, document);
    return Simulation{std::move(*input), problem, std::move(order)};
  } catch (const ModelError& error) {
    diagnostics.error({document.place(error.pointer), error.pointer, error.what()});
    return std::nullopt;
  }
}

std::optional<Simulation> prepare(const std::string& file, const Overrides& overrides,
                                  const std::optional<std::string>& method, Diagnostics& diagnostics) {
  const auto document = JsonDocument::read(file, diagnostics);
  return document ? prepare(*document, overrides, method, diagnostics) : std::nullopt;
}

SystemKind kind_of(const Input& input, const Model& model) {
  return system_kind(model, multipliers_of(input.method), cone_radius_of(input.method), input.backend);
}

double needed_bytes(const Problem& problem, const Input& input) {
  ProblemSize size = size_without_steps(problem.model, input);
  add_steps(problem.model, input, size);
  size.reduced = reduced_by(problem, input);
  return estimated_bytes(size);
}

void check_memory(const Problem& problem, const Input& input) {
  using Engine = LinearAlgebra::Engine;
  const auto& model = problem.model;
  const Engine engine = input.linear_algebra.engine;
  const double limit = memory_limit();
  ProblemSize size = size_without_steps(model, input);
  const auto refuse_bodies = [&](const ProblemSize& needs) {
    throw ModelError("the bodies need " + too_much(estimated_bytes(needs), limit) + "; try fewer cells", "/bodies");
  };
  ProblemSize least = size;
  least.unsymmetric = false;
  if (estimated_bytes(least) > limit) refuse_bodies(least);
  std::optional<Reduced> known;
  const auto is_too_much = [&] {
    if (!known) {  // the analysis is made where it matters
      const auto fits = [&](Reduced reduced) {
        size.reduced = reduced;
        return estimated_bytes(size) <= limit;
      };
      if (fits(Reduced::nothing) && fits(Reduced::bodies)) return false;
      known = reduced_by(problem, input);
    }
    size.reduced = *known;
    return estimated_bytes(size) > limit;
  };
  if (is_too_much()) {
    if (size.reduced == Reduced::nothing) refuse_bodies(size);
    throw ModelError("the bodies, condensed to " + shown(size.contact_dofs) + " contact dofs, need " +
                         too_much(estimated_bytes(size), limit) + R"(; try {"engine": "sparse"}, or fewer cells)",
                     engine == Engine::condensed ? "/linear_solver/engine" : "/linear_solver");
  }
  add_steps(model, input, size);
  if (is_too_much())
    throw ModelError("its " + shown(size.steps) + " steps need " + too_much(estimated_bytes(size), limit) +
                         "; try fewer, or tables with fewer points",
                     "/time");
}

RunOptions run_options(const Input& input) {
  RunOptions options{input.linear_algebra, input.backend};
  if (input.scene.sensitivity_mode == SensitivityMode::adjoint) options.state_memory = input.state_memory;
  options.output_every = input.fields_every;
  return options;
}

nlohmann::json result_json(const Simulation& simulation, const CaseResult& result) {
  auto out = result_json(result, canonical_text(simulation.input));
  for (const int j : simulation.order)
    out["parameter_order"].push_back(simulation.problem->model.scene.parameters[j].name);
  return out;
}

CaseResult simulate(const Simulation& simulation, const std::function<void()>& on_step, Trace* trace) {
  auto options = run_options(simulation.input);
  options.on_step = on_step;
  options.trace = trace;
  std::shared_ptr<Condensation<double>> condensation;
  return run_case(simulation.problem, simulation.input.method, options, condensation);
}

}  // namespace stickslip
