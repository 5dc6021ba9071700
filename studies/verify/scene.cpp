#include "studies/verify/scene.hpp"

#include <Eigen/Geometry>
#include <sstream>

namespace stickslip::verify {
namespace {

/// The edges of an element, in space its faces, by numbers of its nodes.
std::vector<Nodes> sides_of(const Body& body) {
  if (body.element == "T4") return {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  if (body.in_space()) return {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::vector<Nodes> sides;
  const int corners = static_cast<int>(body.corners());
  for (int e = 0; e < corners; ++e) {
    sides.push_back({e, (e + 1) % corners});
    if (body.quadratic()) sides.back().push_back(corners + e);
  }
  return sides;
}

/// Edges of one element alone are of the boundary.
std::vector<Nodes> boundary_of(const Body& body) {
  std::map<std::set<int>, std::vector<Nodes>> edges;
  for (const auto& element : body.elements)
    for (const auto& side : sides_of(body)) {
      Nodes edge;
      for (const int a : side) edge.push_back(element.at(a));
      edges[{edge.begin(), edge.end()}].push_back(edge);
    }
  std::vector<Nodes> boundary;
  for (const auto& [ends, shared] : edges)
    if (shared.size() == 1) boundary.push_back(shared[0]);
  return boundary;
}

/// Throws where elements are of no known kind or have other nodes than it, or where nodes are not there.
void check(const Body& body, Eigen::Index nodes) {
  static const std::map<std::string, std::size_t> sizes{{"point", 2}, {"bar", 2},
                                                        {"T3", 3},    {"T6", 6},
                                                        {"Q4", 4},    {"Q4_mean_dilatation", 4},
                                                        {"Q8", 8},    {"T4", 4},
                                                        {"H8", 8},    {"H8_mean_dilatation", 8}};
  auto lists = body.elements;
  for (const auto& [name, side] : body.sides) lists.push_back(side);
  for (const int node : lists | std::views::join)
    if (node < 0 || node >= nodes) throw BadFile(body.name + " has a node that is not there");
  for (const auto& element : body.elements)
    if (!sizes.contains(body.element) || element.size() != sizes.at(body.element))
      throw BadFile(body.name + " has an element that is no " + body.element);
  if (body.spring() && (!body.sides.contains("node") || !body.sides.contains("anchor")))
    throw BadFile(body.name + " has no node or no anchor");
}

Side named(const Scene& scene, const std::string& word) {
  const Body& body = scene.body(word);
  const auto dot = word.find('.');
  Side side;
  if (dot == std::string::npos)
    for (const auto& element : body.elements) side.nodes.insert(element.begin(), element.end());
  else if (const auto found = body.sides.find(word.substr(dot + 1)); found != body.sides.end())
    side.nodes = {found->second.begin(), found->second.end()};
  else
    throw BadFile("the mesh has no side \"" + word + "\"");
  const bool is_chain = body.element == "bar" && side.nodes.size() > 1;  // with bars of which it has one end
  for (const auto& edge : body.edges) {
    const auto in = std::ranges::count_if(edge, [&](int node) { return side.has(node); });
    if (is_chain ? in > 0 : in == std::ssize(edge)) side.edges.push_back(edge);
  }
  return side;
}

}  // namespace

Vec3 vec3(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.size() > 2 ? json[2].get<double>() : 0};
}

const Json& part(const Json& json, const std::string& key) {
  static const Json none = Json::object();
  const auto found = json.find(key);
  return found == json.end() ? none : *found;
}

double value_at(const Json& value, double time) {
  if (time == at_rest) return 0;
  if (value.is_number()) return value;
  const auto rows = (value.is_object() ? value.at("table") : value).get<std::vector<std::array<double, 2>>>();
  const double repeats = value.is_object() ? value.value("repeat", 1) : 1;
  const double first = rows.front()[0], span = rows.back()[0] - first;
  double t = std::clamp(time, first, first + repeats * span);
  if (repeats > 1) t -= span * std::clamp(std::ceil((t - first) / span - 1e-12) - 1, 0.0, repeats - 1);
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const auto [from, a] = rows[k - 1];
    const auto [to, b] = rows[k];
    if (t <= to) return a + (t - from) / (to - from) * (b - a);
  }
  return rows.back()[1];
}

Motion::Motion(const Json& json) : move(part(json, "move")), rotate(part(json, "rotate")) {
  if (!rotate.empty()) center = vec3(rotate.at("center"));
}

Vec3 Motion::angle(double time) const {
  if (rotate.empty()) return {0, 0, 0};
  const Vec3 axis = rotate.contains("axis") ? vec3(rotate["axis"]).normalized() : Vec3(0, 0, 1);
  return value_at(rotate.at("angle"), time) * std::numbers::pi / 180 * axis;
}

Mat3 Motion::turn(double time) const {
  const Vec3 radians = angle(time);
  return Eigen::AngleAxisd(radians.norm(), radians.stableNormalized()).toRotationMatrix();
}

Vec3 Motion::displacement(const Vec3& X, double time, bool finite) const {
  Vec3 u = Vec3::Zero();
  for (const auto& [axis, value] : move.items()) u[axis[0] - 'x'] = value_at(value, time);
  const Vec3 arm = X - center;
  return u + (finite ? Vec3(turn(time) * arm - arm) : angle(time).cross(arm));
}

Vec3 Motion::back(const Vec3& x, double time) const {
  return center + turn(time).transpose() * (x - displacement(center, time, true) - center);
}

Mat3 Body::stiffness() const {
  const Json& rows = given.at("material").begin().value().at("stiffness");
  Mat3 K = Mat3::Zero();
  for (std::size_t i = 0; i < rows.size(); ++i) K.row(i) = vec3(rows[i]);
  return K;
}

Facets facets_of(const Side& side) {
  Facets facets;
  for (const auto& edge : side.edges) {
    if (edge.size() == 2) facets.push_back({{edge[0], edge[1]}});
    if (edge.size() == 3) facets.insert(facets.end(), {{{edge[0], edge[2]}, edge}, {{edge[2], edge[1]}, edge}});
  }
  return facets;
}

std::vector<std::pair<int, double>> Facet::weights(double s, int derivative) const {
  const double ends_of[2][2] = {{1 - s, s}, {-1, 1}}, bulge = derivative == 0 ? s * (1 - s) : 1 - 2 * s;
  std::vector<std::pair<int, double>> of{{ends[0], ends_of[derivative][0]}, {ends[1], ends_of[derivative][1]}};
  if (!edge.empty()) of.insert(of.end(), {{edge[2], bulge}, {edge[0], -bulge / 2}, {edge[1], -bulge / 2}});
  return of;
}

Vec3 Facet::at(const Field& x, double s, int derivative) const {
  Vec3 place = Vec3::Zero();
  for (const auto& [node, weight] : weights(s, derivative)) place += weight * x.col(node);
  return place;
}

Scene::Scene(const Json& scene, const Json& mesh) : json(scene) {
  const std::string space = scene.value("space", "plane_strain");
  finite = scene.value("strain", "small") == "finite";
  axisymmetric = space == "axisymmetric";
  plane_stress = space == "plane_stress";
  dimension = space == "solid" ? 3 : 2;
  points.resize(3, static_cast<Eigen::Index>(mesh.at("nodes").size()));
  for (Eigen::Index n = 0; n < points.cols(); ++n) points.col(n) = vec3(mesh["nodes"][n]);
  for (const auto& [name, given] : scene.at("bodies").items()) {
    const Json& made = mesh.at("bodies").at(name);
    Body body{name, made.at("element"), given, made.at("elements"), made.at("sides")};
    check(body, points.cols());
    if (!body.spring()) body.edges = body.solid() ? boundary_of(body) : body.elements;
    auto all = body.edges | std::views::join;
    if (body.solid()) body.sides.try_emplace("boundary", all.begin(), all.end());
    bodies.push_back(std::move(body));
  }
}

const Body& Scene::body(const std::string& expression) const {
  const std::string name = expression.substr(0, expression.find_first_of(". "));
  for (const auto& body : bodies)
    if (body.name == name) return body;
  throw BadFile("the scene has no body \"" + name + "\"");
}

Side Scene::side(const std::string& expression) const {
  std::istringstream words(expression);
  std::string word;
  words >> word;
  Side side = named(*this, word);
  for (std::string operation; words >> operation >> word;) {
    const Side other = named(*this, word);
    const bool keep = operation == "&";
    std::erase_if(side.nodes, [&](int node) { return other.has(node) != keep; });
    std::erase_if(side.edges, [&](const Nodes& edge) {
      return keep ? std::ranges::count(other.edges, edge) == 0
                  : std::ranges::none_of(edge, [&](int node) { return side.has(node); });
    });
  }
  return side;
}

double Scene::depth(const Body& body, double x) const {
  return axisymmetric                               ? 2 * std::numbers::pi * x
         : body.element == "bar" || body.in_space() ? 1
                                                    : body.given.value("thickness", 1.0);
}

bool Scene::on_axis(int node) const {
  return axisymmetric && std::abs(points(0, node)) <= 1e-12 * points.cwiseAbs().maxCoeff();
}

}  // namespace stickslip::verify
