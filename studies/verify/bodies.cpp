#include "studies/verify/bodies.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stickslip::verify {
namespace {

/// Adds int P grad N dV of a point, with P_33 along the radius.
void add_stress(const Scene& scene, const Point& point, const Mat3& stress, double volume, Places& forces) {
  forces += volume * stress.topLeftCorner<2, 2>() * point.gradient.transpose();
  if (scene.axisymmetric) forces.row(0) += volume * stress(2, 2) / point.radius * point.value.transpose();
}

/// Forces of an element of a solid body.
Places element_forces(const Scene& scene, const Material& material, bool mean, const std::vector<Point>& points,
                      const Places& u, Particle* particles, Bodies& bodies) {
  std::vector<Mat3> H;
  double whole = 0, theta = 0;  // volume, and mean of J - 1 or tr H
  const auto change = [&](const Mat3& h) { return scene.finite ? volume_change(h) : h.trace(); };
  for (const auto& point : points) {
    H.push_back(Mat3::Zero());
    H.back().topLeftCorner<2, 2>() = u * point.gradient;
    if (scene.axisymmetric) H.back()(2, 2) = u.row(0).dot(point.value) / point.radius;
    whole += point.volume;
    theta += point.volume * change(H.back());
  }
  theta /= whole;
  Places forces = Places::Zero(2, u.cols()), varied = forces;  // varied: d theta / du
  double pressure = 0;                                         // int tr tau / 3 dV
  const Mat3 I = Mat3::Identity();
  for (std::size_t q = 0; q < points.size(); ++q) {
    Mat3 h = H[q];
    if (mean && scene.finite) h += std::expm1((std::log1p(theta) - std::log1p(change(H[q]))) / 3) * (I + H[q]);
    if (mean && !scene.finite) h += (theta - H[q].trace()) / 3 * I;
    const auto answer = scene.plane_stress ? respond_in_plane_stress(material, h, scene.finite, particles[q])
                                           : respond(material, h, scene.finite, particles[q]);
    const double volume = particles[q].volume = points[q].volume;
    bodies.inverted |= answer.inverted;
    bodies.energy += answer.energy * volume;
    bodies.plastic_work += answer.plastic_work * volume;
    if (!mean) {
      add_stress(scene, points[q], answer.stress, volume, forces);
      continue;
    }
    const Mat3 back = scene.finite ? Mat3((I + H[q]).inverse().transpose()) : I;
    const Mat3 tau = scene.finite ? Mat3(answer.stress * (I + h).transpose()) : answer.stress;
    pressure += tau.trace() / 3 * volume;
    add_stress(scene, points[q], (tau - tau.trace() / 3 * I) * back, volume, forces);
    const double share = scene.finite ? (1 + change(H[q])) / (1 + theta) : 1;
    add_stress(scene, points[q], share * back, volume / whole, varied);
  }
  return forces + pressure * varied;
}

/// The force of a bar on its second end.
Vec3 bar_force(const Scene& scene, const Body& body, const Nodes& bar, const Field& u, Particle& particle,
               Bodies& bodies) {
  const Material material(body.material);
  const Vec3 axis = scene.points.col(bar[1]) - scene.points.col(bar[0]), d = u.col(bar[1]) - u.col(bar[0]);
  const double length = axis.norm(), stretch = axis.dot(d) + (scene.finite ? d.squaredNorm() / 2 : 0);
  const double trial = stretch / axis.squaredNorm() - particle.strain(0, 0), q = material.E * std::abs(trial);
  const double growth = material.plastic ? material.growth(q, material.E, particle.equivalent) : 0;
  const double flow = std::copysign(growth, trial);
  particle.strain(0, 0) += flow;
  particle.equivalent += growth;
  particle.volume = body.area * length;
  bodies.plastic_work += (q - material.E * growth) * growth * particle.volume;
  bodies.energy += material.E * (trial - flow) * (trial - flow) / 2 * particle.volume;
  return material.E * body.area * (trial - flow) / length * (axis + (scene.finite ? 1.0 : 0.0) * d);
}

/// The force of a spring on its node.
Vec3 spring_force(const Body& body, const Vec3& d, Bodies& bodies) {
  const Json& rows = body.material.begin().value().at("stiffness");
  Vec3 force = Vec3::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) force[static_cast<Eigen::Index>(i)] = vec3(rows[i]).dot(d);
  bodies.energy += d.dot(force) / 2;
  return force;
}

void deform_body(const Scene& scene, const Body& body, const Field& u, std::vector<Particle>& particles,
                 Bodies& bodies) {
  const Json& numbers = body.material.begin().value();
  const double depth = body.element == "bar" ? body.area : scene.depth(body, scene.points.row(0).maxCoeff());
  bodies.stiffness = std::max(bodies.stiffness, numbers.value("E", 0.0) * depth);
  for (const auto& row : part(numbers, "stiffness"))
    bodies.stiffness = std::max(bodies.stiffness, vec3(row).maxCoeff());
  const auto add = [&](int node, const Vec3& force) {
    bodies.forces.col(node) += force;
    bodies.largest = std::max(bodies.largest, force.norm());
  };
  for (std::size_t e = 0; e < body.elements.size(); ++e) {
    const Nodes& element = body.elements[e];
    if (body.solid()) {
      const auto points = points_of(scene, body, element);
      particles.resize(body.elements.size() * points.size());
      const Places forces = element_forces(scene, Material(body.material), body.element == "Q4_mean_dilatation", points,
                                           u(Eigen::seqN(0, 2), element), &particles[e * points.size()], bodies);
      for (Eigen::Index a = 0; a < forces.cols(); ++a) add(element[a], Vec3(forces(0, a), forces(1, a), 0));
      continue;
    }
    const bool is_bar = body.element == "bar";
    particles.resize(is_bar ? body.elements.size() : 0);
    const int from = is_bar ? element[0] : body.sides.at("anchor").at(0),
              to = is_bar ? element[1] : body.sides.at("node").at(0);
    const Vec3 force = is_bar ? bar_force(scene, body, element, u, particles[e], bodies)
                              : spring_force(body, u.col(to) - u.col(from), bodies);
    add(from, -force);
    add(to, force);
  }
}

/// Present stretch of the thickness at a place of an edge, of rubber in plane stress: F_33 of the element behind.
double thickness_stretch(const Scene& scene, const Body& body, const Nodes& edge, double s, const Field& u) {
  const Places natural = natural_nodes(body);
  for (const auto& element : body.elements)
    for (std::size_t c = 0; c < body.corners(); ++c) {
      const std::size_t d = (c + 1) % body.corners();
      if (element[c] != edge[0] || element[d] != edge[1]) continue;
      const auto gradient = shape(body, (1 - s) * natural.col(c) + s * natural.col(d)).gradient;
      const Eigen::Matrix2d jacobian = scene.points(Eigen::seqN(0, 2), element) * gradient;
      Mat3 H = Mat3::Zero();
      H.topLeftCorner<2, 2>() = u(Eigen::seqN(0, 2), element) * gradient * jacobian.inverse();
      Memory none;
      respond_in_plane_stress(Material(body.material), H, true, none);
      return 1 + H(2, 2);
    }
  return 1;
}

void add_body_force(const Scene& scene, const Body& body, const Vec3& f, Field& forces) {
  for (const auto& element : body.elements)
    if (body.element == "bar")
      for (const int node : element)
        forces.col(node) += body.area * (scene.points.col(element[1]) - scene.points.col(element[0])).norm() / 2 * f;
    else
      for (const auto& point : points_of(scene, body, element))
        for (std::size_t a = 0; a < element.size(); ++a) forces.col(element[a]) += point.value[a] * point.volume * f;
}

/// int p N n da, n into the body: at finite strain of the present edges.
void add_pressure(const Scene& scene, const Body& body, const Side& side, double p, const Field& u, Field& forces) {
  const Field places = scene.places(u);
  for (const auto& edge : side.edges)
    for (const auto& point : edge_points(edge.size(), scene.axisymmetric)) {
      const auto n = static_cast<Eigen::Index>(edge.size());
      const Field at = places(Eigen::all, edge);
      const Vec3 tau = at * point.slope.head(n);
      double size = p * point.weight * scene.depth(body, at.row(0) * point.value.head(n));
      if (scene.finite && scene.plane_stress) size *= thickness_stretch(scene, body, edge, point.s, u);
      for (Eigen::Index a = 0; a < n; ++a)
        if (side.has(edge[a])) forces.col(edge[a]) += point.value[a] * size * Vec3(-tau[1], tau[0], 0);
    }
}

/// A traction by the areas of the nodes, or a force in all that they share by these.
void add_traction(const Scene& scene, const Body& body, const Side& side, const Vec3& f, bool in_all, Field& forces) {
  auto areas = areas_of(scene, body, side);
  double all = 0;
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
  const double factor = load.contains("history") ? value_at(load["history"], along_path ? end : time) : 1;
  return along_path ? factor * time / end : factor;
}

}  // namespace

Bodies deform(const Scene& scene, const Field& u, const Bodies& before) {
  Bodies bodies;
  bodies.forces = Field::Zero(3, u.cols());
  bodies.particles = before.particles;
  bodies.particles.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    deform_body(scene, scene.bodies[b], u, bodies.particles[b], bodies);
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
    if (load.contains("body_force"))
      add_body_force(scene, body, factor * vec3(load["body_force"]), forces);
    else if (load.contains("pressure"))
      add_pressure(scene, body, scene.side(on), factor * load["pressure"].get<double>(), u, forces);
    else if (load.contains("force"))
      add_traction(scene, body, scene.side(on), factor * vec3(load["force"]), true, forces);
    else
      add_traction(scene, body, scene.side(on), factor * vec3(load.at("traction")), false, forces);
  }
  return forces;
}

}  // namespace stickslip::verify
