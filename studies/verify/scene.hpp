/// A scene and a mesh as `verify` reads them: from JSON alone, by code that shares nothing with the solver. Vectors
/// have three components; in a plane the third is zero. What keys mean: docs/scene.md, docs/verify.md.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <ranges>
#include <set>
#include <sstream>

#include "studies/verify/verify.hpp"

namespace stickslip::verify {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Nodes = std::vector<int>;
using Field = Eigen::Matrix3Xd;                       ///< a vector a node
using Weights = std::vector<std::pair<int, double>>;  ///< of nodes

/// The time before a run, when nothing has moved yet: a motion that is there at the time 0 is made in the first step.
constexpr double at_rest = -infinity;

inline Vec3 right_of(const Vec3& tau) { return {tau[1], -tau[0], 0}; }  ///< in a plane, out of a solid on the left

/// Of two or three numbers.
inline Vec3 vec3(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.size() > 2 ? json[2].get<double>() : 0};
}

/// Of nodes at x, the vector area of a face in space: half of what its diagonals, or two edges of a triangle, span.
inline Vec3 area_vector(const Field& x, const Nodes& face) {
  const std::size_t last = face.size() - 1;
  return (x.col(face[last - 1]) - x.col(face[0])).cross(x.col(face[last]) - x.col(face[1])) / 2;
}

/// An empty object where the key is missing.
inline const Json& part(const Json& json, const std::string& key) {
  static const Json none = Json::object();
  const auto found = json.find(key);
  return found == json.end() ? none : *found;
}

/// A value in time: a number, or a table that is linear between its rows, and may be repeated; 0 at rest.
inline double value_at(const Json& value, double time) {
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

/// A rigid motion x = c + R (X - c) + move of a support or an obstacle, by the axes and the angle that it prescribes.
struct Motion {
  Json move, rotate;
  Vec3 center = Vec3::Zero(), axis = Vec3::UnitZ();
  explicit Motion(const Json& json) : move(part(json, "move")), rotate(part(json, "rotate")) {
    if (rotate.empty()) return;
    center = vec3(rotate.at("center"));
    if (rotate.contains("axis")) axis = vec3(rotate["axis"]).normalized();
  }
  bool prescribes(int i) const { return !rotate.empty() || move.contains(std::string(1, "xyz"[i])); }
  /// Radians.
  double angle(double time) const {
    return rotate.empty() ? 0 : value_at(rotate.at("angle"), time) * std::numbers::pi / 180;
  }
  Mat3 turn(double time) const { return Eigen::AngleAxisd(angle(time), axis).toRotationMatrix(); }
  /// Displacement of what is at X at the start; where strains are small, linear in the angle.
  Vec3 displacement(const Vec3& X, double time, bool finite) const {
    Vec3 u = Vec3::Zero();
    for (const auto& [i, value] : move.items()) u[i[0] - 'x'] = value_at(value, time);
    const Vec3 arm = X - center;
    return u + (finite ? Vec3(turn(time) * arm - arm) : Vec3(angle(time) * axis.cross(arm)));
  }
  /// Where it was at the start.
  Vec3 back(const Vec3& x, double time) const {
    return center + turn(time).transpose() * (x - displacement(center, time, true) - center);
  }
};

/// An element in natural coordinates, 0 <= r, s, t <= 1, of triangles and tetrahedra r + s + t <= 1 too.
struct Reference {
  /// Corners, counter-clockwise, then the middles of the sides in turn; in space t = 0 first, the middles of edges in
  /// the order of VTK, then those of faces, and one.
  Field nodes = {};
  /// Edges: two ends, and a middle; in space faces, counter-clockwise from outside, their middles after their corners.
  std::vector<Nodes> sides = {};
  /// Gauss points of full rank: the first nodes (H20: of H27) and then the middle, drawn to the middle.
  double drawn = 0;
  Eigen::VectorXd weights = {};
};

/// Of all elements by name; L2, L3: edges.
inline const std::map<std::string, Reference>& references() {
  static const Field line{{0, 1, 0.5}, {0, 0, 0}, {0, 0, 0}},
      triangle{{0, 1, 0, 0.5, 0.5, 0}, {0, 0, 1, 0, 0.5, 0.5}, {0, 0, 0, 0, 0, 0}},
      square{{0, 1, 1, 0, 0.5, 1, 0.5, 0, 0.5}, {0, 0, 1, 1, 0, 0.5, 1, 0.5, 0.5}, {0, 0, 0, 0, 0, 0, 0, 0, 0}},
      tetrahedron{{0, 1, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0},
                  {0, 0, 1, 0, 0, 0.5, 0.5, 0, 0, 0.5},
                  {0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0.5}},
      cube{{0, 1, 1, 0, 0, 1, 1, 0, .5, 1, .5, 0, .5, 1, .5, 0, 0, 1, 1, 0, 0, 1, .5, .5, .5, .5, .5},
           {0, 0, 1, 1, 0, 0, 1, 1, 0, .5, 1, .5, 0, .5, 1, .5, 0, 0, 1, 1, .5, .5, 0, 1, .5, .5, .5},
           {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1, .5, .5, .5, .5, .5, .5, .5, .5, 0, 1, .5}};
  static const double two = 1 / std::sqrt(3.0), three = std::sqrt(0.6);  // points each way
  const auto same = [](int n, double volume) { return Eigen::VectorXd::Constant(n, volume / n); };
  static const Eigen::VectorXd nine = Eigen::VectorXd{{25, 25, 25, 25, 40, 40, 40, 40, 64}} / 324;
  static const Eigen::VectorXd twenty_seven =
      (Eigen::VectorXd(27) << Eigen::VectorXd::Constant(8, 125), Eigen::VectorXd::Constant(12, 200),
       Eigen::VectorXd::Constant(6, 320), 512)
          .finished() /
      5832;
  static const std::map<std::string, Reference> all{
      {"point", {line.leftCols(2)}},
      {"bar", {line.leftCols(2)}},
      {"L2", {line.leftCols(2), {}, two, same(2, 1)}},
      {"L3", {line, {}, three, Vec3(5, 5, 8) / 18}},
      {"T3", {triangle.leftCols(3), {{0, 1}, {1, 2}, {2, 0}}, 0.5, same(3, 0.5)}},
      {"T6", {triangle, {{0, 1, 3}, {1, 2, 4}, {2, 0, 5}}, 0.5, same(3, 0.5)}},
      {"Q4", {square.leftCols(4), {{0, 1}, {1, 2}, {2, 3}, {3, 0}}, two, same(4, 1)}},
      {"Q8", {square.leftCols(8), {{0, 1, 4}, {1, 2, 5}, {2, 3, 6}, {3, 0, 7}}, three, nine}},
      {"Q9", {square, {}, three, nine}},
      {"T4", {tetrahedron.leftCols(4), {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, 0, same(1, 1.0 / 6)}},
      {"T10",
       {tetrahedron,
        {{0, 2, 1, 6, 5, 4}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}},
        std::sqrt(0.2),
        same(4, 1.0 / 6)}},
      {"H8",
       {cube.leftCols(8),
        {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
        two,
        same(8, 1)}},
      {"H20",
       {cube.leftCols(20),
        {{3, 2, 1, 0, 10, 9, 8, 11},
         {4, 5, 6, 7, 12, 13, 14, 15},
         {0, 1, 5, 4, 8, 17, 12, 16},
         {1, 2, 6, 5, 9, 18, 13, 17},
         {2, 3, 7, 6, 10, 19, 14, 18},
         {3, 0, 4, 7, 11, 16, 15, 19}},
        three,
        twenty_seven}},
      {"H27",
       {cube,
        {{3, 2, 1, 0, 10, 9, 8, 11, 24},
         {4, 5, 6, 7, 12, 13, 14, 15, 25},
         {0, 1, 5, 4, 8, 17, 12, 16, 22},
         {1, 2, 6, 5, 9, 18, 13, 17, 21},
         {2, 3, 7, 6, 10, 19, 14, 18, 23},
         {3, 0, 4, 7, 11, 16, 15, 19, 20}},
        three,
        twenty_seven}}};
  return all;
}

/// Without nodes: there is no such element.
inline const Reference& reference(const std::string& element) {
  static const Reference none;
  const bool averages = element == "Q4_mean_dilatation" || element == "H8_mean_dilatation";
  const auto found = references().find(averages ? element.substr(0, 2) : element);
  return found == references().end() ? none : found->second;
}

struct Body {
  std::string name, element;
  Json given;  ///< its entry in the scene
  std::vector<Nodes> elements;
  std::map<std::string, Nodes> sides;
  std::vector<Nodes> edges = {};  ///< of the boundary, as sides of a Reference
  bool in_space() const { return element.starts_with("H") || element == "T4" || element == "T10"; }
  bool averages() const { return element.ends_with("mean_dilatation"); }
  bool quadratic() const { return element == "Q8" || element == "T6"; }
  bool spring() const { return element == "point"; }
  bool solid() const { return element != "bar" && !spring(); }
  double area() const { return given.value("area", 1.0); }  ///< of bars
  /// Of a spring.
  Mat3 stiffness() const {
    const Json& rows = given.at("material").begin().value().at("stiffness");
    Mat3 K = Mat3::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) K.row(i) = vec3(rows[i]);
    return K;
  }
};

/// Edges of one element alone are of the boundary.
inline std::vector<Nodes> boundary_of(const Body& body) {
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
inline void check(const Body& body, Eigen::Index nodes) {
  auto lists = body.elements;
  for (const auto& [name, side] : body.sides) lists.push_back(side);
  for (const auto& list : lists)
    for (const int node : list)
      if (node < 0 || node >= nodes) throw BadFile(body.name + " has a node that is not there");
  const Reference& kind = reference(body.element);
  for (const auto& element : body.elements)
    if (std::ssize(element) != kind.nodes.cols() || (body.solid() && kind.sides.empty()))
      throw BadFile(body.name + " has an element that is no " + body.element);
  if (body.spring() && (!body.sides.contains("node") || !body.sides.contains("anchor")))
    throw BadFile(body.name + " has no node or no anchor");
}

/// Nodes of a side, and the edges of the boundary that belong to it, in space its faces.
struct Side {
  std::set<int> nodes;
  std::vector<Nodes> edges;
  bool has(int node) const { return nodes.contains(node); }
};

/// The side with each face that has middles cut at them, as contact sees it: into four faces of as many corners; one
/// of eight nodes, which has none within, into a triangle at each corner and the quadrilateral between them. Areas of
/// nodes are shares of these, since corners of the whole have none or a negative one, but if it has nine nodes.
inline Side cut_at_middles(Side side) {
  std::vector<Nodes> facets;
  for (const auto& face : side.edges) {
    const auto count = face.size(), corners = count == 6 ? 3ul : 4ul;
    for (std::size_t k = 0; k < corners && count > 4; ++k) {
      Nodes facet{face[k], face[corners + k], face[corners + (k + corners - 1) % corners]};
      if (count == 9) facet.insert(facet.begin() + 2, face[8]);
      facets.push_back(facet);
    }
    if (count <= 4) facets.push_back(face);
    if (count == 6 || count == 8) facets.emplace_back(face.begin() + static_cast<std::ptrdiff_t>(corners), face.end());
  }
  side.edges = facets;
  return side;
}

/// An edge of a side in the plane, or half of one that has a middle: x(s) = (1 - s) x_a + s x_b, and of a half in
/// addition s (1 - s) (x_middle - (x_start + x_end) / 2).
struct Facet {
  std::array<int, 2> ends;
  Nodes edge = {};  ///< of a half: start, end, middle
  bool has(int node) const { return ends[0] == node || ends[1] == node; }
  /// Of the nodes, at s, or their derivatives.
  Weights weights(double s, int derivative = 0) const {
    const double ends_of[2][2] = {{1 - s, s}, {-1, 1}}, bulge = derivative == 0 ? s * (1 - s) : 1 - 2 * s;
    Weights of{{ends[0], ends_of[derivative][0]}, {ends[1], ends_of[derivative][1]}};
    if (!edge.empty()) of.insert(of.end(), {{edge[2], bulge}, {edge[0], -bulge / 2}, {edge[1], -bulge / 2}});
    return of;
  }
  Vec3 at(const Field& x, double s, int derivative = 0) const {
    Vec3 place = Vec3::Zero();
    for (const auto& [node, weight] : weights(s, derivative)) place += weight * x.col(node);
    return place;
  }
  Vec3 chord(const Field& x) const { return x.col(ends[1]) - x.col(ends[0]); }
  /// Where (y - x(s)) . tau = 0. A bend moves no place over an end.
  double met(const Field& x, const Vec3& y, const Vec3& tau) const {
    double s = (y - x.col(ends[0])).dot(tau) / chord(x).dot(tau);
    const bool bends = !edge.empty() && s > 0 && s < 1;
    for (int k = 0; k < 20 && bends; ++k) s += (y - at(x, s)).dot(tau) / at(x, s, 1).dot(tau);
    return s;
  }
};
using Facets = std::vector<Facet>;

inline Facets facets_of(const Side& side) {
  Facets facets;
  for (const auto& edge : side.edges) {
    if (edge.size() == 2) facets.push_back({{edge[0], edge[1]}});
    if (edge.size() == 3) facets.insert(facets.end(), {{{edge[0], edge[2]}, edge}, {{edge[2], edge[1]}, edge}});
  }
  return facets;
}

/// Facets of an obstacle of a file or a mesh: three or four vertices each, the solid behind them; in the plane two, the
/// solid on the left.
struct RigidFaces {
  Field vertices;  ///< at the start
  std::vector<Nodes> faces;
};

struct Scene {
  Json json;
  bool finite = false, axisymmetric = false, plane_stress = false;
  int dimension = 2;
  Field points;  ///< of all nodes at the start
  std::vector<Body> bodies;
  std::map<std::string, RigidFaces> faces;  ///< of obstacles of a file or a mesh

  Scene(const Json& scene, const Json& mesh) : json(scene) {
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
      Nodes boundary;
      for (const auto& edge : body.edges) boundary.insert(boundary.end(), edge.begin(), edge.end());
      if (body.solid()) body.sides.try_emplace("boundary", boundary);
      bodies.push_back(std::move(body));
    }
    for (const auto& [name, given] : part(mesh, "obstacles").items()) {
      RigidFaces& made = faces[name];
      const Json &vertices = given.at("vertices"), &facets = given.at("facets");
      made.vertices.resize(3, std::ssize(vertices));
      for (Eigen::Index v = 0; v < made.vertices.cols(); ++v) made.vertices.col(v) = vec3(vertices[v]);
      for (const auto& facet : facets) made.faces.push_back(facet.get<Nodes>());
      for (const auto& face : made.faces)
        for (const int v : face)
          if (v < 0 || v >= made.vertices.cols()) throw BadFile("the facets of \"" + name + "\" lack a vertex");
    }
  }
  /// That a side expression begins with.
  const Body& body(const std::string& expression) const {
    const std::string name = expression.substr(0, expression.find_first_of(". "));
    for (const auto& body : bodies)
      if (body.name == name) return body;
    throw BadFile("the scene has no body \"" + name + "\"");
  }
  /// `block.left`, `block.left & block.bottom` (what both share), `block.left - block.top` (without the nodes of the
  /// other; edges stay as long as one of their nodes does).
  Side side(const std::string& expression) const {
    std::istringstream words(expression);
    std::string word;
    words >> word;
    Side side = named(word);
    for (std::string operation; words >> operation >> word;) {
      const Side other = named(word);
      const bool keep = operation == "&";
      std::erase_if(side.nodes, [&](int node) { return other.has(node) != keep; });
      std::erase_if(side.edges, [&](const Nodes& edge) {
        return keep ? std::ranges::count(other.edges, edge) == 0
                    : std::ranges::none_of(edge, [&](int node) { return side.has(node); });
      });
    }
    return side;
  }
  /// What a length at the radius x is multiplied by to be an area.
  double depth(const Body& body, double x) const {
    if (axisymmetric) return 2 * std::numbers::pi * x;
    return body.element == "bar" || body.in_space() ? 1 : body.given.value("thickness", 1.0);
  }
  /// Whether a node is on the axis of revolution, where it has no radial motion.
  bool on_axis(int node) const {
    return axisymmetric && std::abs(points(0, node)) <= 1e-12 * points.cwiseAbs().maxCoeff();
  }
  /// Where nodes count as being: at small strain at their places of the start.
  Field places(const Field& u) const { return points + (finite ? 1.0 : 0.0) * u; }

 private:
  Side named(const std::string& word) const {
    const Body& owner = body(word);
    const auto dot = word.find('.');
    Side side;
    if (dot == std::string::npos)
      for (const auto& element : owner.elements) side.nodes.insert(element.begin(), element.end());
    else if (const auto found = owner.sides.find(word.substr(dot + 1)); found != owner.sides.end())
      side.nodes = {found->second.begin(), found->second.end()};
    else
      throw BadFile("the mesh has no side \"" + word + "\"");
    const bool is_chain = owner.element == "bar" && side.nodes.size() > 1;  // with bars of which it has one end
    for (const auto& edge : owner.edges) {
      const auto in = std::ranges::count_if(edge, [&](int node) { return side.has(node); });
      if (is_chain ? in > 0 : in == std::ssize(edge)) side.edges.push_back(edge);
    }
    return side;
  }
};

}  // namespace stickslip::verify
