#include "studies/run/fields.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/element_nodes.hpp"
#include "core/model/loading.hpp"
#include "core/model/placed_point.hpp"
#include "core/model/stencil.hpp"
#include "studies/io/vtu.hpp"
#include "studies/run/contact_points.hpp"
#include "studies/run/element_fields.hpp"
#include "studies/run/obstacle_fields.hpp"

namespace stickslip {
namespace {

/// Fields of contact over the nodes, of one contact or of several together. The gap is no number where a node faces
/// nothing.
/// Nominal tractions, per area of the start; at finite strain `current` has those per present area too.
struct ContactFields {
  Matrix<double> state, pressure, traction, gap;
  struct Current {
    Matrix<double> pressure, traction;
  };
  std::optional<Current> current;

  explicit ContactFields(const Model& model)
      : state(Matrix<double>::Constant(1, model.node_count, -1)),
        pressure(Matrix<double>::Zero(1, model.node_count)),
        traction(Matrix<double>::Zero(model.dimension, model.node_count)),
        gap(Matrix<double>::Constant(1, model.node_count, std::numeric_limits<double>::quiet_NaN())) {
    if (model.effects.current_geometry) current = {pressure, traction};
  }

  /// Adds what contact point p does to its slave node. Of several: the state that holds most, the sum of the pressures
  /// and of the tractions, the smallest gap.
  void add(const Problem& problem, const State<double>& of, int p, const std::vector<double>& present_areas) {
    const auto& point = problem.model.points[p];
    const int node = point.nodes[0];
    const auto hold = [](double code) { return code == 1 ? 2 : code == 2 ? 1 : code; };  // open < slip < stick
    const double code = state_code(of.contact.state[p]);
    if (faces_master(point, facing_in(problem.model, of.contact, p)) && !(gap(0, node) <= of.contact.gap[p]))
      gap(0, node) = of.contact.gap[p];
    if (hold(code) > hold(state(0, node))) state(0, node) = code;
    pressure(0, node) -= of.contact.traction[point.multiplier];
    traction.col(node) += traction_vector(problem, of, p);
    if (!current) return;
    const double stretch = present_areas[p] / problem.slots.geometry[p].area;
    current->pressure(0, node) -= of.contact.traction[point.multiplier] / stretch;
    current->traction.col(node) += traction_vector(problem, of, p) / stretch;
  }

  void append_to(VtuData& data, const std::string& ending) const {
    data.point_fields.push_back({"contact_state" + ending, state});
    data.point_fields.push_back({"contact_pressure" + ending, pressure});
    data.point_fields.push_back({"contact_traction" + ending, traction});
    data.point_fields.push_back({"gap" + ending, gap});
    if (!current) return;
    data.point_fields.push_back({"contact_pressure_current" + ending, current->pressure});
    data.point_fields.push_back({"contact_traction_current" + ending, current->traction});
  }
};

/// Mean stretch of the thickness of the elements around each node.
std::vector<double> nodal_thickness(const Problem& problem, const State<double>& state) {
  const Matrix<double> of_element = element_thickness(problem, state);
  std::vector<double> sums(problem.model.node_count, 0), counts(sums);
  Eigen::Index element = 0;
  for (const auto& body : problem.model.bodies)
    for (int e = 0; e < body.mesh.element_count(); ++e, ++element)
      for (int node : detail::element_nodes(body, e)) {
        sums[node] += of_element(0, element);
        ++counts[node];
      }
  for (std::size_t n = 0; n < sums.size(); ++n) sums[n] = counts[n] > 0 ? sums[n] / counts[n] : 1;
  return sums;
}

/// Tributary areas of the points where they are now; empty where geometry stays that of the start.
std::vector<double> present_areas(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  std::vector<double> areas;
  if (!model.effects.current_geometry) return areas;
  Slots<double> moved = problem.slots;
  moved.points += nodal(model, state.displacement);
  const auto thickness = thins(model) ? nodal_thickness(problem, state) : std::vector<double>();
  for (const auto& point : model.points) {
    areas.push_back(detail::whole_area(point, moved));
    if (!thickness.empty()) areas.back() *= thickness[point.nodes[0]];
  }
  return areas;
}

void append_contact_fields(VtuData& data, const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  const int count = static_cast<int>(model.points.size());
  const auto areas = present_areas(problem, state);
  ContactFields together(model);
  for (int p = 0; p < count; ++p) together.add(problem, state, p, areas);
  together.append_to(data, "");
  Vector<double> forces = Vector<double>::Zero(model.dof_count());  // on both sides
  add_compact(model, Vector<double>(-contact_forces(model, problem.slots, state.contact)), forces);
  data.point_fields.push_back({"contact_force", nodal(model, forces)});
  if (!contacts_share_nodes(model)) return;
  for (std::size_t c = 0; c < model.scene.contacts.size(); ++c) {
    ContactFields alone(model);
    for (int p = 0; p < count; ++p)
      if (model.points[p].contact == static_cast<int>(c)) alone.add(problem, state, p, areas);
    alone.append_to(data, "_" + model.scene.contacts[c].name);
  }
}

VtuData fields_of(const CaseResult& result, const State<double>& state, double time, bool last) {
  const auto& problem = *result.problem;
  const auto& model = problem.model;
  VtuData data;
  data.time = time;
  data.points.resize(model.dimension, 0);
  Matrix<double> body_index(1, 0);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& body = model.bodies[b];
    append_mesh(data, body.mesh, problem.slots.points.middleCols(body.first_node, body.mesh.node_count));
    body_index.conservativeResize(1, static_cast<Eigen::Index>(data.cells.size()));
    body_index.rightCols(body.mesh.element_count()).setConstant(static_cast<double>(b));
  }
  data.point_fields.push_back({"displacement", nodal(model, state.displacement)});
  if (model.effects.contact) append_contact_fields(data, problem, state);
  const auto& derivative = result.gradients.last_displacement;
  if (last && derivative.size() > 0)
    for (std::size_t j = 0; j < model.scene.parameters.size(); ++j)
      data.point_fields.push_back(
          {"d_displacement_d_" + model.scene.parameters[j].name, nodal(model, derivative.col(j))});
  data.cell_fields.push_back({"body", body_index});
  const Matrix<double> stress = element_stress(problem, state);
  Matrix<double> mises(1, stress.cols());
  for (Eigen::Index e = 0; e < stress.cols(); ++e) mises(0, e) = von_mises(stress.col(e));
  data.cell_fields.push_back({"stress", stress});
  data.cell_fields.push_back({"von_mises", mises});
  if (thins(model)) data.cell_fields.push_back({"thickness_stretch", element_thickness(problem, state)});
  if (model.effects.plasticity) data.cell_fields.push_back({"plastic_strain", element_plastic_strain(problem, state)});
  return data;
}

/// Every `every`-th solved step and the last of them; 0: the last alone.
std::vector<std::size_t> steps_with_fields(const CaseResult& result, int every) {
  std::vector<std::size_t> steps;
  const std::size_t count = solved_steps(result).size();
  for (std::size_t n = 0; n < count; ++n)
    if (n + 1 == count || (every > 0 && (n + 1) % every == 0)) steps.push_back(n);
  return steps;
}

/// Of a step, from 1 on; 0: of the start.
std::string field_file(std::size_t number) { return fmt::format("fields_{:04}.vtu", number); }
std::string obstacle_file(std::size_t number) { return fmt::format("obstacles_{:04}.vtu", number); }

/// Whether the obstacles are written beside the fields: of several moments.
bool has_obstacle_files(const CaseResult& result, int every) {
  return every > 0 && has_obstacle_fields(result.problem->model);
}

}  // namespace

std::vector<Moment> kept_moments(const CaseResult& result, int every) {
  std::vector<Moment> out;
  if (every > 0 && !solved_steps(result).empty()) out.push_back({0, 0, result.trajectory.initial});
  for (const std::size_t n : steps_with_fields(result, every))
    out.push_back({n + 1, result.steps[n].increment->time, result.steps[n].increment->state});
  return out;
}

bool contacts_share_nodes(const Model& model) {
  std::vector<int> contact(model.node_count, -1);
  return std::any_of(model.points.begin(), model.points.end(), [&](const ContactPoint& point) {
    int& first = contact[point.nodes[0]];
    if (first < 0) first = point.contact;
    return first != point.contact;
  });
}

Vector<double> traction_vector(const Problem& problem, const State<double>& state, int p) {
  const auto& point = problem.model.points[p];
  const auto& geometry = geometry_in(state.contact, problem.slots, p);
  Vector<double> t = -state.contact.traction[point.multiplier] * geometry.normal;
  for (int a = 0; a < point.tangents; ++a)
    t -= state.contact.traction[point.multiplier + 1 + a] * geometry.tangents.col(a);
  return t;
}

void for_each_field(const CaseResult& result, int every, const std::function<void(std::string, std::string)>& take) {
  std::vector<PvdEntry> entries;
  const bool may_return = result.problem->model.scene.arc_length.has_value();  // (viewers put times in order)
  for (const auto& [number, time, state] : kept_moments(result, every)) {
    const double shown = may_return ? static_cast<double>(number) : time;
    take(field_file(number), vtu_text(fields_of(result, state, time, number == solved_steps(result).size())));
    entries.push_back({shown, field_file(number)});
    if (!has_obstacle_files(result, every)) continue;
    take(obstacle_file(number), vtu_text(obstacle_fields(*result.problem, time)));
    entries.push_back({shown, obstacle_file(number), 1});
  }
  take("fields.pvd", pvd_text(entries));
}

std::vector<std::string> field_files(const CaseResult& result, int every) {
  std::vector<std::string> files{"fields.pvd"};
  for (const auto& moment : kept_moments(result, every)) {
    files.push_back(field_file(moment.number));
    if (has_obstacle_files(result, every)) files.push_back(obstacle_file(moment.number));
  }
  return files;
}

}  // namespace stickslip
