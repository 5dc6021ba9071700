#include "studies/verify/bodies.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stickslip::verify {
namespace {

void add_force(Bodies& bodies, int node, const Vec3& force) {
  bodies.forces.col(node) += force;
  bodies.largest = std::max(bodies.largest, force.norm());
}

/// Adds int P grad N dV of a point, with P_33 along the radius.
void add_stress(const Scene& scene, const Point& point, const Mat3& stress, double volume, Eigen::Matrix2Xd& forces) {
  forces += volume * stress.topLeftCorner<2, 2>() * point.gradient.transpose();
  if (scene.axisymmetric) forces.row(0) += volume * stress(2, 2) / point.radius * point.value.transpose();
}

/// The same volume at all points of an element: how each changes its H, and how the mean varies.
struct MeanDilatation {
  bool on, finite;
  double volume = 0, mean = 0;

  MeanDilatation(bool is_on, bool is_finite, const std::vector<Point>& points, const std::vector<Mat3>& H)
      : on(is_on), finite(is_finite) {
    for (std::size_t q = 0; q < points.size(); ++q) volume += points[q].volume;
    for (std::size_t q = 0; q < points.size(); ++q) mean += points[q].volume / volume * change(H[q]);
  }
  double change(const Mat3& H) const { return finite ? volume_change(H) : H.trace(); }
  Mat3 changed(const Mat3& H) const {
    if (!on) return H;
    if (!finite) return H + (mean - H.trace()) / 3 * Mat3::Identity();
    return H + std::expm1((std::log1p(mean) - std::log1p(change(H))) / 3) * (Mat3::Identity() + H);
  }
};

/// Forces of an element of a solid body.
Eigen::Matrix2Xd element_forces(const Scene& scene, const Material& material, bool mean,
                                const std::vector<Point>& points, const Eigen::Matrix2Xd& u, Memory* memory,
                                Bodies& bodies, std::vector<double>& volumes) {
  std::vector<Mat3> H;
  for (const auto& point : points) {
    H.push_back(Mat3::Zero());
    H.back().topLeftCorner<2, 2>() = u * point.gradient;
    if (scene.axisymmetric) H.back()(2, 2) = u.row(0).dot(point.value) / point.radius;
  }
  const MeanDilatation dilatation(mean, scene.finite, points, H);
  Eigen::Matrix2Xd forces = Eigen::Matrix2Xd::Zero(2, u.cols()), varied = forces;  // varied: d(mean)/du
  double pressure = 0;                                                             // int tr tau / 3 dV
  for (std::size_t q = 0; q < points.size(); ++q) {
    Mat3 h = dilatation.changed(H[q]);
    const auto answer = scene.plane_stress ? respond_in_plane_stress(material, h, scene.finite, memory[q])
                                           : respond(material, h, scene.finite, memory[q]);
    const double volume = points[q].volume;
    volumes.push_back(volume);
    bodies.inverted |= answer.inverted;
    bodies.energy += answer.energy * volume;
    bodies.plastic_work += answer.plastic_work * volume;
    if (!mean) {
      add_stress(scene, points[q], answer.stress, volume, forces);
      continue;
    }
    const Mat3 I = Mat3::Identity(), back = scene.finite ? Mat3((I + H[q]).inverse().transpose()) : I;
    const Mat3 tau = scene.finite ? Mat3(answer.stress * (I + h).transpose()) : answer.stress;
    pressure += tau.trace() / 3 * volume;
    add_stress(scene, points[q], (tau - tau.trace() / 3 * I) * back, volume, forces);
    const double share = scene.finite ? (1 + dilatation.change(H[q])) / (1 + dilatation.mean) : 1;
    add_stress(scene, points[q], share * back, volume / dilatation.volume, varied);
  }
  return forces + pressure * varied;
}

void deform_solid(const Scene& scene, const Body& body, const Field& u, std::size_t b, Bodies& bodies) {
  const Material material(body.material);
  std::size_t m = 0;
  for (const auto& element : body.elements) {
    const auto points = points_of(scene, body, element);
    bodies.memory[b].resize(std::max(bodies.memory[b].size(), m + points.size()));
    const auto forces = element_forces(scene, material, body.element == "Q4_mean_dilatation", points,
                                       u(Eigen::seqN(0, 2), element), &bodies.memory[b][m], bodies, bodies.volumes[b]);
    m += points.size();
    for (std::size_t a = 0; a < element.size(); ++a) add_force(bodies, element[a], Vec3(forces(0, a), forces(1, a), 0));
  }
}

void deform_bars(const Scene& scene, const Body& body, const Field& u, std::size_t b, Bodies& bodies) {
  const Material material(body.material);
  bodies.memory[b].resize(body.elements.size());
  for (std::size_t m = 0; m < body.elements.size(); ++m) {
    const int first = body.elements[m][0], second = body.elements[m][1];
    const Vec3 axis = scene.points.col(second) - scene.points.col(first), d = u.col(second) - u.col(first);
    const double length = axis.norm(), volume = body.area * length;
    auto& [plastic, equivalent] = bodies.memory[b][m];
    double strain = (axis.dot(d) + (scene.finite ? d.squaredNorm() / 2 : 0)) / axis.squaredNorm() - plastic(0, 0);
    if (material.plastic) {
      const double q = material.E * std::abs(strain), growth = material.growth(q, material.E, equivalent);
      const double flow = std::copysign(growth, strain);
      plastic(0, 0) += flow;
      equivalent += growth;
      strain -= flow;
      bodies.plastic_work += (q - material.E * growth) * growth * volume;
    }
    bodies.energy += material.E * strain * strain / 2 * volume;
    bodies.volumes[b].push_back(volume);
    const Vec3 force = material.E * body.area * strain / length * (axis + (scene.finite ? 1.0 : 0.0) * d);
    add_force(bodies, first, -force);
    add_force(bodies, second, force);
  }
}

void deform_spring(const Body& body, const Field& u, Bodies& bodies) {
  const Json& rows = body.material.begin().value().at("stiffness");
  const int node = body.sides.at("node")[0], anchor = body.sides.at("anchor")[0];
  const Vec3 d = u.col(node) - u.col(anchor);
  Vec3 force = Vec3::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) force[i] = vec3(rows[i]).dot(d);
  bodies.energy += d.dot(force) / 2;
  add_force(bodies, node, force);
  add_force(bodies, anchor, -force);
}

/// Present stretch of the thickness at a place of an edge, of rubber in plane stress: F_33 of the element behind.
double thickness_stretch(const Scene& scene, const Body& body, const std::vector<int>& edge, double s, const Field& u) {
  const double R[2][4] = {{-1, 1, 1, -1}, {0, 1, 0, 0}}, S[2][4] = {{-1, -1, 1, 1}, {0, 0, 1, 0}};
  const int corners = body.element[0] == 'T' ? 3 : 4, kind = corners == 3;
  for (const auto& element : body.elements)
    for (int c = 0; c < corners; ++c) {
      const int d = (c + 1) % corners;
      if (element[c] != edge[0] || element[d] != edge[1]) continue;
      const auto along = [&](const double* at) { return at[c] + s * (at[d] - at[c]); };
      const auto gradient = shape(body.element, along(R[kind]), along(S[kind])).gradient;
      const Eigen::Matrix2d jacobian = scene.points(Eigen::seqN(0, 2), element) * gradient.transpose();
      Mat3 H = Mat3::Zero();
      H.topLeftCorner<2, 2>() = u(Eigen::seqN(0, 2), element) * gradient.transpose() * jacobian.inverse();
      Memory none;
      respond_in_plane_stress(Material(body.material), H, true, none);
      return 1 + H(2, 2);
    }
  return 1;
}

void add_body_force(const Scene& scene, const Body& body, const Vec3& f, Field& forces) {
  for (const auto& element : body.elements) {
    if (body.element == "bar") {
      const double half = body.area * (scene.points.col(element[1]) - scene.points.col(element[0])).norm() / 2;
      for (const int node : element) forces.col(node) += half * f;
      continue;
    }
    for (const auto& point : points_of(scene, body, element))
      for (std::size_t a = 0; a < element.size(); ++a) forces.col(element[a]) += point.value[a] * point.volume * f;
  }
}

/// int p N n da, n into the body: at finite strain of the present edges.
void add_pressure(const Scene& scene, const Body& body, const Side& side, double p, const Field& u, Field& forces) {
  for (const auto& edge : side.edges)
    for (const auto& point : edge_points(edge.size(), scene.axisymmetric)) {
      Vec3 x = Vec3::Zero(), tau = x;
      for (std::size_t a = 0; a < edge.size(); ++a) {
        x += point.value[a] * scene.place(edge[a], u);
        tau += point.slope[a] * scene.place(edge[a], u);
      }
      double size = p * point.weight * scene.depth(body, x[0]);
      if (scene.finite && scene.plane_stress) size *= thickness_stretch(scene, body, edge, point.s, u);
      for (std::size_t a = 0; a < edge.size(); ++a)
        if (side.nodes.contains(edge[a])) forces.col(edge[a]) += point.value[a] * size * Vec3(-tau[1], tau[0], 0);
    }
}

/// A traction by the areas of the nodes, or a force in all that they share by these.
void add_traction(const Scene& scene, const Body& body, const Side& side, const Vec3& f, bool in_all, Field& forces) {
  std::map<int, double> areas;
  double all = 0;
  for (const auto& edge : side.edges) {
    const auto shares = edge_areas(scene, body, edge);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (side.nodes.contains(edge[a])) areas[edge[a]] += shares[a];
  }
  if (side.edges.empty())
    for (const int node : side.nodes) areas[node] = 1;
  for (const auto& [node, area] : areas) all += area;
  for (const auto& [node, area] : areas) forces.col(node) += (in_all ? area / all : area) * f;
}

/// The factor of a load: its history, which along a path by arc length goes on straight, in proportion to the time.
double factor_of(const Scene& scene, std::size_t index, const Json& load, double time) {
  const Json& when = scene.json.at("time");
  const double end = when.value("end", 0.0);
  const std::size_t driven = part(part(when, "control"), "arc_length").value("load", std::size_t{0});
  const bool along_path = when.contains("control") && index == driven;
  const double factor = load.contains("history") ? Value(load["history"]).at(along_path ? end : time) : 1;
  return along_path ? factor * time / end : factor;
}

}  // namespace

Bodies deform(const Scene& scene, const Field& u, const std::vector<std::vector<Memory>>& before) {
  Bodies bodies;
  bodies.forces = Field::Zero(3, u.cols());
  bodies.memory = before;
  bodies.volumes.resize(scene.bodies.size());
  bodies.memory.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.element == "point")
      deform_spring(body, u, bodies);
    else if (body.element == "bar")
      deform_bars(scene, body, u, b, bodies);
    else
      deform_solid(scene, body, u, b, bodies);
  }
  return bodies;
}

Field load_forces(const Scene& scene, const Field& u, double time) {
  Field forces = Field::Zero(3, u.cols());
  const Json& loads = part(scene.json, "loads");
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Json& load = loads[k];
    const double factor = factor_of(scene, k, load, time);
    const std::string on = load.at("on");
    const Body& body = scene.body(on);
    if (load.contains("body_force")) add_body_force(scene, body, factor * vec3(load["body_force"]), forces);
    if (load.contains("pressure"))
      add_pressure(scene, body, scene.side(on), factor * load["pressure"].get<double>(), u, forces);
    for (const char* kind : {"traction", "force"})
      if (load.contains(kind))
        add_traction(scene, body, scene.side(on), factor * vec3(load[kind]), kind[0] == 'f', forces);
  }
  return forces;
}

}  // namespace stickslip::verify
