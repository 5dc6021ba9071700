#include "studies/run/contact_warnings.hpp"

#include <fmt/core.h>

#include "core/contact/surface_search.hpp"
#include "core/model/contact_assembly.hpp"
#include "core/model/master_surface.hpp"
#include "core/model/pairing.hpp"
#include "core/model/response.hpp"
#include "core/model/stencil.hpp"
#include "methods/newton/residuals.hpp"
#include "studies/run/side_curve.hpp"
#include "studies/run/turned_surfaces.hpp"
#include "studies/run/warnings.hpp"

namespace stickslip {
namespace {

std::string in_words(const PlanePlace& x) { return fmt::format("({:.6g}, {:.6g})", x[0], x[1]); }

/// Calls f(vertex, place on the curve, normal out of the solid, of any length) for each vertex of a curve; on a
/// B-spline for the places that belong to them.
template <class F>
void for_each_vertex(const SideCurve& curve, F&& f) {
  const auto at = [&](int patch, double xi) {
    const auto w = detail::patch_weights<double>(curve.patches[patch], xi);
    const PlanePlace slope = detail::on_patch<double>(curve.patches[patch], w.slope, curve.position());
    return std::pair<PlanePlace, PlanePlace>{detail::on_patch<double>(curve.patches[patch], w.value, curve.position()),
                                             PlanePlace(slope[1], -slope[0]).normalized()};
  };
  for (int p = 0; p < static_cast<int>(curve.patches.size()); ++p) {
    const Patch<2>& patch = curve.patches[p];
    auto [place, normal] = at(p, 0);
    if (patch.across[0] != no_patch) normal += at(patch.across[0], 1).second;
    f(patch.corner(0), place, normal);
    if (patch.across[1] != no_patch) continue;
    const auto [end, out] = at(p, 1);
    f(patch.corner(1), end, out);
  }
}

/// Positions of the nodes at a state.
Points<double> positions_of(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  return problem.slots.points +
         Eigen::Map<const Matrix<double>>(state.displacement.data(), model.dimension, model.node_count);
}

/// Whether a contact looks from its slave's nodes alone at a master that has nodes, or vertices, of its own.
bool may_overlook_master(const Model& model, int c) {
  const Contact& contact = model.scene.contacts[c];
  const Obstacle* const obstacle = obstacle_of(model, c);
  return model.dimension == 2 && !contact.segment && !contact.is_of_itself() &&
         (!obstacle || has_facets(obstacle->shape));
}

/// Normal force of a contact, positive in compression, and the largest penetration of its points.
struct Press {
  double force, penetration;
};

Press press_and_penetration(const Problem& problem, const ContactField<double>& field, int c) {
  double force = 0, penetration = 0;
  for (std::size_t p = 0; p < problem.model.points.size(); ++p) {
    const auto& point = problem.model.points[p];
    if (point.contact != c) continue;
    force -= area_in(field, problem.slots, p) * field.traction[point.multiplier];
    if (field.state[p] != ContactState::open) penetration = std::max(penetration, -field.gap[p]);
  }
  return {force, penetration};
}

/// Looks for the node of the master that is deepest in the slave, deeper than the slave's own points are in the master.
void find_master_inside(const Problem& problem, const State<double>& state, double time, int c,
                        ContactMeasures& measures) {
  const auto& [model, slots, unused] = problem;
  const auto& contact = model.scene.contacts[c];
  const auto& sides = model.contact_sides[c];
  const Points<double> points = positions_of(problem, state);
  const Obstacle* const obstacle = obstacle_of(model, c);
  const SideCurve slave = curve_of_side(surface_of(model, slots.points, sides.slave), points, contact, false);
  if (slave.patches.empty()) return;
  const SideCurve master = obstacle
                               ? curve_of_obstacle(problem, *obstacle, contact, time)
                               : curve_of_side(surface_of(model, slots.points, sides.master), points, contact, true);
  const auto press = press_and_penetration(problem, state.contact, c);
  double stiffness = 0;
  int count = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p)
    if (model.points[p].contact == c) {
      stiffness += slots.stiffness[p];
      ++count;
    }
  stiffness = count > 0 ? stiffness / count : 0;
  const double reach = largest_nodal_norm(state.displacement, model.dimension);
  // of what moves, and of coordinates: less is what a solution leaves
  const double nothing = 1e-6 * reach + 8 * unit_roundoff * points.cwiseAbs().maxCoeff();
  const SurfaceSearch<2> search(slave.patches, slave.places);
  for_each_vertex(master, [&, &slots = slots](int, const PlanePlace& x, const PlanePlace& outward) {
    const Facing facing = search.facing({x, outward});
    if (facing.patch == no_patch) return;
    const double depth = -slave.gap(facing, x) - slots.numbers(contact.offset) - press.penetration;
    if (!(depth > nothing) || depth <= measures.inside) return;
    measures.inside = depth;
    measures.at = {x[0], x[1]};
    measures.missing = press.force > 0 ? stiffness * depth / press.force : std::numeric_limits<double>::infinity();
  });
}

/// Forces of a contact on both sides have this moment; each balances the other in force.
double unbalanced_moment(const Problem& problem, const State<double>& state, int c) {
  const auto& [model, slots, unused] = problem;
  double moment = 0;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.contact != c || state.contact.state[p] == ContactState::open) continue;
    const auto& geometry = geometry_in(state.contact, slots, p);
    PlanePlace force = state.contact.traction[point.multiplier] * PlanePlace(geometry.normal[0], geometry.normal[1]);
    for (int a = 0; a < point.tangents; ++a)
      force += state.contact.traction[point.multiplier + 1 + a] * PlanePlace(geometry.tangents.col(a));
    for_each_place(model, state.contact, p, [&, &model = model, &slots = slots](std::size_t n, int place) {
      const auto x = detail::place_of(model, slots, state, model.contact_nodes[place]);
      moment -= geometry.area * geometry.weights[static_cast<Eigen::Index>(n)] * (x[0] * force[1] - x[1] * force[0]);
    });
  }
  return moment;
}

bool is_moment(const Response& response) { return response.component == Response::Component::moment; }

bool asks_for_moments(const Scene& scene) {
  return std::any_of(scene.responses.begin(), scene.responses.end(), is_moment);
}

/// The measures of a step, read while its state was whole where that was let go.
ContactMeasures measures_at(const CaseResult& result, const StepResult& step, int c) {
  if (!step.contacts.empty()) return step.contacts[c];
  return measures_of_contact(*result.problem, step.increment->state, step.increment->time, c);
}

void add_masters_inside(const CaseResult& result, int c, std::vector<Warning>& warnings) {
  constexpr double missed = 0.1;  // force that the overlap stands for, of the force of the contact
  const auto& model = result.problem->model;
  const auto& contact = model.scene.contacts[c];
  if (!may_overlook_master(model, c)) return;
  const auto slides_far = [&](const Warning& warning) {
    return warning.code == WarningCode::large_sliding && warning.where == contact.name;
  };
  if (std::any_of(warnings.begin(), warnings.end(), slides_far)) return;  // (present places mean nothing then)
  ContactMeasures worst;
  double time = 0;
  for (const auto& step : solved_steps(result)) {
    const auto now = measures_at(result, step, c);
    if (!(now.missing > missed) || now.inside <= worst.inside) continue;
    worst = now;
    time = step.increment->time;
  }
  if (!(worst.inside > 0)) return;
  const bool rigid = obstacle_of(model, c) != nullptr;
  warnings.push_back(
      {WarningCode::master_inside, contact.name, worst.inside,
       rigid ? R"(refine the slave's mesh, or integrate over segments ("discretization": "segment"))"
             : R"(take the other side as the slave, or integrate over segments ("discretization": "segment"))",
       fmt::format("{}: at t = {:.6g} a {} of {}, at {}, is inside of {} by {:.3g}: no slave node is near enough to "
                   "hold it off",
                   contact.name, time, rigid ? "vertex" : "node", contact.master, in_words({worst.at[0], worst.at[1]}),
                   contact.slave, worst.inside)});
}

/// The facets of a deformable master that point p faces, by their nodes.
std::vector<std::array<int, 2>> faced_facets(const Model& model, const ContactField<double>& field, std::size_t p) {
  const auto& point = model.points[p];
  if (point.obstacle >= 0) return {};
  if (!point.segments.empty()) {
    std::vector<std::array<int, 2>> facets;
    const bool along_curve = point.surface >= 0 && !field.facing.empty();
    for (const auto& piece : along_curve ? field.facing[p].pieces : point.segments) facets.push_back(piece.master);
    return facets;
  }
  if (point.surface >= 0) {
    const int patch = field.facing.empty() ? point.facing.patch : field.facing[p].patch;
    if (patch == no_patch) return {};
    const auto& curve = model.surfaces[point.surface];
    const auto& of = curve.patches<2>()[patch];
    return {{curve.nodes[of.corner(0)], curve.nodes[of.corner(1)]}};
  }
  std::vector<std::array<int, 2>> facets;
  for (std::size_t k = 1; k < point.corners.size(); ++k) facets.push_back({point.corners[k - 1], point.corners[k]});
  return facets;
}

/// A contact where it is pressed hardest: how wide its pressed points are apart, and the facets that they are on.
struct Width {
  double force = 0, extent = 0, master_facet = 0;
  int pressed = 0, points = 0;
  double largest_share = 0;  ///< of one point in the force
};

Width width_of(const Problem& problem, const ContactField<double>& field, int c) {
  const auto& [model, slots, unused] = problem;
  const auto place = [&slots = slots](int node) -> PlanePlace { return slots.points.col(node).head<2>(); };
  Width width;
  PlanePlace low, high;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.contact != c) continue;
    ++width.points;
    const double force = -area_in(field, slots, p) * field.traction[point.multiplier];
    if (!(force > 0)) continue;
    const PlanePlace x = place(point.nodes[0]);
    low = width.pressed == 0 ? x : PlanePlace(low.cwiseMin(x));
    high = width.pressed == 0 ? x : PlanePlace(high.cwiseMax(x));
    ++width.pressed;
    width.force += force;
    width.largest_share = std::max(width.largest_share, force);
    for (const auto& [a, b] : faced_facets(model, field, p))
      width.master_facet = std::max(width.master_facet, (place(a) - place(b)).norm());
  }
  if (width.pressed > 0) width.extent = (high - low).norm();
  if (width.force > 0) width.largest_share /= width.force;
  return width;
}

void add_narrow_contact(const CaseResult& result, int c, std::vector<Warning>& warnings) {
  constexpr double rounding = 1e-9;  // of a facet: sides that are as wide as one
  const auto& model = result.problem->model;
  const auto& contact = model.scene.contacts[c];
  if (model.dimension != 2) return;
  const auto first =
      std::find_if(model.points.begin(), model.points.end(), [&](const auto& p) { return p.contact == c; });
  if (first == model.points.end() || !is_continuum(model.bodies[first->slave_body].mesh.shape)) return;
  Width hardest;
  for (const auto& step : solved_steps(result))
    if (const Width now = width_of(*result.problem, step.increment->state.contact, c); now.force > hardest.force)
      hardest = now;
  if (hardest.pressed < 2) return;  // one node alone: single_node
  const double of_master = hardest.master_facet > 0 ? hardest.extent / hardest.master_facet : 1;
  if (of_master < 1 - rounding)
    warnings.push_back(
        {WarningCode::narrow_contact, contact.name, of_master, "refine the master's mesh towards the contact",
         fmt::format("{}: what presses is {:.2g} of a facet of the master {} wide; its stiffness there is that of the "
                     "mesh",
                     contact.name, of_master, contact.master)});
  else if (hardest.pressed == 2 && hardest.points > 2)
    warnings.push_back({WarningCode::narrow_contact, contact.name, 1.0, "refine the slave's mesh towards the contact",
                        fmt::format("{}: two of {} nodes carry the force: the contact is one facet of the slave wide, "
                                    "and its pressure and half width depend on the mesh",
                                    contact.name, hardest.points)});
}

void add_nodes_without_area(const Problem& problem, int c, std::vector<Warning>& warnings) {
  const auto& [model, slots, unused] = problem;
  const auto& contact = model.scene.contacts[c];
  const auto nodes = nodes_without_area(model, slots.points, c);
  if (nodes.empty()) return;
  std::string places;
  for (int node : nodes)
    places += (places.empty() ? "" : ", ") + in_words(PlanePlace(slots.points.col(node).head<2>()));
  warnings.push_back({WarningCode::no_area, contact.name, static_cast<double>(nodes.size()),
                      "read the pressure at a neighbour, or take linear elements (Q4, T3)",
                      fmt::format("{}: the {} of {} at {} on the axis of revolution, where quadratic elements have no "
                                  "area, {} no contact of {} own, and may overlap a little",
                                  contact.name, nodes.size() == 1 ? "node" : "nodes", contact.slave, places,
                                  nodes.size() == 1 ? "has" : "have", nodes.size() == 1 ? "its" : "their")});
}

bool touches(const CaseResult& result, int c) {
  const auto& points = result.problem->model.points;
  const auto steps = solved_steps(result);
  return std::any_of(steps.begin(), steps.end(), [&](const StepResult& step) {
    const auto& states = step.increment->state.contact.state;
    for (std::size_t p = 0; p < points.size(); ++p)
      if (points[p].contact == c && states[p] != ContactState::open) return true;
    return false;
  });
}

}  // namespace

ContactMeasures measures_of_contact(const Problem& problem, const State<double>& state, double time, int contact) {
  ContactMeasures measures;
  const auto& model = problem.model;
  if (may_overlook_master(model, contact)) find_master_inside(problem, state, time, contact, measures);
  if (asks_for_moments(model.scene) && !obstacle_of(model, contact))
    measures.moment = unbalanced_moment(problem, state, contact);
  return measures;
}

void add_contact_warnings(const CaseResult& result, std::vector<Warning>& warnings) {
  const auto& problem = *result.problem;
  const auto& scene = problem.model.scene;
  for (int c = 0; c < static_cast<int>(scene.contacts.size()); ++c) {
    add_narrow_contact(result, c, warnings);
    add_masters_inside(result, c, warnings);
    if (auto warning = turned_surface(problem, c)) warnings.push_back(std::move(*warning));
    if (touches(result, c)) add_nodes_without_area(problem, c, warnings);
  }
  for (std::size_t i = 0; i < scene.responses.size(); ++i) {
    constexpr double noted = 0.01;  // of the largest value of the response
    if (!is_moment(scene.responses[i])) continue;
    double largest = 0, off = 0;
    int of = -1;
    for (const auto& step : solved_steps(result)) {
      largest = std::max(largest, std::abs(step.responses[static_cast<Eigen::Index>(i)]));
      for (int c = 0; c < static_cast<int>(scene.contacts.size()); ++c)
        if (const double now = std::abs(measures_at(result, step, c).moment); now > off) {
          off = now;
          of = c;
        }
    }
    if (of < 0 || !(off > noted * largest)) continue;
    const auto& contact = scene.contacts[of];
    warnings.push_back({WarningCode::unbalanced_moment, contact.name, off / largest,
                        contact.segment ? "refine both sides" : "take a stiffer penalty, or multipliers",
                        fmt::format("{}: the moments of its forces on both sides differ by {:.3g}, {:.2g} % of the "
                                    "response {}: forces act where the sides are, which is not one place",
                                    contact.name, off, 100 * off / largest, scene.responses[i].name)});
    break;  // all moments read the same forces
  }
}

std::vector<Warning> contact_warnings_before(const Problem& problem) {
  std::vector<Warning> warnings;
  for (int c = 0; c < static_cast<int>(problem.model.scene.contacts.size()); ++c) {
    if (auto warning = turned_surface(problem, c)) warnings.push_back(std::move(*warning));
    add_nodes_without_area(problem, c, warnings);
  }
  return warnings;
}

}  // namespace stickslip
