#include "studies/run/fields.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/model/loading.hpp"
#include "methods/stepping/checkpoints.hpp"
#include "studies/input/obstacle_kinds.hpp"
#include "studies/input/response_kinds.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/vtu.hpp"
#include "studies/run/contact_points.hpp"
#include "studies/run/strains.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Mean stress of each element, xx yy zz xy yz xz; zero for lumped elements. Plane strain: zz = nu (xx + yy);
/// axisymmetric: zz is the hoop stress.
Matrix<double> element_stress(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  int count = 0;
  for (const auto& body : model.bodies) count += body.mesh.element_count();
  Matrix<double> stress = Matrix<double>::Zero(6, count);
  int first = 0;  // column of the body's first element
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto& law = problem.slots.laws[b];
    Vector<double> volumes = Vector<double>::Zero(model.bodies[b].mesh.element_count());
    for_each_strain(problem, state, b, [&](int e, const auto& H, double volume, const double* memory) {
      const auto [xx, yy, zz, xy] = stress_of(law, H, memory);
      Eigen::Matrix<double, 6, 1> components;
      components << xx, yy, zz, xy, 0, 0;
      stress.col(first + e) += volume * components;
      volumes[e] += volume;
    });
    for (Eigen::Index e = 0; e < volumes.size(); ++e)
      if (volumes[e] > 0) stress.col(first + e) /= volumes[e];
    first += static_cast<int>(volumes.size());
  }
  return stress;
}

double von_mises(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& stress) {
  const double size = stress.cwiseAbs().maxCoeff();
  if (size == 0) return 0;
  const Eigen::Matrix<double, 6, 1> s = stress / size;  // whose squares do not overflow
  const double normal = std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2);
  return size * std::sqrt(0.5 * normal + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

Matrix<double> nodal(const Model& model, const Eigen::Ref<const Vector<double>>& dofs) {
  return Eigen::Map<const Matrix<double>>(dofs.data(), model.dimension, model.node_count);
}

/// Whether point p has a place of its master before it; otherwise its gap is a distance to what it does not face.
bool faces_master(const Model& model, const ContactField<double>& field, int p) {
  return field.facing.empty() || model.points[p].curve < 0 || field.facing[p].patch != Patch::none;
}

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
    if (faces_master(problem.model, of.contact, p) && !(gap(0, node) <= of.contact.gap[p]))
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

/// Whether bodies change their thickness.
bool thins(const Model& model) { return model.scene.finite_strain && model.scene.space == Space::plane_stress; }

/// Mean stretch of the thickness of each element, one row.
Matrix<double> element_thickness(const Problem& problem, const State<double>& state) {
  std::vector<double> means;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    const std::size_t first = means.size();
    means.resize(first + problem.model.bodies[b].mesh.element_count(), 1);
    std::vector<double> volumes(means.size() - first, 0);
    for_each_strain(problem, state, b, [&](int e, const auto& H, double volume, const double* memory) {
      if constexpr (std::is_same_v<decltype(H), const PlaneGradient<double>&>) {
        const double stretch = thickness_stretch(problem.slots.laws[b], H, memory);
        volumes[e] += volume;
        means[first + e] += (stretch - means[first + e]) * volume / volumes[e];
      }
    });
  }
  return Eigen::Map<const Vector<double>>(means.data(), static_cast<Eigen::Index>(means.size())).transpose();
}

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

/// Mean equivalent plastic strain of each element, one row.
Matrix<double> element_plastic_strain(const Problem& problem, const State<double>& state) {
  std::vector<double> means;
  for (std::size_t b = 0; b < problem.model.bodies.size(); ++b) {
    const auto of_body = mean_plastic_strains(problem, state, static_cast<int>(b));
    means.insert(means.end(), of_body.begin(), of_body.end());
  }
  return Eigen::Map<const Vector<double>>(means.data(), static_cast<Eigen::Index>(means.size())).transpose();
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

json point_json(const Eigen::Ref<const Vector<double>>& x) {
  return json(std::vector<double>(x.data(), x.data() + x.size()));
}

json numbers_json(const std::vector<Number>& numbers) {
  json out = json::array();
  for (const auto& n : numbers) out.push_back(n.value);
  return out;
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

/// A time whose fields are written.
struct Moment {
  std::size_t number;  ///< of the step, from 1 on; 0: the start
  double time;
  const State<double>& state;
};

std::vector<Moment> moments_of(const CaseResult& result, int every) {
  std::vector<Moment> out;
  if (every > 0 && !solved_steps(result).empty()) out.push_back({0, 0, result.trajectory.initial});
  for (const std::size_t n : steps_with_fields(result, every))
    out.push_back({n + 1, result.steps[n].increment->time, result.steps[n].increment->state});
  return out;
}

/// Whether the obstacles are written beside the fields: of several moments, in the plane.
bool has_obstacle_files(const CaseResult& result, int every) {
  const auto& scene = result.problem->model.scene;
  return every > 0 && !scene.obstacles.empty() && result.problem->model.dimension == 2;
}

/// The shape at the start, and what it moved by until `time`: a displacement, and where it rotates an angle in degrees
/// about a center.
json obstacle_json(const Obstacle& obstacle, double time, bool finite, const Numbers<double>& numbers) {
  json shape = drawn(obstacle.shape);
  json moved = {{"by", {0.0, 0.0}}};
  for (const auto& [axis, table] : obstacle.move)
    if (axis < 'z') moved["by"][axis == 'x' ? 0 : 1] = evaluate(table, time, numbers);
  if (obstacle.rotate) {
    moved["degrees"] = evaluate(obstacle.rotate->angle, time, numbers);
    moved["center"] = numbers_json(obstacle.rotate->center);
    if (finite) moved["finite"] = true;
  }
  if (!obstacle.move.empty() || obstacle.rotate) shape.begin().value()["moved"] = moved;
  return shape;
}

/// Where the outline of an obstacle is at the start, of a plane as much as lies beside the bodies.
std::vector<Eigen::Vector2d> outline_of(const json& kind, const json& shape, const Points<double>& bodies) {
  const auto point = [](const json& x) { return Eigen::Vector2d(x[0], x[1]); };
  std::vector<Eigen::Vector2d> out;
  if (kind == "plane") {
    const Eigen::Vector2d at = point(shape["point"]), n = point(shape["normal"]).normalized(), along(n.y(), -n.x());
    const Eigen::VectorXd s = along.transpose() * (bodies.colwise() - at);
    const double room = s.maxCoeff() - s.minCoeff();
    for (const double end : {s.minCoeff() - room, s.maxCoeff() + room}) out.emplace_back(at + end * along);
  } else if (kind == "circle") {
    constexpr int sides = 128;  // off the circle by 3e-4 of its radius
    for (int i = 0; i <= sides; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / sides;
      out.emplace_back(point(shape["center"]) +
                       shape["radius"].get<double>() * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  } else {
    for (const auto& vertex : shape["points"]) out.push_back(point(vertex));
  }
  return out;
}

/// What a point of an obstacle moved by: by + (R - I) (X - center), linear in the angle at small strain.
Eigen::Vector2d moved_by(const json& moved, const Eigen::Vector2d& x) {
  const auto vector = [](const json& v) { return Eigen::Vector2d(v[0], v[1]); };
  if (moved.is_null()) return Eigen::Vector2d::Zero();
  if (!moved.contains("center")) return vector(moved["by"]);
  const Eigen::Vector2d arm = x - vector(moved["center"]), across(-arm.y(), arm.x());
  const double angle = moved["degrees"].get<double>() * std::acos(-1.0) / 180;
  if (!moved.value("finite", false)) return vector(moved["by"]) + angle * across;
  return vector(moved["by"]) + (std::cos(angle) - 1) * arm + std::sin(angle) * across;
}

/// The obstacles as lines at the start, with their displacement.
VtuData obstacles_of(const Problem& problem, double time) {
  const auto& scene = problem.model.scene;
  VtuData data;
  data.time = time;
  std::vector<Eigen::Vector2d> points, displacements;
  std::vector<double> owner;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    const json drawn = obstacle_json(scene.obstacles[o], time, scene.finite_strain, problem.slots.numbers);
    const auto outline = outline_of(drawn.begin().key(), drawn.begin().value(), problem.slots.points);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (i > 0) {
        data.cells.push_back(VtuCell::line);
        const int last = static_cast<int>(points.size());
        data.connectivity.insert(data.connectivity.end(), {last - 1, last});
        owner.push_back(static_cast<double>(o));
      }
      points.push_back(outline[i]);
      displacements.push_back(moved_by(drawn.begin().value().value("moved", json()), outline[i]));
    }
  }
  const auto columns = [](const std::vector<Eigen::Vector2d>& list) {
    Matrix<double> out(2, static_cast<Eigen::Index>(list.size()));
    for (std::size_t i = 0; i < list.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = list[i];
    return out;
  };
  data.points = columns(points);
  data.point_fields.push_back({"displacement", columns(displacements)});
  data.cell_fields.push_back(
      {"obstacle",
       Eigen::Map<const Vector<double>>(owner.data(), static_cast<Eigen::Index>(owner.size())).transpose()});
  return data;
}

/// Nodes of all bodies, what moved and stresses them, and their elements by nodes.
json bodies_json(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  json points = json::array(), displacement = json::array(), elements = json::array(), bodies = json::array(),
       mises = json::array(), names = json::array();
  const Matrix<double> u = nodal(model, state.displacement), stress = element_stress(problem, state);
  for (int node = 0; node < model.node_count; ++node) {
    points.push_back(point_json(problem.slots.points.col(node)));
    displacement.push_back(point_json(u.col(node)));
  }
  int column = 0;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    names.push_back(model.scene.bodies[b].name);
    for (int e = 0; e < model.bodies[b].mesh.element_count(); ++e, ++column) {
      elements.push_back(detail::element_nodes(model.bodies[b], e));
      bodies.push_back(b);
      mises.push_back(von_mises(stress.col(column)));
    }
  }
  json out = {{"points", points}, {"displacement", displacement}, {"elements", elements},
              {"bodies", bodies}, {"body_names", names},          {"von_mises", mises}};
  if (model.effects.plasticity) {
    const Matrix<double> strain = element_plastic_strain(problem, state);
    out["plastic_strain"] = std::vector<double>(strain.data(), strain.data() + strain.size());
  }
  return out;
}

/// Contact points where they have moved to, with their states and tractions.
json contact_json(const Problem& problem, const State<double>& state) {
  const auto& model = problem.model;
  const Matrix<double> u = nodal(model, state.displacement);
  json contact = json::array();
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const int node = point.nodes[0];
    const auto t = state.contact.traction.segment(point.multiplier + 1, point.tangents);
    contact.push_back({{"name", model.scene.contacts[point.contact].name},
                       {"x", problem.slots.points(0, node) + u(0, node)},
                       {"y", problem.slots.points(1, node) + u(1, node)},
                       {"node", node},
                       {"state", state_name(point, state.contact.state[p])},
                       {"normal", state.contact.traction[point.multiplier]},
                       {"tangential", point.tangents == 1 ? t[0] : t.norm()}});
  }
  return contact;
}

}  // namespace

bool contacts_share_nodes(const Model& model) {
  std::vector<int> contact(model.node_count, -1);
  return std::any_of(model.points.begin(), model.points.end(), [&](const ContactPoint& point) {
    int& first = contact[point.nodes[0]];
    if (first < 0) first = point.contact;
    return first != point.contact;
  });
}

std::vector<double> mean_plastic_strains(const Problem& problem, const State<double>& state, int body) {
  std::vector<std::pair<double, double>> points;  // strain times volume, volume
  for_each_plastic_strain(problem.model, problem.slots, body, state.history.bodies,
                          [&](double strain, double volume) { points.emplace_back(strain * volume, volume); });
  std::vector<double> means(problem.model.bodies[body].mesh.element_count(), 0);
  const std::size_t each = points.size() / means.size();
  for (std::size_t e = 0; each > 0 && e < means.size(); ++e) {
    double sum = 0, volume = 0;
    for (std::size_t k = e * each; k < (e + 1) * each; ++k) {
      sum += points[k].first;
      volume += points[k].second;
    }
    means[e] = sum / volume;
  }
  return means;
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
  for (const auto& [number, time, state] : moments_of(result, every)) {
    const double shown = may_return ? static_cast<double>(number) : time;
    take(field_file(number), vtu_text(fields_of(result, state, time, number == solved_steps(result).size())));
    entries.push_back({shown, field_file(number)});
    if (!has_obstacle_files(result, every)) continue;
    take(obstacle_file(number), vtu_text(obstacles_of(*result.problem, time)));
    entries.push_back({shown, obstacle_file(number), 1});
  }
  take("fields.pvd", pvd_text(entries));
}

void write_fields(const std::filesystem::path& directory, const CaseResult& result, int every) {
  for_each_field(result, every,
                 [&](const std::string& name, const std::string& text) { write_output(directory / name, text); });
}

std::vector<std::string> field_files(const CaseResult& result, int every) {
  std::vector<std::string> files{"fields.pvd"};
  for (const auto& moment : moments_of(result, every)) {
    files.push_back(field_file(moment.number));
    if (has_obstacle_files(result, every)) files.push_back(obstacle_file(moment.number));
  }
  return files;
}

namespace {

/// The displacements, step by step, of points on springs and of their anchors; of many steps some, the last among them,
/// and none of those that an adjoint let go.
json paths_json(const CaseResult& result) {
  constexpr std::size_t most = 200;  // of a path: more than a picture shows
  const auto& model = result.problem->model;
  const auto steps = solved_steps(result);
  const std::size_t stride = (steps.size() + most - 1) / most;
  json paths = json::array();
  for (const auto& body : model.bodies) {
    const auto nodes = body.mesh.element_count() == 1 ? detail::element_nodes(body, 0) : std::vector<int>{};
    const auto place = [&](int node) { return result.problem->slots.points.col(node); };
    if (nodes.size() != 2 || place(nodes[0]) != place(nodes[1])) continue;
    for (const int node : nodes) {
      json displacement = json::array();
      for (std::size_t n = steps.empty() ? 0 : (steps.size() - 1) % stride; n < steps.size(); n += stride)
        if (const auto& state = steps[n].increment->state; is_whole(state))
          displacement.push_back(point_json(nodal(model, state.displacement).col(node)));
      paths.push_back({{"node", node}, {"displacement", displacement}});
    }
  }
  return paths;
}

}  // namespace

json picture_json(const CaseResult& result, int every) {
  if (result.steps.empty()) return nullptr;
  const auto& problem = *result.problem;
  const auto& scene = problem.model.scene;
  const auto solved = solved_steps(result);  // where there is none, the picture is of the start
  const State<double>& state = solved.empty() ? result.trajectory.initial : solved.back().increment->state;
  const double time = solved.empty() ? 0 : solved.back().increment->time;
  json picture = bodies_json(problem, state);
  picture["contact"] = contact_json(problem, state);
  if (json paths = paths_json(result); !paths.empty()) picture["paths"] = std::move(paths);
  if (scene.finite_strain) picture["finite"] = true;  // it is drawn at true scale
  const auto obstacles_at = [&](double t) {
    json out = json::array();
    for (const auto& obstacle : scene.obstacles)
      out.push_back(obstacle_json(obstacle, t, scene.finite_strain, problem.slots.numbers));
    return out;
  };
  picture["obstacles"] = obstacles_at(time);
  if (every > 0)
    for (const auto& moment : moments_of(result, every)) {
      const json bodies = bodies_json(problem, moment.state);
      picture["frames"].push_back({{"step", moment.number},
                                   {"time", moment.time},
                                   {"displacement", bodies["displacement"]},
                                   {"von_mises", bodies["von_mises"]},
                                   {"contact", contact_json(problem, moment.state)},
                                   {"obstacles", obstacles_at(moment.time)}});
      if (bodies.contains("plastic_strain")) picture["frames"].back()["plastic_strain"] = bodies["plastic_strain"];
    }
  picture["responses"] = json::object();
  for (const auto& response : scene.responses) picture["responses"][response.name] = name_of(response.kind);
  return picture;
}

}  // namespace stickslip
