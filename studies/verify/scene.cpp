#include "studies/verify/scene.hpp"

#include <sstream>

namespace stickslip::verify {
namespace {

/// Edges of one element alone are of the boundary.
std::vector<Nodes> boundary_of(const Body& body) {
  std::map<std::set<int>, std::vector<Nodes>> edges;
  for (const auto& element : body.elements)
    for (const auto& side : reference(body.element).sides) {
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
  auto lists = body.elements;
  for (const auto& [name, side] : body.sides) lists.push_back(side);
  for (const int node : lists | std::views::join)
    if (node < 0 || node >= nodes) throw BadFile(body.name + " has a node that is not there");
  const Reference& kind = reference(body.element);
  for (const auto& element : body.elements)
    if (std::ssize(element) != kind.nodes.cols() || (body.solid() && kind.sides.empty()))
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
  if (rotate.empty()) return;
  center = vec3(rotate.at("center"));
  if (rotate.contains("axis")) axis = vec3(rotate["axis"]).normalized();
}

double Motion::angle(double time) const {
  return rotate.empty() ? 0 : value_at(rotate.at("angle"), time) * std::numbers::pi / 180;
}

Vec3 Motion::displacement(const Vec3& X, double time, bool finite) const {
  Vec3 u = Vec3::Zero();
  for (const auto& [i, value] : move.items()) u[i[0] - 'x'] = value_at(value, time);
  const Vec3 arm = X - center;
  return u + (finite ? Vec3(turn(time) * arm - arm) : Vec3(angle(time) * axis.cross(arm)));
}

Vec3 Motion::back(const Vec3& x, double time) const {
  return center + turn(time).transpose() * (x - displacement(center, time, true) - center);
}

const Reference& reference(const std::string& element) {
  static const Field line{{0, 1, 0.5}, {0, 0, 0}, {0, 0, 0}},
      triangle{{0, 1, 0, 0.5, 0.5, 0}, {0, 0, 1, 0, 0.5, 0.5}, {0, 0, 0, 0, 0, 0}},
      square{{0, 1, 1, 0, 0.5, 1, 0.5, 0}, {0, 0, 1, 1, 0, 0.5, 1, 0.5}, {0, 0, 0, 0, 0, 0, 0, 0}},
      tetrahedron{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
      cube{{0, 1, 1, 0, 0, 1, 1, 0}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}};
  static const double two = 1 / std::sqrt(3.0), three = std::sqrt(0.6);  // points each way
  const auto same = [](int n, double volume) { return Eigen::VectorXd::Constant(n, volume / n); };
  static const std::map<std::string, Reference> all{
      {"point", {line.leftCols(2)}},
      {"bar", {line.leftCols(2)}},
      {"L2", {line.leftCols(2), {}, two, same(2, 1)}},
      {"L3", {line, {}, three, Vec3(5, 5, 8) / 18}},
      {"T3", {triangle.leftCols(3), {{0, 1}, {1, 2}, {2, 0}}, 0.5, same(3, 0.5)}},
      {"T6", {triangle, {{0, 1, 3}, {1, 2, 4}, {2, 0, 5}}, 0.5, same(3, 0.5)}},
      {"Q4", {square.leftCols(4), {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, two, same(4, 1)}},
      {"Q8",
       {square,
        {{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}},
        three,
        Eigen::VectorXd{{25, 25, 25, 25, 40, 40, 40, 40, 64}} / 324}},
      {"T4", {tetrahedron, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, 0, same(1, 1.0 / 6)}},
      {"H8",
       {cube, {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}, two, same(8, 1)}}};
  static const Reference none;
  const bool averages = element == "Q4_mean_dilatation" || element == "H8_mean_dilatation";
  const auto found = all.find(averages ? element.substr(0, 2) : element);
  return found == all.end() ? none : found->second;
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
