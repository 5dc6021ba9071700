#include "studies/verify/responses.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stickslip::verify {
namespace {

/// Pairs of a sample and its weight in the mean.
using Samples = std::vector<std::array<double, 2>>;

std::optional<double> taken(const Samples& samples, const Json& how) {
  if (samples.empty()) return std::nullopt;
  const std::string take = how.value("take", "mean");
  const auto [least, largest] = std::minmax_element(samples.begin(), samples.end());
  if (take != "mean") return (take == "max" ? *largest : *least)[0];
  double sum = 0, total = 0;
  for (const auto& [sample, weight] : samples) {
    sum += weight * sample;
    total += weight;
  }
  return sum / total;
}

/// A vector along an axis; a force at a place also about a point.
double part_of(const Json& how, const Vec3& v, const Vec3& at = Vec3::Zero()) {
  const std::string component = how.at("component");
  return component == "moment" ? (at - vec3(how.at("about"))).cross(v)[2] : v[component[0] - 'x'];
}

/// Displacement at a place of the start, in the element that holds it.
std::optional<Vec3> displacement_at(const State& state, const Json& how) {
  const Vec3 X = vec3(how.at("at"));
  const Body* only = how.contains("on") ? &state.scene.body(how["on"]) : nullptr;
  for (const auto& body : state.scene.bodies)
    for (const auto& element : only&& only != &body ? std::vector<Nodes>{} : body.elements) {
      const Field nodes = state.scene.points(Eigen::all, element);
      const auto off = (nodes.colwise() - X).colwise().norm();
      Eigen::Index nearest = 0;
      const double distance = off.minCoeff(&nearest), size = off.maxCoeff();
      if (distance <= at_end * size) return Vec3(state.u.col(element[nearest]));
      if (!body.solid() || distance > (nodes.colwise() - nodes.col(0)).colwise().norm().maxCoeff()) continue;
      Vec2 r = natural_nodes(body).rowwise().mean();
      for (int k = 0; k < 20; ++k) {
        const Shape at = shape(body, r);
        r += (nodes.topRows<2>() * at.gradient).inverse() * (X - nodes * at.value).head<2>();
      }
      const double past = body.corners() == 3 ? std::max(-r.minCoeff(), r.sum() - 1) : r.cwiseAbs().maxCoeff() - 1;
      if (past <= 1e-6) return Vec3(state.u(Eigen::all, element) * shape(body, r).value);
    }
  return std::nullopt;
}

/// a = 2 sqrt(sum f x^2 / sum f) of nodal forces f, about a point or their centre; of revolution sqrt(5/2 ...). None
/// where a plane of symmetry may be what it is measured from: where supports hold nodes of the contact.
std::optional<double> half_width(const State& state, const std::vector<const Placed*>& placed, const Json& how) {
  const Field places = state.scene.places(state.u);
  double force = 0, moment = 0;
  Vec3 middle = Vec3::Zero(), normal = middle;
  long closed = 0;
  for (const auto* one : placed) {
    const double f = one->touch.area * one->pressure();
    closed += f > 0;
    force += f;
    middle += f * places.col(one->touch.node);
    normal += f * one->touch.normal;
  }
  const bool rings = state.scene.axisymmetric;
  if (closed < (rings ? 1 : 2)) return 0;
  for (const auto& support : part(state.scene.json, "supports"))
    for (const auto* one : placed)
      if (!rings && !how.contains("about") && state.scene.side(support.at("on")).has(one->touch.node))
        return std::nullopt;
  middle = how.contains("about") ? vec3(how["about"]) : Vec3(middle / force);
  for (const auto* one : placed) {
    const Vec3 x = places.col(one->touch.node);
    const double arm = rings ? x[0] : normal.normalized().cross(x - middle)[2];
    moment += one->touch.area * one->pressure() * arm * arm;
  }
  return std::sqrt((rings ? 2.5 : 4) * moment / force);
}

std::optional<double> of_contact(const State& state, const std::string& kind, const Json& how) {
  const std::string name = how.at("contact");
  if (kind == "dissipation") return state.heat.contains(name) ? state.heat.at(name) : 0;
  std::vector<const Placed*> placed;
  for (const auto& one : state.placed)
    if (one.contact->name == name || one.contact->group == name) placed.push_back(&one);
  if (kind == "contact_half_width") return half_width(state, placed, how);
  const Field places = state.scene.places(state.u);
  double sum = 0;
  Samples samples;
  for (const auto* one : placed) {
    const Touch& touch = one->touch;
    if (kind == "gap") samples.push_back({touch.gap, touch.area});
    if (kind == "contact_pressure") samples.push_back({one->pressure(), touch.area});
    if (kind == "slip" && one->contact->given.contains("friction") && !state.scene.on_axis(touch.node))
      samples.push_back({one->slid, touch.area});
    if (kind != "contact_force") continue;
    Vec3 x = Vec3::Zero();  // the force is shared by the slave's nodes
    for (const auto& [node, weight] : touch.weights)
      if (one->contact->segment ? weight > 0 : node == touch.node) x += weight * places.col(node);
    sum += touch.area * (how.at("component") == "normal" ? one->pressure() : part_of(how, one->traction, x));
  }
  return kind == "contact_force" ? sum : taken(samples, how);
}

}  // namespace

std::optional<double> measure(const State& state, const Json& response) {
  const std::string kind = response.begin().key();
  const Json& how = response.begin().value();
  if (kind == "strain_energy") return state.bodies.energy;
  if (how.contains("at")) {
    const auto u = kind == "displacement" ? displacement_at(state, how) : std::nullopt;
    return u ? std::optional(part_of(how, *u)) : std::nullopt;
  }
  if (how.contains("contact")) return of_contact(state, kind, how);
  Samples samples;
  if (kind == "plastic_strain") {
    for (std::size_t b = 0; b < state.scene.bodies.size(); ++b)
      for (const auto& particle : state.bodies.particles[b])
        if (state.scene.bodies[b].name == how.at("on")) samples.push_back({particle.equivalent, particle.volume});
    return taken(samples, how);
  }
  const Field places = state.scene.places(state.u);
  double sum = 0;
  for (const int node : state.scene.side(how.at("on")).nodes) {
    if (kind == "reaction")
      sum += part_of(how, state.held.col(node), places.col(node));
    else
      samples.push_back({part_of(how, state.u.col(node)), 1});
  }
  return kind == "reaction" ? sum : taken(samples, how);
}

}  // namespace stickslip::verify
