#include "studies/run/locking_warnings.hpp"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <set>

#include "studies/run/strains.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

/// Poisson's ratio from which locking is looked for, and spurious pressure that is worth a warning.
constexpr double nearly_incompressible = 0.45, most_spurious = 0.2;

/// Elements whose pressure locks where the material hardly changes its volume.
bool may_lock(const Problem& problem, std::size_t b) {
  const auto& body = problem.model.bodies[b];
  const ElementShape shape = body.mesh.shape;
  return problem.model.scene.space != Space::plane_stress && !has_mean_dilatation(body.kinematics) &&
         (shape == ElementShape::quad4 || shape == ElementShape::tri3 || (is_solid(shape) && !is_quadratic(shape)));
}

/// An element that may lock, by its name, and what to take in its place.
struct Locking {
  const char *element, *remedy;
};
Locking locking_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::quad4:
      return {"Q4", "element Q4_mean_dilatation or Q8"};
    case ElementShape::tri3:
      return {"T3", "element T6"};
    case ElementShape::hex8:
      return {"H8", "element H8_mean_dilatation"};
    default:
      return {"T4", "element H8_mean_dilatation or T10"};
  }
}

/// What a body of small strain resists: of linear elasticity, or of a metal, whose flow keeps the volume.
struct Moduli {
  double lame, shear;
  bool flows;
  double nu() const { return lame / (2 * (lame + shear)); }
};

std::optional<Moduli> moduli_of(const Law<double>& law) {
  if (const auto* elastic = std::get_if<LinearElasticLaw<double>>(&law))
    return Moduli{elastic->lame, elastic->shear, false};
  if (const auto* metal = std::get_if<J2Law<double>>(&law); metal && !metal->is_finite)
    return Moduli{metal->lame, metal->shear, true};
  return std::nullopt;
}

/// Whether locking is looked for in a body.
bool is_watched_for_locking(const Problem& problem, std::size_t b) {
  const auto moduli = moduli_of(problem.slots.laws[b].law);
  return moduli && may_lock(problem, b) && (moduli->flows || moduli->nu() >= nearly_incompressible);
}

/// Per element the mean over its nodes of the mean over the elements at each. `sum`: a quantity times volume, by
/// element.
template <class Quantity>
std::vector<Quantity> means_around(const Mesh& mesh, const std::vector<double>& volume,
                                   const std::vector<Quantity>& sum, const Quantity& zero) {
  const int nodes = nodes_of(mesh.shape);
  std::vector<double> nodal_volume(mesh.node_count, 0);
  std::vector<Quantity> nodal(mesh.node_count, zero), around(sum.size(), zero);
  const auto for_each_corner = [&](auto&& f) {
    for (int e = 0; e < mesh.element_count(); ++e)
      for (int a = 0; a < nodes; ++a) f(e, mesh.connectivity[e * nodes + a]);
  };
  for_each_corner([&](int e, int node) {
    nodal_volume[node] += volume[e];
    nodal[node] += sum[e];
  });
  for_each_corner([&](int e, int node) { around[e] += nodal[node] / (nodal_volume[node] * nodes); });
  return around;
}

void add_locking(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& problem = *result.problem;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    if (!is_watched_for_locking(problem, b)) continue;
    const auto moduli = moduli_of(problem.slots.laws[b].law);
    double largest = 0;
    for (const auto& step : solved_steps(result))
      largest = larger(largest, step.bodies.empty() ? spurious_pressure(problem, step.increment->state, b)
                                                    : step.bodies[b].spurious_pressure);
    if (!(largest > most_spurious)) continue;
    const std::string& name = problem.model.scene.bodies[b].name;
    const auto [element, remedy] = locking_of(problem.model.bodies[b].mesh.shape);
    warnings.push_back(
        {WarningCode::locking, name, largest, remedy,
         fmt::format("{} locks: {} in {} elements, and {:.2g} of its stress is a pressure "
                     "that alternates from element to element",
                     name, moduli->flows ? "plastic flow keeps the volume" : fmt::format("nu = {:.6g}", moduli->nu()),
                     element, largest)});
  }
}

/// Nodes at the ends of an element's edge on the boundary of its body.
using BoundaryEdges = std::map<int, std::pair<int, int>>;  // by element

/// Per element with an edge on the boundary: one of these. Empty where some node is inside of the body: then it is more
/// than one element thick.
BoundaryEdges edges_of_thin_body(const Mesh& mesh) {
  const int nodes = nodes_of(mesh.shape);
  std::map<std::pair<int, int>, int> edges;  // as the elements have them; an inner one in both directions
  for (int e = 0; e < mesh.element_count(); ++e)
    for (int k = 0; k < nodes; ++k)
      edges[{mesh.connectivity[e * nodes + k], mesh.connectivity[e * nodes + (k + 1) % nodes]}] = e;
  BoundaryEdges found;
  std::set<int> on_boundary;
  for (const auto& [edge, element] : edges) {
    if (edges.count({edge.second, edge.first}) > 0) continue;
    found.emplace(element, edge);
    on_boundary.insert({edge.first, edge.second});
  }
  return static_cast<int>(on_boundary.size()) == mesh.node_count ? found : BoundaryEdges{};
}

bool may_lock_in_shear(const Problem& problem, std::size_t b) {
  const ElementShape shape = problem.model.bodies[b].mesh.shape;
  return shape == ElementShape::quad4 || shape == ElementShape::tri3;
}

void add_shear_locking(const CaseResult& result, std::vector<Warning>& warnings) {
  constexpr double most = 0.2;  // squares, of which bending is more than half of the squared strain
  const auto& problem = *result.problem;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    if (!may_lock_in_shear(problem, b) || edges_of_thin_body(problem.model.bodies[b].mesh).empty()) continue;
    double largest = 0;
    for (const auto& step : solved_steps(result))
      largest = larger(largest, step.bodies.empty() ? parasitic_shear(problem, step.increment->state, b)
                                                    : step.bodies[b].parasitic_shear);
    if (!(largest > most)) continue;
    const std::string& name = problem.model.scene.bodies[b].name;
    const bool quads = problem.model.bodies[b].mesh.shape == ElementShape::quad4;
    warnings.push_back({WarningCode::shear_locking, name, largest,
                        quads ? "element Q8, or more elements through its thickness"
                              : "element T6, or more elements through its thickness",
                        fmt::format("{} bends, and is one {} thick: {:.2g} of its squared strain is a shear that "
                                    "bending has not, so that it is too stiff",
                                    name, quads ? "Q4" : "T3", largest)});
  }
}

}  // namespace

void add_locking_warnings(const CaseResult& result, std::vector<Warning>& warnings) {
  add_locking(result, warnings);
  add_shear_locking(result, warnings);
}

double spurious_pressure(const Problem& problem, const State<double>& state, std::size_t b) {
  const auto& law = problem.slots.laws[b].law;
  const auto moduli = moduli_of(law);
  if (!moduli || !may_lock(problem, b)) return 0;
  const auto& mesh = problem.model.bodies[b].mesh;
  std::vector<double> volume(mesh.element_count(), 0), change = volume;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    volume[e] += v;
    change[e] += v * H.full().trace();
  });
  const auto around = means_around(mesh, volume, change, 0.0);
  const double bulk = moduli->lame + 2 * moduli->shear / 3;
  double spurious = 0, all = 0;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double* memory) {
    const auto [xx, yy, zz, xy, yz, xz] = stress_of(law, H, memory);
    spurious += v * std::pow(bulk * (H.full().trace() - around[e]), 2);
    all += v * (xx * xx + yy * yy + zz * zz + 2 * (xy * xy + yz * yz + xz * xz));
  });
  return all > 0 ? std::sqrt(spurious / all) : 0;
}

double watched_pressure(const Problem& problem, const State<double>& state, std::size_t b) {
  return is_watched_for_locking(problem, b) ? spurious_pressure(problem, state, b) : 0;
}

double parasitic_shear(const Problem& problem, const State<double>& state, std::size_t b) {
  const auto& body = problem.model.bodies[b];
  const auto& mesh = body.mesh;
  if (!may_lock_in_shear(problem, b)) return 0;
  const auto edges = edges_of_thin_body(mesh);
  if (edges.empty()) return 0;
  using Strain = Mat<double, 2>;  // in the plane; Green's at finite strain
  const auto strain_of = [&](const auto& H) {
    const Strain h = H.full().template topLeftCorner<2, 2>();
    Strain strain = (h + h.transpose()) / 2;
    if (problem.model.scene.finite_strain) strain += h.transpose() * h / 2;
    return strain;
  };
  std::vector<double> volume(mesh.element_count(), 0);
  std::vector<Strain> sum(mesh.element_count(), Strain::Zero());
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    volume[e] += v;
    sum[e] += v * strain_of(H);
  });
  const auto around = means_around<Strain>(mesh, volume, sum, Strain::Zero());
  double shear = 0, all = 0;
  for_each_strain(problem, state, b, [&](int e, const auto& H, double v, const double*) {
    const Strain strain = strain_of(H);
    all += v * strain.squaredNorm();
    const auto edge = edges.find(e);
    if (edge == edges.end()) return;
    const auto [from, to] = edge->second;
    const Vec<double, 2> along =
        (problem.slots.points.col(body.first_node + to) - problem.slots.points.col(body.first_node + from))
            .template head<2>()
            .normalized();
    const double varying = along.dot((strain - around[e]) * Vec<double, 2>(-along[1], along[0]));
    shear += 2 * v * varying * varying;
  });
  return all > 0 ? shear / all : 0;
}

}  // namespace stickslip
