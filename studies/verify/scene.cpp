#include "studies/verify/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace stickslip::verify {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// Edges of one element alone are of the boundary.
std::vector<std::vector<int>> boundary_of(const Body& body) {
  std::map<std::pair<int, int>, std::vector<int>> once;
  const std::size_t corners = body.element[0] == 'T' ? 3 : 4;
  for (const auto& element : body.elements)
    for (std::size_t e = 0; e < corners; ++e) {
      std::vector<int> edge{element[e], element[(e + 1) % corners]};
      if (body.quadratic()) edge.push_back(element[corners + e]);
      const auto [found, is_new] = once.emplace(std::minmax(edge[0], edge[1]), edge);
      if (!is_new) found->second.clear();
    }
  std::vector<std::vector<int>> edges;
  for (const auto& [ends, edge] : once)
    if (!edge.empty()) edges.push_back(edge);
  return edges;
}

Body read_body(const std::string& name, const Json& given, const Json& made) {
  Body body{name,
            made.at("element"),
            given.value("thickness", 1.0),
            given.value("area", 1.0),
            given.at("material"),
            made.at("elements").get<std::vector<std::vector<int>>>(),
            made.at("sides").get<std::map<std::string, std::vector<int>>>(),
            {}};
  body.edges = body.solid() ? boundary_of(body) : body.element == "bar" ? body.elements : body.edges;
  std::set<int> all;
  for (const auto& edge : body.edges) all.insert(edge.begin(), edge.end());
  if (body.solid()) body.sides.try_emplace("boundary", all.begin(), all.end());
  return body;
}

}  // namespace

Vec3 vec3(const Json& json) {
  Vec3 v = Vec3::Zero();
  for (std::size_t i = 0; i < json.size(); ++i) v[static_cast<Eigen::Index>(i)] = json[i].get<double>();
  return v;
}

const Json& part(const Json& json, const char* key) {
  static const Json none = Json::object();
  const auto found = json.find(key);
  return found == json.end() ? none : *found;
}

Value::Value(const Json& json) {
  if (json.is_number()) {
    rows_ = {{0, json.get<double>()}};
    return;
  }
  for (const auto& row : json.is_object() ? json.at("table") : json)
    rows_.push_back({row[0].get<double>(), row[1].get<double>()});
  if (json.is_object()) repeats_ = json.value("repeat", 1);
}

double Value::at(double time) const {
  const double first = rows_.front()[0], span = rows_.back()[0] - first;
  double t = std::clamp(time, first, first + repeats_ * span);
  if (repeats_ > 1) t -= span * std::clamp(std::ceil((t - first) / span - 1e-12) - 1, 0.0, repeats_ - 1);
  for (std::size_t k = 1; k < rows_.size(); ++k)
    if (t <= rows_[k][0]) {
      const auto &a = rows_[k - 1], &b = rows_[k];
      return a[1] + (t - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
    }
  return rows_.back()[1];
}

Motion::Motion(const Json& json) {
  for (const auto& [axis, value] : part(json, "move").items()) move[axis[0] - 'x'] = Value(value);
  const Json& rotate = part(json, "rotate");
  if (rotate.empty()) return;
  center = vec3(rotate.at("center"));
  angle = Value(rotate.at("angle"));
  if (rotate.contains("axis")) axis = vec3(rotate["axis"]).normalized();
}

Mat3 Motion::turn(double time) const {
  if (!angle || time == at_rest) return Mat3::Identity();
  return Eigen::AngleAxisd(angle->at(time) * degree, axis).toRotationMatrix();
}

Vec3 Motion::shift(double time) const {
  Vec3 u = Vec3::Zero();
  for (int i = 0; i < 3 && time != at_rest; ++i)
    if (move[i]) u[i] = move[i]->at(time);
  return u;
}

Vec3 Motion::displacement(const Vec3& X, double time, bool finite) const {
  if (!angle || time == at_rest) return shift(time);
  const Vec3 arm = X - center;
  return shift(time) + (finite ? Vec3(turn(time) * arm - arm) : Vec3(angle->at(time) * degree * axis.cross(arm)));
}

Vec3 Motion::back(const Vec3& x, double time) const {
  return angle ? Vec3(center + turn(time).transpose() * (x - shift(time) - center)) : Vec3(x - shift(time));
}

Scene::Scene(const Json& scene, const Json& mesh) : json(scene) {
  const std::string space = scene.value("space", "plane_strain");
  finite = scene.value("strain", "small") == "finite";
  axisymmetric = space == "axisymmetric";
  plane_stress = space == "plane_stress";
  dimension = space == "solid" ? 3 : 2;
  const Json& nodes = mesh.at("nodes");
  points.resize(3, static_cast<Eigen::Index>(nodes.size()));
  for (Eigen::Index n = 0; n < points.cols(); ++n) points.col(n) = vec3(nodes[n]);
  for (const auto& [name, given] : scene.at("bodies").items()) {
    bodies.push_back(read_body(name, given, mesh.at("bodies").at(name)));
    for (const auto& element : bodies.back().elements)
      for (const int node : element)
        if (node < 0 || node >= points.cols()) throw BadFile("an element of " + name + " has a node that is not there");
  }
}

const Body& Scene::body(const std::string& expression) const {
  const std::string name = expression.substr(0, expression.find_first_of(". "));
  for (const auto& body : bodies)
    if (body.name == name) return body;
  throw BadFile("the scene has no body \"" + name + "\"");
}

Side Scene::named(const std::string& word) const {
  const Body& of = body(word);
  const auto dot = word.find('.');
  Side side;
  if (dot == std::string::npos) {
    for (const auto& element : of.elements) side.nodes.insert(element.begin(), element.end());
  } else {
    const auto found = of.sides.find(word.substr(dot + 1));
    if (found == of.sides.end()) throw BadFile("the mesh has no side \"" + word + "\"");
    side.nodes = {found->second.begin(), found->second.end()};
  }
  const auto in = [&](int node) { return side.nodes.contains(node); };
  for (const auto& edge : of.edges) {
    const bool touched = of.element == "bar" && side.nodes.size() > 1 && std::any_of(edge.begin(), edge.end(), in);
    if (touched || std::all_of(edge.begin(), edge.end(), in)) side.edges.push_back(edge);
  }
  return side;
}

Side Scene::side(const std::string& expression) const {
  std::istringstream words(expression);
  std::string word;
  words >> word;
  Side side = named(word);
  for (std::string operation; words >> operation >> word;) {
    const Side other = named(word);
    const bool keep = operation == "&";
    std::erase_if(side.nodes, [&](int node) { return other.nodes.contains(node) != keep; });
    std::erase_if(side.edges, [&](const std::vector<int>& edge) {
      if (keep) return std::find(other.edges.begin(), other.edges.end(), edge) == other.edges.end();
      return std::none_of(edge.begin(), edge.end(), [&](int node) { return side.nodes.contains(node); });
    });
  }
  return side;
}

double Scene::depth(const Body& body, double x) const {
  return axisymmetric ? 2 * std::numbers::pi * x : body.element == "bar" ? 1 : body.thickness;
}

bool Scene::on_axis(int node) const {
  return axisymmetric && std::abs(points(0, node)) <= 1e-12 * points.cwiseAbs().maxCoeff();
}

}  // namespace stickslip::verify
