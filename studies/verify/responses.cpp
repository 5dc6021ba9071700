#include "studies/verify/responses.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace stickslip::verify {
namespace {

/// Pairs of a sample and its weight in the mean.
using Samples = std::vector<std::array<double, 2>>;

std::optional<double> taken(const Samples& samples, const std::string& take) {
  if (samples.empty()) return std::nullopt;
  double sum = 0, total = 0;
  for (const auto& [sample, weight] : samples) sum += weight * sample, total += weight;
  if (take == "mean") return sum / total;
  const auto [least, largest] = std::minmax_element(samples.begin(), samples.end());
  return (take == "max" ? *largest : *least)[0];
}

/// A force along an axis, or its moment about a point.
double part_of(const Json& how, const Vec3& force, const Vec3& x) {
  const std::string component = how.at("component");
  return component == "moment" ? (x - vec3(how.at("about"))).cross(force)[2] : force[component[0] - 'x'];
}

/// Displacement at a place of the start, in the element that holds it.
std::optional<Vec3> displacement_at(const State& state, const Json& how) {
  const Vec3 X = vec3(how.at("at"));
  for (const auto& body : state.scene.bodies)
    for (const auto& element : body.elements) {
      if (how.contains("on") && body.name != state.scene.body(how["on"].get<std::string>()).name) break;
      if (!body.solid()) {
        for (const int node : element)
          if ((state.scene.points.col(node) - X).norm() <= 1e-9 * (1 + X.norm())) return state.u.col(node);
        continue;
      }
      const Eigen::Matrix2Xd nodes = state.scene.points(Eigen::seqN(0, 2), element);
      const double size = (nodes.rowwise().maxCoeff() - nodes.rowwise().minCoeff()).norm();
      if ((nodes.rowwise().mean() - X.head<2>()).norm() > size) continue;
      Vec2 r(element.size() % 3 == 0 ? 0.3 : 0, element.size() % 3 == 0 ? 0.3 : 0);
      for (int k = 0; k < 20; ++k) {
        const Shape at = shape(body.element, r[0], r[1]);
        r += (nodes * at.gradient.transpose()).eval().inverse() * (X.head<2>() - nodes * at.value);
      }
      const bool triangle = body.element[0] == 'T';
      const bool in = triangle ? r.minCoeff() >= -1e-6 && r.sum() <= 1 + 1e-6 : r.cwiseAbs().maxCoeff() <= 1 + 1e-6;
      if (in) return Vec3(state.u(Eigen::all, element) * shape(body.element, r[0], r[1]).value);
    }
  return std::nullopt;
}

/// a = 2 sqrt(sum f x^2 / sum f) of nodal forces f, sqrt(5/2 ...) of revolution.
std::optional<double> half_width(const State& state, const std::vector<const Placed*>& places, const Json& how) {
  const bool rings = state.scene.axisymmetric;
  double force = 0, moment = 0;
  Vec3 middle = Vec3::Zero(), normal = middle;
  int closed = 0;
  for (const auto* placed : places) {
    const double f = placed->touch.area * placed->pressure();
    closed += f > 0;
    force += f;
    middle += f * state.scene.place(placed->touch.node, state.u);
    normal += f * placed->touch.normal;
  }
  if (closed < (rings ? 1 : 2)) return 0;
  middle = how.contains("about") ? vec3(how["about"]) : Vec3(middle / force);
  for (const auto* placed : places) {
    const Vec3 x = state.scene.place(placed->touch.node, state.u);
    const double arm = rings ? x[0] : normal.normalized().cross(x - middle)[2];
    moment += placed->touch.area * placed->pressure() * arm * arm;
  }
  return std::sqrt((rings ? 2.5 : 4) * moment / force);
}

std::optional<double> of_contact(const State& state, const std::string& kind, const Json& how) {
  const std::string name = how.at("contact"), take = how.value("take", "mean");
  if (kind == "dissipation") {
    const auto found = state.heat.find(name);
    return found == state.heat.end() ? 0 : found->second;
  }
  std::vector<const Placed*> places;
  for (const auto& placed : state.places)
    if (placed.contact->name == name || placed.contact->group == name) places.push_back(&placed);
  if (kind == "contact_half_width") return half_width(state, places, how);
  double sum = 0;
  Samples samples;
  for (const auto* placed : places) {
    const Touch& touch = placed->touch;
    const Vec3 force = touch.area * placed->traction;
    if (kind == "gap") samples.push_back({touch.gap, touch.area});
    if (kind == "contact_pressure") samples.push_back({placed->pressure(), touch.area});
    if (kind == "slip" && placed->contact->given.contains("friction")) samples.push_back({placed->slid, touch.area});
    if (kind != "contact_force") continue;
    Vec3 x = Vec3::Zero();
    for (const auto& [node, weight] : touch.weights)
      if (weight > 0) x += weight * state.scene.place(node, state.u);
    sum += how.at("component") == "normal" ? force.dot(touch.normal) : part_of(how, force, x);
  }
  return kind == "contact_force" ? sum : taken(samples, take);
}

}  // namespace

std::optional<double> measure(const State& state, const Json& response) {
  const std::string kind = response.begin().key();
  const Json& how = response.begin().value();
  const std::string take = how.value("take", "mean");
  if (kind == "strain_energy") return state.bodies.energy;
  if (how.contains("at")) {
    const auto u = kind == "displacement" ? displacement_at(state, how) : std::nullopt;
    return u ? std::optional((*u)[how.at("component").get<std::string>()[0] - 'x']) : std::nullopt;
  }
  if (how.contains("contact")) return of_contact(state, kind, how);
  const std::string on = how.at("on");
  Samples samples;
  double sum = 0;
  for (std::size_t b = 0; kind == "plastic_strain" && b < state.scene.bodies.size(); ++b)
    for (std::size_t q = 0; state.scene.bodies[b].name == on && q < state.bodies.memory[b].size(); ++q)
      samples.push_back({state.bodies.memory[b][q].equivalent, state.bodies.volumes[b][q]});
  if (kind == "plastic_strain") return taken(samples, take);
  for (const int node : state.scene.side(on).nodes) {
    if (kind == "reaction")
      sum += part_of(how, state.held.col(node), state.scene.place(node, state.u));
    else
      samples.push_back({state.u(how.at("component").get<std::string>()[0] - 'x', node), 1});
  }
  return kind == "reaction" ? sum : taken(samples, take);
}

}  // namespace stickslip::verify
