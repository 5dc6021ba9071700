#include "studies/sweep/budget_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "studies/input/method_options.hpp"
#include "studies/run/simulation.hpp"
#include "studies/sweep/attempt.hpp"
#include "studies/sweep/error_budget.hpp"
#include "studies/sweep/study.hpp"
#include "studies/sweep/study_cell.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Below what any solve leaves, so that iterations end where rounding ends them.
constexpr double tightest = 1e-15;
/// A contraction of 0.997 an update, which takes away a digit in 800, still gets there.
constexpr int most_augmentations = 10'000;

void tighten(Method& method) {
  std::visit([](auto& chosen) { chosen.tighten(tightest, most_augmentations); }, method);
}

/// The cell with the exact enforcement, on a finer mesh and in finer steps.
CellInput exact_cell(const CellInput& cell, int mesh_halvings, int step_halvings, MeshFiles& meshes) {
  CellInput fine = cell;
  refine_meshes(fine.document, mesh_halvings, {fine.document.file()});
  if (step_halvings > 0) refine_steps(fine.document, step_halvings, {fine.document.file()});
  const Reference exact{Reference::Kind::method, {}, {std::string(MonolithicAL::name), {fine.document.file()}, {}}, 0};
  return reference_cell(fine, exact, program_version(), meshes);
}

/// The part that pairs of runs differ by in the mean; what is missing where one of them has no answer.
BudgetPart mean_difference(const auto& first, const auto& second, const std::string& quantity) {
  std::vector<double> differences;
  for (std::size_t k = 0; k < first.size(); ++k) {
    for (const auto* run : {&first[k], &second[k]})
      if (!run->usable) return BudgetPart::unknown(fmt::format("{}: {}", run->name, run->status));
    const auto a = first[k].values.find(quantity), b = second[k].values.find(quantity);
    if (a == first[k].values.end() || b == second[k].values.end())
      return BudgetPart::unknown("the method that enforces contact exactly has no such derivative");
    differences.push_back(a->second - b->second);
  }
  return mean_of(differences);
}

BudgetPart limit_part(const auto& exact, const auto& finer, const std::string& quantity, double noise) {
  if (finer[0].same) return {0, 0, std::nullopt, "there is no mesh"};
  for (const auto* run : {&exact, &finer[0], &finer[1]}) {
    if (!run->usable) return BudgetPart::unknown(fmt::format("{}: {}", run->name, run->status));
    if (run->values.count(quantity) == 0)
      return BudgetPart::unknown("the method that enforces contact exactly has no such derivative");
  }
  return beyond_limit(exact.values.at(quantity), finer[0].values.at(quantity), finer[1].values.at(quantity), noise);
}

/// Whether the errors of a study are against finer meshes alone, with the steps of the runs.
bool are_of_the_same_steps(const std::vector<Reference>& references) {
  const auto has = [&](Reference::Kind kind) {
    return std::any_of(references.begin(), references.end(), [&](const auto& of) { return of.kind == kind; });
  };
  return has(Reference::Kind::overkill) && !has(Reference::Kind::analytic) && !has(Reference::Kind::values);
}

}  // namespace

void round_otherwise(Scene& scene, int copy) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.numbers.size(); ++i) {
    double& number = scene.numbers[i];
    const char digit = fingerprint(scene.pointers[i] + "\n" + std::to_string(copy)).back();
    const bool up = digit % 2 == 0;  // of 0-9 and a-f as many are even as odd
    if (number != 0) number = std::nextafter(number, up ? infinity : -infinity);
  }
}

void multiply_stiffness(Method& method, Scene& scene, double factor) {
  const auto multiply = [&](Regularisation& rho, double automatic) {
    if (rho.kind == Regularisation::Kind::automatic) rho = {Regularisation::Kind::relative, automatic};
    rho.value.value *= factor;
    if (rho.value.slot >= 0) scene.numbers[static_cast<std::size_t>(rho.value.slot)] *= factor;
  };
  const bool normals_turn = scene.finite_strain && make_model(scene).effects.normals_turn;
  std::visit([&](auto& chosen) { multiply(chosen.regularisation(), chosen.automatic_multiple.of(normals_turn)); },
             method);
}

void refine_steps(JsonDocument& scene, int halvings, const Place& origin) {
  json time = scene.root().at("time");
  const auto finer = [&](json& count) { count = count.get<double>() * (1 << halvings); };
  if (time.contains("legs"))
    for (json& leg : time["legs"]) finer(leg[1]);
  else
    finer(time["steps"]);
  scene.set("/time", std::move(time), origin);
}

json no_budget(int copies) { return {{"copies", copies}, {"reason", "the run did not converge"}}; }

std::map<std::string, double> BudgetRunner::values(const CaseResult& result) const {
  const ReferenceValues measured = values_of(result), reference = against_(result);
  std::map<std::string, double> out;
  const auto add = [&](const std::string& name, double value, const auto& references, const std::string& key) {
    if (!asked_for(name, study_.errors)) return;
    const auto exact = references.find(key);
    out[name] = exact == references.end() ? value : value - exact->second;
  };
  for (const auto& [response, value] : measured.responses)
    add("response:" + response, value, reference.responses, response);
  static const std::map<std::string, double> none;
  for (const auto& [response, derivatives] : measured.sensitivities) {
    const auto references = reference.sensitivities.find(response);
    for (const auto& [parameter, value] : derivatives)
      add("sensitivity:" + response + "/" + parameter, value,
          references == reference.sensitivities.end() ? none : references->second, parameter);
  }
  return out;
}

BudgetRunner::Run BudgetRunner::run(std::string name, const std::function<CaseResult()>& work) {
  ++runs_;
  Run out{std::move(name), "", "", false, false, {}};
  const auto breakdown = attempt([&] {
    try {
      const CaseResult result = work();
      out.status = name_of(result.status());
      out.message = result.message();
      out.usable = is_converged(result.status());
      if (out.usable) out.values = values(result);
    } catch (const ModelError& error) {  // as of a mesh that memory does not hold
      out.status = "refused";
      out.message = error.what();
    }
  });
  if (breakdown) {
    out.status = breakdown->status;
    out.message = breakdown->message;
  }
  return out;
}

BudgetRunner::Run BudgetRunner::exact_run(const CellInput& cell, int mesh_halvings, int step_halvings) {
  constexpr const char* times[] = {"", " halved once", " halved twice"};
  std::string name = "exact enforcement";
  if (mesh_halvings > 0) name += std::string(", mesh") + times[mesh_halvings];
  if (step_halvings > 0) name += std::string(", steps") + times[step_halvings];
  const auto fine = exact_cell(cell, mesh_halvings, step_halvings, meshes_);
  if (mesh_halvings > 0 && fine.canonical == exact_cell(cell, 0, 0, meshes_).canonical)
    return {name, "", "", false, true, {}};
  return run(name, [&] {
    Diagnostics faults;
    auto read = read_scene(fine.document, std::string(MonolithicAL::name), faults, meshes_);
    if (!read) throw ModelError(faults.text());  // finer than a scene may be
    Input& input = *read;
    tighten(input.method);
    const auto problem = problem_of(input);
    check_memory(*problem, input);
    std::shared_ptr<Condensation<double>> own;
    return run_case(problem, input.method, run_options(input), own);
  });
}

/// `stretch`: most by which stiffness or scale is changed, as a share; copies are evenly spread between both signs.
BudgetRunner::Run BudgetRunner::copied(const Copy& copy, int number, Input input, const std::string& name,
                                       double stretch) {
  return run(fmt::format("{}, copy {}", name, number), [&] {
    round_otherwise(input.scene, number);
    const int all = study_.budget_copies;
    multiply_stiffness(input.method, input.scene, 1 + stretch * (2 * number - 1 - all) / (all - 1));
    auto condensation = copy.condensation;  // one that the run makes would refer to its own problem
    return run_case(problem_of(input), input.method, run_options(input), condensation);
  });
}

void BudgetRunner::enter(const CellInput& cell) {
  if (shared_.key == variant_key(cell)) return;
  shared_ = {};
  shared_.exact = exact_run(cell, 0, 0);
  for (int halvings : {1, 2}) {
    shared_.steps[halvings - 1] = exact_run(cell, 0, halvings);
    shared_.mesh[halvings - 1] = exact_run(cell, halvings, 0);
  }
  Input input = input_of(exact_cell(cell, 0, 0, meshes_), meshes_);
  tighten(input.method);
  for (int number = 1; number <= study_.budget_copies; ++number) {
    Copy& copy = shared_.copies.emplace_back();
    copy.exact.name = fmt::format("exact enforcement, copy {}", number);
    Input moved = input;
    round_otherwise(moved.scene, number);
    const auto breakdown = attempt([&] {
      copy.problem = problem_of(moved);
      copy.condensation = condense(*copy.problem, run_options(moved));
    });
    if (breakdown)
      copy.exact = {copy.exact.name, breakdown->status, breakdown->message, false, false, {}};
    else
      copy.exact = copied(copy, number, input, "exact enforcement");
  }
  shared_.key = variant_key(cell);
}

/// Of a limit: the scatter of the copies, which three values at growing cost exceed, and that of the last digits.
double BudgetRunner::noise_of(const std::string& quantity, double scale) const {
  constexpr double headroom = 10, digits = 16;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const auto& copy : shared_.copies)
    if (const auto found = copy.exact.values.find(quantity); found != copy.exact.values.end()) {
      low = std::min(low, found->second);
      high = std::max(high, found->second);
    }
  return std::max(high > low ? headroom * (high - low) : 0, digits * unit_roundoff * scale);
}

/// The share of stiffness or scale that changes the answers by some roundings, and what it leads to by many: what a
/// method is off by goes as a power of them.
double BudgetRunner::stretch_of(const CaseResult& given, const std::map<std::string, double>& own) const {
  constexpr double roundings = 16, most = 0.3;
  const auto scales = error_scales(given, against_(given));
  double off = 0;
  for (const auto& [quantity, value] : own)
    if (const auto exact = shared_.exact.values.find(quantity);
        exact != shared_.exact.values.end() && scales.at(quantity).size > 0)
      off = std::max(off, std::abs(value - exact->second) / scales.at(quantity).size);
  // Of a stiff penalty, which is off by the inverse of its multiple, most of that may be rounding.
  const auto multiple = regularisation_json(given)["multiple"]["max"];
  if (multiple.is_number()) off = std::min(off, 1 / multiple.get<double>());
  return off > 0 ? std::min(roundings * unit_roundoff / off, most) : most;
}

json BudgetRunner::of(const CellInput& cell, const CaseResult& given) {
  if (!is_converged(given.status())) return no_budget(study_.budget_copies);
  enter(cell);
  const Input input = input_of(cell, meshes_);
  Input tight = input;
  tighten(tight.method);
  const bool as_tight = to_json(tight.method) == to_json(input.method);
  const auto own_values = values(given);
  const double stretch = stretch_of(given, own_values);
  std::vector<Run> loose_runs, tight_runs, exact_runs;
  for (int number = 1; number <= study_.budget_copies; ++number) {
    const Copy& copy = shared_.copies[static_cast<std::size_t>(number - 1)];
    loose_runs.push_back(copied(copy, number, input, "as given", stretch));
    tight_runs.push_back(as_tight ? loose_runs.back() : copied(copy, number, tight, "tolerances tight", stretch));
    exact_runs.push_back(copy.exact);
  }

  json out = {{"copies", study_.budget_copies}, {"failed", json::array()}, {"quantities", json::object()}};
  long runs = 0;
  const auto count = [&](const Run& each) {
    if (each.same) return;
    ++runs;
    if (!each.usable) out["failed"].push_back({{"run", each.name}, {"status", each.status}, {"message", each.message}});
  };
  for (const auto* list : {&loose_runs, &exact_runs}) std::for_each(list->begin(), list->end(), count);
  if (!as_tight) std::for_each(tight_runs.begin(), tight_runs.end(), count);
  count(shared_.exact);
  for (const auto* pair : {&shared_.steps, &shared_.mesh}) std::for_each(pair->begin(), pair->end(), count);
  out["runs"] = runs;

  const ReferenceValues reference = against_(given);
  const auto scales = error_scales(given, reference);
  std::vector<Run> own(loose_runs.size(), Run{"as given", "", "", true, false, own_values});
  for (const auto& [quantity, value] : own.front().values) {
    const auto [scale, referred] = scales.at(quantity);
    if (!(scale > 0)) continue;  // nothing to be relative to
    const double noise = noise_of(quantity, scale);
    Budget budget;
    BudgetPart step = limit_part(shared_.exact, shared_.steps, quantity, noise);
    step.shared = referred && are_of_the_same_steps(study_.references);
    budget.parts = {{"rounding", mean_difference(own, loose_runs, quantity)},
                    {"iteration", mean_difference(loose_runs, tight_runs, quantity)},
                    {"enforcement", mean_difference(tight_runs, exact_runs, quantity)},
                    {"step", step},
                    {"mesh", limit_part(shared_.exact, shared_.mesh, quantity, noise)}};
    if (referred) budget.error = value;
    budget.scale = scale;
    out["quantities"][quantity] = to_json(budget);
  }
  return out;
}

}  // namespace stickslip
