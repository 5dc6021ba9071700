#include "studies/run/ledger_forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/algebra/reverse.hpp"
#include "core/engine/engine_price.hpp"
#include "core/model/response.hpp"
#include "core/model/storage.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "methods/stepping/engine_choice.hpp"
#include "sensitivity/differentiation.hpp"
#include "studies/run/fields.hpp"
#include "studies/run/ledger_parts.hpp"
#include "studies/run/simulation.hpp"
#include "studies/run/solution_file.hpp"

namespace stickslip {
namespace {

constexpr double exactly = 1, not_known = 0;
constexpr double real_bytes = sizeof(double);
/// Points that slide along curves have up to two patches each, and the pattern gains those that they pass: measured up
/// to 1.35 times what there is at the start, and 1.51 times in a tube that is pinched until it touches itself.
constexpr double of_moving_points = 2;

/// Counts that a forecast is made of.
struct Size {
  double dofs, contact_dofs, free, solved;  ///< displacements; `solved`: in the systems of the engine
  double condensed_dofs;                    ///< of the contact of condensed bodies
  double points, tangential, contacts;      ///< `contacts`: with a work of friction
  double feet, present;                     ///< of the slip history; points that keep a geometry in each state
  double remembered;                        ///< numbers of bodies that flow
  double states;                            ///< that the run keeps
  double whole, together_again;             ///< of these with displacements; those that are solved again together
  double repeated;                          ///< steps that are solved again
  double steps, parameters, blocks, responses, objectives;
  double together;  ///< increments that are differentiated at once
  double path;      ///< factor that the number of steps holds to, as a path finds its own
  double moving;    ///< factor of what depends on the masters' nodes of a point: points slide along curves
  bool condensed, mixed, unknown, unsymmetric, iterates, truncated, follows;
  Condensed what() const { return condensed ? Condensed::all : mixed ? Condensed::part : Condensed::nothing; }
};

Size size_of(const Input& input, const Model& model) {
  Size n{};
  const bool condenses_some = condenses(model, input.method, input.linear_algebra.engine);
  n.condensed = condenses_some && model.effects.linear_bulk;
  n.mixed = condenses_some && !n.condensed;
  n.unknown = multipliers_of(input.method) == Multipliers::unknown;
  n.unsymmetric = kind_of(input, model).symmetry == Symmetry::general;
  n.dofs = model.dof_count();
  n.contact_dofs = static_cast<double>(model.contact_nodes.size()) * model.dimension;
  n.free = static_cast<double>(model.free_dofs.size());
  n.solved = solved_displacements(model, n.what());
  n.condensed_dofs = n.condensed ? n.contact_dofs : n.mixed ? static_cast<double>(MixedRows(model).contact.size()) : 0;
  n.points = static_cast<double>(model.points.size());
  n.tangential = model.multiplier_count - n.points;
  n.feet = model.foot_count;
  n.remembered = model.memory_count;
  n.present = model.effects.current_geometry ? n.points : 0;
  n.contacts = model.effects.friction ? static_cast<double>(model.scene.contacts.size()) : 0;
  n.steps = static_cast<double>(model.times.size());
  n.path = model.scene.arc_length ? std::max(model.scene.arc_length->max / n.steps, n.steps) : exactly;
  n.moving = model.slides_on_surfaces() ? of_moving_points : exactly;
  n.states = n.whole = n.steps + 1;
  if (const auto plan = plan_checkpoints(model, run_options(input))) {
    n.whole = static_cast<double>(plan->whole()) + 1;
    n.together_again = static_cast<double>(std::min(plan->stride, plan->steps) - 1);
    n.repeated = static_cast<double>(plan->repeated());
  }
  n.parameters = static_cast<double>(model.scene.parameters.size());
  n.blocks = std::ceil(n.parameters / directions);
  n.responses = static_cast<double>(model.scene.responses.size());
  n.objectives = static_cast<double>(model.scene.objectives.size());
  const Scheme scheme = scheme_of(input.method);
  n.iterates = scheme.iterates;
  n.truncated = scheme.of_each_augmentation;
  n.follows = !n.condensed && scheme.keeps_tangents;
  n.together = model.effects.plasticity
                   ? 1
                   : std::min(n.steps, std::max(1.0, std::floor(columns_together / std::max(n.parameters, 1.0))));
  return n;
}

/// Of present geometries that a state keeps, one weight each: a rigid master.
template <class T>
double geometry_bytes(const Size& n) {
  return n.present * (sizeof(PointGeometry<T>) + sizeof(T));
}

double multipliers(const Size& n) { return n.unknown ? n.points + n.tangential : 0; }

LedgerRow bodies_row(const Problem& problem, const Size& n, const Amount& matrix) {
  const auto& model = problem.model;
  return {"bodies",
          !model.bodies.empty(),
          {{"displacements", n.free}},
          {{"mesh", mesh_bytes(model)},
           {"slots", static_cast<double>(slot_bytes(problem.slots).bodies)},
           {"matrix", real_bytes * matrix.value, matrix.spread},
           {"states", real_bytes * n.dofs * n.whole, n.path}},
          {{"elements", element_count(model)}},
          not_apart};
}

/// `factor`: bytes of a sparse symmetric factor of the tangent.
void add_contact_rows(const Problem& problem, const Size& n, const Amount& factor, Ledger& ledger) {
  const auto& model = problem.model;
  const auto& effects = model.effects;
  const auto [nodes, bytes] = masters_of(model);
  ledger.push_back(
      {"contact",
       effects.contact,
       {{"normal", n.unknown ? n.points : 0}},
       {{"points", point_bytes(model, problem.slots) - bytes},
        {"states", ((sizeof(ContactState) + 2 * real_bytes) * n.points + geometry_bytes<double>(n)) * n.states,
         n.path * n.moving},
        {"multipliers", real_bytes * n.points * n.states, n.path}},
       {{"points", n.points}, {"evaluations", 0, effects.contact ? not_known : exactly}},
       not_apart});
  const bool spares = n.unsymmetric && !n.condensed;
  ledger.push_back({"friction",
                    effects.friction,
                    {{"tangential", n.unknown ? n.tangential : 0}},
                    {{"history", real_bytes * (2 * n.tangential + n.feet + n.contacts) * n.states, n.path},
                     {"multipliers", 2 * real_bytes * n.tangential * n.states, n.path},
                     {"factor", spares ? factor.value : 0, spares ? factor.spread : exactly}},
                    {{"unsymmetric_factorizations", 0, n.unsymmetric ? not_known : exactly}},
                    not_apart});
  ledger.push_back(
      {"deformable_masters", effects.deformable_master, {}, {{"weights", bytes}}, {{"nodes", nodes}}, not_apart});
  ledger.push_back({"plasticity",
                    effects.plasticity,
                    {},
                    {{"history", real_bytes * model.memory_count * n.whole, n.path}},
                    {{"numbers", static_cast<double>(model.memory_count)}},
                    not_apart});
}

/// Numbers of a dual state of one block, but for the branches.
double state_numbers(const Size& n) {
  return n.dofs + 3 * n.points + 4 * n.tangential + n.feet + n.contacts + n.remembered;
}

/// Back-solves and evaluations of derivatives with `columns` right-hand sides an increment, that are `evaluated` times
/// as many points. A penalty takes one solve; multipliers that are unknown up to two more, where rounding asks for
/// them; a factor that follows the run is brought up to date by others; what Uzawa's schemes take depends on the
/// contraction.
std::vector<Amount> derivative_counts(const Size& n, double columns, double evaluated) {
  const double on = columns > 0 ? 1 : 0;
  const double within = on == 0                                       ? exactly
                        : n.iterates || n.follows || n.path > exactly ? not_known
                        : n.unknown                                   ? 3
                                                                      : exactly;
  const double known = on == 0 || within == not_known ? 0 : n.steps;
  return {{"backsolves", columns * known, within},
          {"body_backsolves", 0, on > 0 && (n.condensed || n.mixed) ? not_known : exactly},
          {"factorizations", 0, on > 0 ? not_known : exactly},
          {"evaluations", evaluated * n.points * known, within}};
}

LedgerRow direct_row(const Problem& problem, const Size& n) {
  const auto& scene = problem.model.scene;
  constexpr double dual = sizeof(Direction);
  const bool on = n.parameters > 0 && scene.sensitivity_mode == SensitivityMode::direct;
  const double p = on ? n.parameters : 0, blocks = on ? n.blocks : 0;
  const double together = n.follows ? 1 : n.together;
  const double within = n.follows ? n.together : exactly;  // the rest of a run with ties is differentiated at its end
  const double engine_rows = n.condensed ? n.contact_dofs : n.dofs;
  const bool ties = std::any_of(scene.responses.begin(), scene.responses.end(), can_tie);
  const double slots = static_cast<double>(slot_bytes<Direction>(problem.slots).all());
  const double state = dual * state_numbers(n) + sizeof(ContactState) * n.points + geometry_bytes<Direction>(n);
  const double eliminated = n.free - n.solved;
  const double inside = eliminated > 0 ? eliminated + n.condensed_dofs : 0;  // of a reduction
  const double solve = blocks * dual * n.dofs + real_bytes * p * (inside + 2 * engine_rows);
  return {"direct_sensitivity",
          on,
          {{"parameters", p}},
          {{"slots", blocks * slots},
           {"stiffness", on ? static_cast<double>(kept_stiffness_bytes(problem.model)) : 0},
           {"states", together * blocks * state, within * n.path * n.moving},
           {"solves", together * solve, within * n.path},
           {"sweeps", 0, on && n.truncated ? not_known : exactly},
           {"derivatives", real_bytes * p * (n.steps * ((ties ? 3 : 1) * n.responses + 2) + n.dofs + n.objectives),
            n.path}},  // (2: the nearest change of a branch, below and above)
          derivative_counts(n, p, 2 * blocks),
          on ? not_apart : 0};
}

LedgerRow adjoint_row(const Problem& problem, const Size& n) {
  const auto& model = problem.model;
  const bool on = n.parameters > 0 && model.scene.sensitivity_mode == SensitivityMode::adjoint;
  const double objectives = on ? n.objectives : 0;
  const bool any = objectives > 0;
  const double state =
      real_bytes * state_numbers(n) + sizeof(ContactState) * n.points + geometry_bytes<double>(n);  // of the solution
  const double again = any ? n.together_again : 0;
  // weights of masters that deform are some more, of each point along a curve
  const double within = again == 0 ? exactly : n.truncated ? not_known : n.present > 0 ? 2 : exactly;
  auto counts = derivative_counts(n, objectives, 1);
  if (any && n.repeated > 0) counts[3] = {"evaluations", 0, not_known};  // (of the steps that are solved again too)
  counts.push_back({"repeated_increments", any ? n.repeated : 0, any && n.repeated > 0 ? 2.0 : exactly});  // 2: ties
  return {"adjoint_sensitivity",
          on,
          {{"objectives", objectives}},
          {{"slots", any ? static_cast<double>(slot_bytes<Reverse>(problem.slots).all()) : 0},
           {"states", again * state, within},
           {"tape", 0, any ? not_known : exactly},
           {"adjoints", 0, any ? not_known : exactly},
           {"sweeps", 0, any && n.truncated ? not_known : exactly},
           {"derivatives", real_bytes * objectives * n.parameters}},
          std::move(counts),
          on ? not_apart : 0};
}

LedgerRow search_row(const Size& n) {
  const double within = n.parameters > 0 ? not_known : exactly;
  return {"one_sided_search",
          n.parameters > 0,
          {},
          {{"derivatives", 0, within}},
          {{"backsolves", 0, within},
           {"body_backsolves", 0, exactly},
           {"factorizations", 0, within},
           {"evaluations", 0, within}},
          n.parameters > 0 ? not_apart : 0};
}

/// Factors of the engine that runs: of the bodies, and of its tangents; bytes.
struct Factors {
  Amount tangent_entries;                             ///< of the sparse matrix
  double point_entries = 0;                           ///< of the blocks of the contact points
  Amount bodies{"bodies_factor"}, tangent{"factor"};  ///< `tangent`: what a symmetric one has
  Amount left{"factor"};                              ///< of the dense system of bodies that are condensed once
  Amount stored{"factor_entries"};
  double dense = 0;           ///< entries of the dense system of tangents that are condensed
  Amount schur{"condensed"};  ///< of the bodies on the contact dofs
};

/// Factor that the bytes of a factor hold to, forecast as entries of CHOLMOD's analysis. Libraries store zeros where
/// they join columns, indices, and room for pivots that move: measured 1.1 to 1.6 times the entries from 1000 rows on.
/// In small matrices they join all they can, and LU stands in for LDL^T: up to 4.9 times.
double of_library(double rows) {
  constexpr double small = 250;
  return rows < small ? 6 : 2.5;
}

Factors condensed_factors(const Model& model, const Size& n) {
  Factors out;
  const double rows = n.solved + multipliers(n);
  // multipliers of open points are left out
  const double within = n.solved > 0 ? std::pow(rows / n.solved, 2) : not_known;
  out.tangent = out.left = {"factor", real_bytes * rows * rows, within};
  if (n.unknown && !factorises_multipliers(model, Multipliers::unknown)) {
    constexpr double of_border = 1.5;
    out.tangent = {"factor", real_bytes * n.solved * n.solved, of_border};
    out.left = {"factor", out.tangent.value, not_known};  // (the fewer points slide, the less is left)
  }
  if (n.free > n.solved) out.bodies = {"bodies_factor", real_bytes * bodies_factor(model).entries, of_library(n.free)};
  out.schur = {"condensed", real_bytes * n.condensed_dofs * n.condensed_dofs};
  return out;
}

/// Bodies whose tangents change, condensed one by one: their own pattern, and a dense system that is smaller, or
/// larger, by the dofs that points touch on the way: measured up to 4.02 times (the pinched tube, closed).
Factors condensed_tangent_factors(const CondensedTangent<double>& tangent, bool unsymmetric) {
  constexpr double of_touched = 5;
  Factors out;
  const double rows = tangent.dense_rows(), kept = tangent.kept();
  const FactorSize size = tangent.factor_size();
  out.tangent_entries = {"", static_cast<double>(tangent.nonzeros())};
  out.dense = rows * rows;
  const double within = std::max(of_touched, of_library(tangent.rows()));
  out.tangent = {"factor", real_bytes * (size.entries + rows * rows) / (unsymmetric ? 2 : 1), within};
  out.stored = {"factor_entries", static_cast<double>(size.entries), within};
  out.schur = {"condensed", 2 * real_bytes * kept * kept, of_touched};  // and what is left of it
  return out;
}

Factors sparse_factors(const Input& input, const Problem& problem, const Size& n) {
  const Model& model = problem.model;
  FullBodies<double> bodies(model, problem.slots);
  if (const auto tangent = n.mixed ? nullptr
                                   : make_condensed_tangent(model, problem.slots, kind_of(input, model),
                                                            input.linear_algebra.engine, bodies))
    return condensed_tangent_factors(*tangent, n.unsymmetric);
  Factors out;
  std::optional<MixedRows> mixed;
  if (n.mixed) mixed.emplace(model);
  const auto lists = tangent_rows(model, multipliers_of(input.method), mixed ? &*mixed : nullptr);
  if (mixed) {
    out.bodies = {"bodies_factor", real_bytes * bodies_factor(model).entries, of_library(n.free)};
    out.schur = {"condensed", real_bytes * n.condensed_dofs * n.condensed_dofs};
  }
  const auto pattern = make_pattern(static_cast<int>(n.solved + multipliers(n)), lists);
  out.tangent_entries = {"", static_cast<double>(pattern->nonzeros()), n.moving};
  for (int k = lists.count() - static_cast<int>(model.points.size()); k < lists.count(); ++k)
    out.point_entries += std::pow(lists.start[k + 1] - lists.start[k], 2);
  out.tangent = {"factor", real_bytes * predict_factor(pattern, 0).entries, of_library(pattern->size) * n.moving};
  out.stored = {"factor_entries", (n.unsymmetric ? 2 : 1) * out.tangent.value / real_bytes, out.tangent.spread};
  return out;
}

LedgerRow condensed_row(const Size& n, const Factors& factors) {
  const bool on = n.condensed || n.mixed || factors.schur.value > 0;
  LedgerRow row{"condensed_engine", on, {{"eliminated", 0}}, {}, {}, n.condensed ? not_apart : 0};
  const double unknown = n.condensed ? not_known : exactly;
  Amount matrix = n.condensed ? factors.tangent : Amount{}, factor = n.condensed ? factors.left : Amount{};
  Amount entries = matrix, stored = factor;
  matrix.name = "matrix", factor.name = "factor", entries.name = "matrix_entries", stored.name = "factor_entries";
  entries.value = matrix.value / real_bytes;
  stored.value = factor.value / real_bytes;
  row.unknowns[0].value = n.free - n.solved;
  row.memory = {
      factors.schur, on ? factors.bodies : Amount{"bodies_factor"}, matrix, factor, {"iterations", 0, unknown}};
  row.counts = {{"body_backsolves", 0, on ? not_known : exactly},
                entries,
                stored,
                {"analyses", n.condensed && factors.bodies.value > 0 ? 1.0 : 0.0},
                {"factorizations", 0, unknown},
                {"backsolves", 0, unknown},
                {"iterations", 0, unknown},
                {"augmentations", 0, n.iterates ? unknown : exactly}};
  return row;
}

LedgerRow sparse_row(const Size& n, const Factors& factors) {
  const bool on = !n.condensed;
  const double unknown = on ? not_known : exactly, rows = n.solved + multipliers(n);
  const double entries = factors.tangent_entries.value;
  const double integers = on ? entries + rows + 1 + factors.point_entries : 0;
  const double within = factors.dense > 0 ? factors.schur.spread : n.moving;
  return {"sparse_engine",
          on,
          {},
          {{"matrix", real_bytes * (entries + factors.dense) + sizeof(int) * integers, within},
           on ? factors.tangent : Amount{"factor"},
           {"iterations", 0, unknown}},
          {{"matrix_entries", entries, factors.tangent_entries.spread},
           factors.stored,
           {"analyses",
            !on       ? 0.0
            : n.mixed ? 2.0
                      : 1.0,
            on && n.moving > exactly ? not_known : exactly},
           {"factorizations", 0, unknown},
           {"backsolves", 0, unknown},
           {"iterations", 0, unknown},
           {"augmentations", 0, n.iterates ? unknown : exactly}},
          on ? not_apart : 0};
}

/// Steps whose fields are written (Input::fields_every); of several, the start too.
double field_steps(int every, double steps) { return every == 0 ? std::min(steps, 1.0) : std::ceil(steps / every) + 1; }

/// Bytes of solution.json: of a step its displacements and tractions, in some 20 digits, signs and commas each; of the
/// mesh coordinates, and the nodes of the elements. 0 where it is left out.
double solution_bytes(const Model& model, double connectivity, double steps) {
  constexpr double digits = 20, of_integers = 7;
  const double tractions = static_cast<double>(model.points.size()) * (digits * model.dimension + of_integers);
  const double bytes =
      steps * (digits * model.dof_count() + tractions) + digits * model.dof_count() + of_integers * connectivity + 2000;
  return bytes > static_cast<double>(largest_solution) ? 0 : bytes;
}

LedgerRow files_row(const Input& input, const Model& model, const Size& n) {
  // Base 64 of doubles and integers: of a node its place, displacement and fields of contact (of all contacts, and of
  // each where some share nodes), of an element its nodes, place, kind, body and stresses, at the last step
  // derivatives. Names and folds take a few kilobytes a file.
  constexpr double base64 = 4.0 / 3, head = 3000, within = 2;
  const double files = field_steps(input.fields_every, n.steps);
  const double of_contact = model.effects.current_geometry ? 10 : 6;
  const double sets = !model.effects.contact        ? 0
                      : contacts_share_nodes(model) ? 1 + static_cast<double>(model.scene.contacts.size())
                                                    : 1;
  double connectivity = 0;
  for (const auto& body : model.bodies) connectivity += static_cast<double>(body.mesh.connectivity.size());
  const double numbers = (6 + of_contact * sets) * model.node_count + connectivity + 10 * element_count(model);
  const bool of_obstacles = input.fields_every > 0 && !model.scene.obstacles.empty() &&
                            model.dimension == 2;  // some kilobytes each, beside those of the bodies
  const double bytes = files * ((of_obstacles ? 2 : 1) * head + base64 * real_bytes * numbers) +
                       base64 * real_bytes * 3 * n.parameters * model.node_count;
  const double solution = n.whole < n.states ? 0 : solution_bytes(model, connectivity, n.steps);  // (states let go)
  return {
      "output",
      true,
      {},
      {{"fields", bytes, within * n.path}, {"solution", solution, within * n.path}, {"picture", 0}, {"trace", 0}},
      {{"files", (of_obstacles ? 2 : 1) * files + (solution > 0 ? 2 : 1), input.fields_every == 0 ? exactly : n.path}},
      not_apart};
}

}  // namespace

Ledger forecast(const Input& input, const Problem& problem) {
  const Model& model = problem.model;
  const Size n = size_of(input, model);
  const Factors factors = n.condensed ? condensed_factors(model, n) : sparse_factors(input, problem, n);
  Ledger ledger{bodies_row(problem, n, factors.tangent_entries)};
  add_contact_rows(problem, n, factors.tangent, ledger);
  ledger.push_back(direct_row(problem, n));
  ledger.push_back(adjoint_row(problem, n));
  ledger.push_back(search_row(n));
  ledger.push_back(condensed_row(n, factors));
  ledger.push_back(sparse_row(n, factors));
  ledger.push_back(files_row(input, model, n));
  return ledger;
}

}  // namespace stickslip
