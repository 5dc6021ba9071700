/// Responses, measured again (docs/scene.md, Responses).
#pragma once

#include "studies/verify/contacts.hpp"

namespace stickslip::verify {

/// What is checked, and what responses are measured on.
struct State {
  Scene scene;
  Field u;  ///< displacements
  Bodies bodies;
  std::vector<Contact> contacts;
  Field held;  ///< forces of the supports
  State(const Json& given, const Json& mesh)
      : scene(given, mesh), u(Field::Zero(3, scene.points.cols())), bodies(scene), held(u) {
    for (const auto& [name, sides] : part(mesh, "contacts").items()) contacts.emplace_back(scene, name, sides);
  }
  Vec3 position(int node) const { return scene.points.col(node) + (scene.finite ? 1.0 : 0.0) * u.col(node); }
};

/// Pairs of a sample and its weight in the mean.
using Samples = std::vector<std::array<double, 2>>;

inline std::optional<double> taken(const Samples& samples, const std::string& take) {
  Vec2 sum(0, 0);
  for (const auto& [sample, weight] : samples) sum += weight * Vec2(sample, 1);
  if (take == "sum") return sum[0];
  if (samples.empty()) return std::nullopt;
  const auto [least, largest] = std::minmax_element(samples.begin(), samples.end());
  return take == "mean" ? sum[0] / sum[1] : (take == "max" ? *largest : *least)[0];
}

/// A vector along an axis; a force at a place also about a point.
inline double part_of(const Json& how, const Vec3& v, const Vec3& at = Vec3::Zero()) {
  const std::string component = how.at("component");
  if (component != "moment") return v[component[0] - 'x'];
  const Vec3 axis = how.contains("axis") ? vec3(how["axis"]).normalized() : Vec3(0, 0, 1);
  return axis.dot((at - vec3(how.at("about"))).cross(v));
}

/// Displacement at a place of the start, in the element that holds it.
inline std::optional<Vec3> displacement_at(const State& state, const Json& how) {
  const Vec3 X = vec3(how.at("at"));
  for (const auto& body : state.scene.bodies)
    for (const auto& element : body.elements) {
      if (how.contains("on") && &state.scene.body(how["on"]) != &body) continue;
      const Field nodes = state.scene.points(Eigen::all, element);
      const auto off = (nodes.colwise() - X).colwise().norm();
      Eigen::Index nearest = 0;
      const double distance = off.minCoeff(&nearest), size = off.maxCoeff();
      if (distance <= at_end * size) return Vec3(state.u.col(element[nearest]));
      if (!body.solid() || distance > (nodes.colwise() - nodes.col(0)).colwise().norm().maxCoeff()) continue;
      Vec3 r = reference(body.element).nodes.rowwise().mean();
      for (int k = 0; k < 20; ++k) {
        const Shape at = shape(body.element, r);
        Mat3 slope = nodes * at.gradient;
        if (!body.in_space()) slope(2, 2) = 1;
        r += slope.inverse() * (X - nodes * at.value);
      }
      const bool simplex = body.element[0] == 'T';
      const double past = std::max(-r.minCoeff(), (simplex ? r.sum() : r.maxCoeff()) - 1);
      if (past <= (simplex ? 1e-6 : 5e-7)) return Vec3(state.u(Eigen::all, element) * shape(body.element, r).value);
    }
  return std::nullopt;
}

/// a = 2 sqrt(sum f x^2 / sum f) of nodal forces f, about a point or their centre; of revolution sqrt(5/2 ...). None
/// where a plane of symmetry may be what it is measured from: where supports hold nodes of the contact.
inline std::optional<double> half_width(const State& state, const std::vector<Touch>& touches, const Json& how) {
  const bool rings = state.scene.axisymmetric, has_center = how.contains("about");
  Field x(3, touches.size()), normals = x;
  Eigen::VectorXd f(touches.size());
  for (std::size_t k = 0; k < touches.size(); ++k) {
    x.col(k) = state.position(touches[k].node);
    normals.col(k) = touches[k].normal;
    f[k] = touches[k].area * touches[k].pressure();
  }
  if ((f.array() > 0).count() < (rings ? 1 : 2)) return 0;
  for (const auto& support : part(state.scene.json, "supports"))
    for (const auto& touch : touches)
      if (!rings && !has_center && state.scene.side(support.at("on")).has(touch.node)) return std::nullopt;
  const Vec3 normal = (normals * f).normalized(), center = has_center ? vec3(how["about"]) : Vec3(x * f / f.sum());
  const Vec3 along = rings ? Vec3(1, 0, 0) : Vec3(-right_of(normal)), middle = rings ? Vec3(0, 0, 0) : center;
  return std::sqrt((rings ? 2.5 : 4) * f.dot(((x.colwise() - middle).transpose() * along).cwiseAbs2()) / f.sum());
}

/// What a place of contact adds to a response; none: it does not count.
inline std::optional<double> at_place(const State& state, const Contact& contact, const Touch& touch,
                                      const std::string& kind, const Json& how) {
  if (kind == "gap") return touch.gap;
  if (kind == "contact_pressure") return touch.pressure();
  const bool slides = contact.given.contains("friction") && !state.scene.on_axis(touch.node);
  if (kind == "slip") return slides ? std::optional(touch.slid) : std::nullopt;
  if (kind != "contact_force") return std::nullopt;
  Vec3 x = Vec3::Zero();  // the force is shared by the slave's nodes
  for (const auto& [node, weight] : touch.slave) x += weight * state.position(node);
  return touch.area * (how.at("component") == "normal" ? touch.pressure() : part_of(how, touch.traction, x));
}

/// The value of a response; none of those that are not measured again.
inline std::optional<double> measure(const State& state, const Json& response) {
  const std::string kind = response.begin().key();
  const Json& how = response.begin().value();
  const bool force = kind == "contact_force" || kind == "reaction", sum = force || kind == "dissipation";
  Samples samples;
  if (kind == "strain_energy") return state.bodies.energy;
  if (how.contains("at")) {
    const auto u = kind == "displacement" ? displacement_at(state, how) : std::nullopt;
    return u ? std::optional(part_of(how, *u)) : std::nullopt;
  }
  if (how.contains("contact")) {
    const std::string name = how["contact"];
    std::vector<Touch> touches;
    for (const auto& contact : state.contacts) {
      if (contact.name != name && contact.group != name) continue;
      if (kind == "dissipation") samples.push_back({contact.heat, 1});
      for (const auto& [node, touch] : contact.touches) {
        touches.push_back(touch);
        if (const auto value = at_place(state, contact, touch, kind, how))
          samples.push_back({*value, force ? 1 : touch.area});
      }
    }
    if (kind == "contact_half_width") return half_width(state, touches, how);
  } else if (kind == "plastic_strain") {
    for (std::size_t b = 0; b < state.scene.bodies.size(); ++b)
      for (const auto& element : state.bodies.points[b])
        for (const auto& point : element)
          if (state.scene.bodies[b].name == how.at("on")) samples.push_back({point.equivalent, point.volume});
  } else {
    for (const int node : state.scene.side(how.at("on")).nodes)
      samples.push_back({part_of(how, (force ? state.held : state.u).col(node), state.position(node)), 1});
  }
  return taken(samples, sum ? "sum" : how.value("take", "mean"));
}

}  // namespace stickslip::verify
