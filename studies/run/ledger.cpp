#include "studies/run/ledger.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "core/engine/body_rows.hpp"
#include "core/model/storage.hpp"
#include "studies/run/ledger_parts.hpp"

namespace stickslip {
namespace {

Condensed condensed_in(const CaseResult& result) {
  const std::string& engine = result.trajectory.engine;
  return engine.starts_with("condensed")                 ? Condensed::all
         : engine.find("condensed") != std::string::npos ? Condensed::part
                                                         : Condensed::nothing;
}

StateBytes kept_states(const Trajectory<double>& trajectory) {
  StateBytes bytes = state_bytes(trajectory.initial);
  for (const auto& increment : trajectory.increments) {
    bytes += state_bytes(increment.state);
    for (const auto& other : increment.others) bytes += state_bytes(other);
  }
  return bytes;
}

/// States after each augmentation, which only truncated derivatives read.
double kept_sweeps(const Trajectory<double>& trajectory) {
  long bytes = 0;
  for (const auto& increment : trajectory.increments)
    for (const auto& sweep : increment.augmented) bytes += state_bytes(sweep.state).all() + bytes_of(sweep.rho_factor);
  return static_cast<double>(bytes);
}

double kept_iterations(const Trajectory<double>& trajectory) {
  long bytes = 0;
  for (const auto& increment : trajectory.increments) bytes += bytes_of(increment.history);
  return static_cast<double>(bytes);
}

double derivative_bytes(const Gradients& gradients) {
  long bytes = bytes_of(gradients.of_objectives) + bytes_of(gradients.last_displacement);
  for (const auto* list :
       {&gradients.of_responses, &gradients.from_below, &gradients.from_above, &gradients.nearest_change})
    for (const auto& matrix : *list) bytes += bytes_of(matrix);
  return static_cast<double>(bytes);
}

double sides_bytes(const std::optional<OneSided>& sides) {
  long bytes = 0;
  if (!sides) return 0;
  for (const auto* list : {&sides->backward, &sides->forward})
    for (const auto& matrix : *list) bytes += bytes_of(matrix);
  return static_cast<double>(bytes);
}

/// Of a factor that holds both triangles because friction makes them differ, the one that a symmetric factor of the
/// same entries would spare. (A dense factor is a square in either case.)
double spared_triangle(const EngineReport& engine, bool dense, double rows) {
  const auto entries = static_cast<double>(engine.factor_entries);
  if (!engine.unsymmetric || dense || entries <= rows) return 0;
  return static_cast<double>(engine.factor) * (entries - rows) / 2 / entries;
}

LedgerRow bodies_row(const CaseResult& result, const StateBytes& states) {
  const auto& [model, slots, seconds] = *result.problem;
  return {"bodies",
          !model.bodies.empty(),
          {{"displacements", static_cast<double>(model.free_dofs.size())}},
          {{"mesh", mesh_bytes(model)},
           {"slots", static_cast<double>(slot_bytes(slots).bodies)},
           {"matrix", static_cast<double>(result.engine.bodies)},
           {"states", static_cast<double>(states.displacements)}},
          {{"elements", element_count(model)}},
          seconds.setup + result.trajectory.seconds.bodies};
}

/// Contact without friction, friction, masters that deform, and bodies that flow. Multipliers are unknowns where the
/// systems that were solved had rows for them.
void add_contact_rows(const CaseResult& result, const StateBytes& states, Ledger& ledger) {
  const auto& [model, slots, unused] = *result.problem;
  const auto& trajectory = result.trajectory;
  const bool dense = condensed_in(result) == Condensed::all;
  const double rows = trajectory.reduced_unknowns;
  const double multipliers = rows - solved_displacements(model, condensed_in(result));
  const auto& contact = trajectory.initial.contact;
  const auto normal = static_cast<double>(contact.gap.size());
  const Masters masters = masters_of(model);
  const long tangents = trajectory.counters.factorizations - result.condensing.factorizations;
  ledger.push_back({"contact",
                    model.effects.contact,
                    {{"normal", std::min(multipliers, normal)}},
                    {{"points", point_bytes(model, slots) - masters.bytes},
                     {"states", static_cast<double>(states.contact)},
                     {"multipliers", static_cast<double>(states.multipliers)}},
                    {{"points", normal}, {"evaluations", static_cast<double>(trajectory.counters.contact_evaluations)}},
                    model.effects.contact ? result.problem->seconds.contact_search + trajectory.seconds.contact_search +
                                                trajectory.seconds.contact
                                          : 0});
  ledger.push_back({"friction",
                    model.effects.friction,
                    {{"tangential", std::max(multipliers - normal, 0.0)}},
                    {{"history", static_cast<double>(states.history)},
                     {"multipliers", static_cast<double>(states.tangential)},
                     {"factor", spared_triangle(result.engine, dense, rows)}},
                    {{"unsymmetric_factorizations", result.engine.unsymmetric ? static_cast<double>(tangents) : 0}},
                    model.effects.friction ? not_apart : 0});
  ledger.push_back({"deformable_masters",
                    model.effects.deformable_master,
                    {},
                    {{"weights", masters.bytes}},
                    {{"nodes", masters.nodes}},
                    model.effects.deformable_master ? not_apart : 0});
  ledger.push_back({"plasticity",
                    model.effects.plasticity,
                    {},
                    {{"history", static_cast<double>(states.bodies)}},
                    {{"numbers", static_cast<double>(model.memory_count)}},
                    model.effects.plasticity ? not_apart : 0});
}

/// Back-solves, factorisations and evaluations; of derivatives but for `without`.
std::vector<Amount> derivative_counts(const Counters& all, const Counters& without = {}, double body_solves = 0) {
  const auto rest = [](long a, long b) { return static_cast<double>(a - b); };
  return {{"backsolves", rest(all.sensitivity_backsolves, without.sensitivity_backsolves)},
          {"body_backsolves", body_solves},
          {"factorizations", rest(all.factorizations, without.factorizations)},
          {"evaluations", rest(all.contact_evaluations, without.contact_evaluations)}};
}

/// Direct, adjoint, and what a kink adds to either. A mode that is not asked for has neither counts nor bytes.
void add_sensitivity_rows(const CaseResult& result, Ledger& ledger) {
  const auto& model = result.problem->model;
  const auto& gradients = result.gradients;
  const auto& storage = gradients.storage;
  const bool adjoint = model.scene.sensitivity_mode == SensitivityMode::adjoint;
  Counters searched = gradients.search;
  if (result.one_sided) searched += result.one_sided->counters;
  const auto counts = derivative_counts(gradients.counters, searched, result.sensitivity_body_solves);
  const bool searches = result.one_sided.has_value() || searched.contact_evaluations > 0;
  const double search = searches ? gradients.search_seconds + result.one_sided_seconds : 0;
  const double seconds = model.effects.sensitivity ? gradients.seconds - search : 0;
  const double slots = static_cast<double>(storage.slots), kept = derivative_bytes(gradients);
  const auto none = derivative_counts({});
  auto adjoint_counts = adjoint ? counts : none;
  adjoint_counts.push_back({"repeated_increments", static_cast<double>(gradients.repeated)});
  ledger.push_back({"direct_sensitivity",
                    model.effects.sensitivity && !adjoint,
                    {{"parameters", static_cast<double>(gradients.last_displacement.cols())}},
                    {{"slots", adjoint ? 0 : slots},
                     {"stiffness", static_cast<double>(storage.stiffness)},
                     {"states", adjoint ? 0 : static_cast<double>(storage.states)},
                     {"solves", static_cast<double>(storage.loads)},
                     {"sweeps", adjoint ? 0 : kept_sweeps(result.trajectory)},
                     {"derivatives", adjoint ? 0 : kept}},
                    adjoint ? none : counts,
                    adjoint ? 0 : seconds});
  ledger.push_back({"adjoint_sensitivity",
                    model.effects.sensitivity && adjoint,
                    {{"objectives", adjoint ? static_cast<double>(gradients.of_objectives.rows()) : 0}},
                    {{"slots", adjoint ? slots : 0},
                     {"states", adjoint ? static_cast<double>(storage.states) : 0},
                     {"tape", static_cast<double>(storage.tape)},
                     {"adjoints", static_cast<double>(storage.adjoints)},
                     {"sweeps", adjoint ? kept_sweeps(result.trajectory) : 0},
                     {"derivatives", adjoint ? kept : 0}},
                    adjoint_counts,
                    adjoint ? seconds : 0});
  ledger.push_back({"one_sided_search",
                    searches,
                    {},
                    {{"derivatives", sides_bytes(result.one_sided)}},
                    derivative_counts(searched),
                    search});
}

/// Linear systems, by the engine that solved them. Of a mixed scene the sparse engine did, and what is condensed is in
/// the other row.
LedgerRow engine_row(const CaseResult& result, bool condensed) {
  const auto& model = result.problem->model;
  const auto& trajectory = result.trajectory;
  const Condensed what = condensed_in(result);
  const bool on = (what == Condensed::all) == condensed;
  const auto& engine = result.engine;
  const auto& counts = trajectory.counters;
  const auto of = [&](auto amount) { return on ? static_cast<double>(amount) : 0.0; };
  const double friction = spared_triangle(engine, condensed, trajectory.reduced_unknowns);
  const bool shown = on || (condensed && what == Condensed::part);
  LedgerRow row{condensed ? "condensed_engine" : "sparse_engine", shown, {}, {}, {}, 0};
  if (condensed) {
    const auto any = [&](double amount) { return shown ? amount : 0; };
    row.unknowns = {
        {"eliminated", any(static_cast<double>(model.free_dofs.size()) - solved_displacements(model, what))}};
    row.memory = {{"condensed", any(static_cast<double>(engine.condensed))},
                  {"bodies_factor", any(static_cast<double>(engine.bodies_factor))}};
    row.counts = {{"body_backsolves", any(result.body_solves)}};
  }
  row.memory.insert(row.memory.end(), {{"matrix", of(engine.matrix)},
                                       {"factor", of(engine.factor) - (on ? friction : 0)},
                                       {"iterations", on ? kept_iterations(trajectory) : 0}});
  row.counts.insert(row.counts.end(), {{"matrix_entries", of(engine.matrix_entries)},
                                       {"factor_entries", of(engine.factor_entries)},
                                       {"analyses", of(counts.analyses)},
                                       {"factorizations", of(counts.factorizations)},
                                       {"backsolves", of(counts.backsolves)},
                                       {"iterations", of(counts.newton)},
                                       {"augmentations", of(counts.augmentations)}});
  const auto& seconds = trajectory.seconds;
  row.seconds = of(seconds.setup + seconds.factorization + seconds.backsolve);
  return row;
}

LedgerRow output_row(const Written& written) {
  return {"output",
          written.files > 0,
          {},
          {{"fields", written.fields},
           {"solution", written.solution},
           {"picture", written.picture},
           {"trace", written.trace}},
          {{"files", static_cast<double>(written.files)}},
          written.seconds};
}

}  // namespace

double mesh_bytes(const Model& model) {
  long bytes = bytes_of(model.free_index) + bytes_of(model.free_dofs) + bytes_of(model.contact_nodes);
  for (const auto& body : model.bodies) {
    bytes += bytes_of(body.mesh.connectivity) + bytes_of(body.mesh.middles);
    for (const auto& [name, side] : body.mesh.sides) {
      bytes += bytes_of(side.nodes);
      for (const auto* facets : {&side.facets, &side.quadratic})
        for (const auto& facet : *facets) bytes += bytes_of(facet);
    }
  }
  return static_cast<double>(bytes);
}

double point_bytes(const Model& model, const Slots<double>& slots) {
  long bytes = slot_bytes(slots).contact;
  for (const auto& point : model.points) {
    bytes += static_cast<long>(sizeof(ContactPoint)) + bytes_of(point.nodes) + bytes_of(point.places) +
             bytes_of(point.corners) + bytes_of(point.faces) + bytes_of(point.area_facets) + bytes_of(point.segments) +
             bytes_of(point.overlaps);
    for (const auto& overlap : point.overlaps)
      bytes += bytes_of(overlap.vertices) + bytes_of(overlap.slave.side) + bytes_of(overlap.master.side);
    for (const auto& edge : point.area_edges) bytes += bytes_of(edge);
  }
  return static_cast<double>(bytes);
}

double element_count(const Model& model) {
  double count = 0;
  for (const auto& body : model.bodies) count += body.mesh.element_count();
  return count;
}

double solved_displacements(const Model& model, Condensed condensed) {
  if (condensed == Condensed::nothing) return static_cast<double>(model.free_dofs.size());
  if (condensed == Condensed::part) return mixed_displacements(model);
  double free = 0;
  for (int node : model.contact_nodes)
    for (int i = 0; i < model.dimension; ++i) free += model.free_index[node * model.dimension + i] >= 0;
  return free;
}

Masters masters_of(const Model& model) {
  std::set<int> nodes;
  long kept = 0;
  for (const auto& point : model.points) {
    nodes.insert(point.nodes.begin() + point.slave_nodes, point.nodes.end());
    kept += static_cast<long>(point.nodes.size()) - point.slave_nodes;
  }
  for (const auto& curve : model.surfaces) nodes.insert(curve.nodes.begin(), curve.nodes.end());
  return {static_cast<double>(nodes.size()), static_cast<double>(kept * (sizeof(double) + 2 * sizeof(int)))};
}

Ledger ledger(const CaseResult& result, const Written& written) {
  const StateBytes states = kept_states(result.trajectory);
  Ledger rows{bodies_row(result, states)};
  add_contact_rows(result, states, rows);
  add_sensitivity_rows(result, rows);
  rows.push_back(engine_row(result, true));
  rows.push_back(engine_row(result, false));
  rows.push_back(output_row(written));
  return rows;
}

}  // namespace stickslip
