#include "studies/verify/masters.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace stickslip::verify {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Coefficients of 1, xi, xi^2, xi^3 of the four vertices: through them (C1), or near them (C2).
constexpr double catmull_rom[4][4] = {{0, -.5, 1, -.5}, {1, 0, -2.5, 1.5}, {0, .5, 2, -1.5}, {0, 0, -.5, .5}};
constexpr double b_spline[4][4] = {
    {1. / 6, -.5, .5, -1. / 6}, {2. / 3, 0, -1, .5}, {1. / 6, .5, .5, -.5}, {0, 0, 0, 1. / 6}};

/// A patch as a straight line.
struct Line {
  Vec2 from, tau;
  Line(const Eigen::Matrix2Xd& at, const Patch& patch)
      : from(at.col(patch.vertex[1])), tau(at.col(patch.vertex[2]) - at.col(patch.vertex[1])) {}
  double xi(const Vec2& x) const { return (x - from).dot(tau) / tau.squaredNorm(); }
  double distance(const Vec2& x) const { return (x - from - std::clamp(xi(x), 0.0, 1.0) * tau).norm(); }
};

}  // namespace

Master::Master(const Scene& scene, const Json& contact, const std::string& slave, const std::string& master)
    : scene_(scene), itself_(slave == master) {
  const Json surface = contact.value("surface", Json("faceted"));
  const std::string kind = surface.is_string() ? surface.get<std::string>() : surface.value("smooth", "catmull_rom");
  smooth_ = kind == "faceted" ? Smooth::no : kind == "b_spline" ? Smooth::b_spline : Smooth::catmull_rom;
  frozen_ = !scene.finite && smooth_ == Smooth::no && !contact.contains("between") && !itself_;
  obstacle_ = part(part(scene.json, "obstacles"), master.c_str());
  motion = Motion(obstacle_);
  if (obstacle_.empty()) {
    std::map<int, int> number;
    const auto vertex = [&](int node) {
      if (number.emplace(node, static_cast<int>(nodes.size())).second) nodes.push_back(node);
      return number[node];
    };
    for (const auto& edge : scene.side(master).edges) {
      const auto along = edge.size() == 3 ? std::vector<int>{edge[0], edge[2], edge[1]} : edge;
      for (std::size_t k = 1; k < along.size(); ++k)
        patches.push_back({{-1, vertex(along[k - 1]), vertex(along[k]), -1}});
    }
  } else if (obstacle_.contains("polyline")) {  // the solid is on its right
    const Json& points = obstacle_["polyline"].at("points");
    const bool closed = points.front() == points.back();
    const int count = static_cast<int>(points.size()) - closed;
    polyline_.resize(2, count);
    for (int v = 0; v < count; ++v) polyline_.col(v) = vec3(points[v]).head<2>();
    for (int v = 0; v + 1 < count + closed; ++v) patches.push_back({{-1, (v + 1) % count, v, -1}});
  }
  link(surface.is_object() ? surface.value("corner", 30.0) : 30.0);
}

/// Neighbours of the patches, corners, and lengths along the master at the start.
void Master::link(double corner) {
  const auto at = vertices(Field::Zero(3, scene_.points.cols()));
  std::map<int, int> starts;
  for (std::size_t p = 0; p < patches.size(); ++p) starts[patches[p].vertex[1]] = static_cast<int>(p);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    Patch& patch = patches[p];
    patch.length = Line(at, patch).tau.norm();
    const auto next = starts.find(patch.vertex[2]);
    if (next == starts.end()) continue;
    Patch& other = patches[patch.next = next->second];
    other.previous = static_cast<int>(p);
    const double cosine = Line(at, patch).tau.normalized().dot(Line(at, other).tau.normalized());
    if (smooth_ == Smooth::no || cosine < std::cos(corner * std::numbers::pi / 180)) continue;
    patch.vertex[3] = other.vertex[2];
    other.vertex[0] = patch.vertex[1];
  }
  for (const bool loops : {false, true})  // from where a chain begins, then from the first patch of a loop
    for (std::size_t first = 0; first < patches.size(); ++first) {
      if (!loops && patches[first].previous >= 0) continue;
      double length = 0;
      for (int p = static_cast<int>(first); p >= 0 && patches[p].arc < 0; p = patches[p].next) {
        patches[p].arc = length;
        length += patches[p].length;
      }
      if (loops) loop = std::max(loop, length);
    }
}

Eigen::Matrix2Xd Master::vertices(const Field& u) const {
  if (rigid()) return polyline_;
  return scene_.points(Eigen::seqN(0, 2), nodes) + u(Eigen::seqN(0, 2), nodes);
}

/// Weights of the four vertices, or their derivatives by xi. A vertex that is missing is 2 y_1 - y_2.
std::array<double, 4> Master::weights(const Patch& patch, double s, int derivative) const {
  if (smooth_ == Smooth::no) {
    if (derivative > 0) return derivative == 1 ? std::array{0.0, -1.0, 1.0, 0.0} : std::array{0.0, 0.0, 0.0, 0.0};
    return {0, 1 - s, s, 0};
  }
  const double power[3][4] = {{1, s, s * s, s * s * s}, {0, 1, 2 * s, 3 * s * s}, {0, 0, 2, 6 * s}};
  std::array<double, 4> w{};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      w[i] += (smooth_ == Smooth::catmull_rom ? catmull_rom : b_spline)[i][k] * power[derivative][k];
  for (const auto& [end, near, far] : {std::array{0, 1, 2}, {3, 2, 1}}) {
    if (patch.vertex[end] >= 0) continue;
    w[near] += 2 * w[end];
    w[far] -= w[end];
    w[end] = 0;
  }
  return w;
}

Vec2 Master::position(const Eigen::Matrix2Xd& at, const Place& place, int derivative) const {
  const Patch& patch = patches[place.patch];
  const auto w = weights(patch, place.xi, derivative);
  Vec2 y = Vec2::Zero();
  for (int i = 0; i < 4; ++i)
    if (patch.vertex[i] >= 0) y += w[i] * at.col(patch.vertex[i]);
  return y;
}

void Master::set_walls(const std::vector<Seeker>& seekers) {
  const auto at = vertices(Field::Zero(3, scene_.points.cols()));
  for (const auto& [node, x, outward] : seekers) {
    const Vec2 from = x.head<2>(), inward = -outward.normalized();
    double thickness = infinity;
    for (const auto& patch : patches) {
      const Line line(at, patch);
      const double a = cross(inward, line.from - from), b = a + cross(inward, line.tau);
      if (nodes[patch.vertex[1]] == node || nodes[patch.vertex[2]] == node || a * b > 0 || a == b) continue;
      const double depth = (line.from - from + a / (a - b) * line.tau).dot(inward);
      if (depth > 0) thickness = std::min(thickness, depth);
    }
    for (const auto& patch : patches) {
      const Line line(at, patch);
      const bool is_behind = cross(from - line.from, line.tau) < -at_end * line.tau.squaredNorm();
      walls_[node].push_back(thickness < infinity && is_behind &&
                             std::min(line.distance(from), line.distance(from + thickness * inward)) <
                                 2 * thickness + patch.length);
    }
  }
}

bool Master::may_face(const Seeker& seeker, int p, const Eigen::Matrix2Xd& at) const {
  const Line line(at, patches[p]);
  const Vec2 x = seeker.x.head<2>(), across = right_of(line.tau);
  const double against = seeker.outward.dot(across), xi = line.xi(x);
  if (!itself_) return !(against > 0);
  for (const int v : patches[p].vertex)
    if (v >= 0 && nodes[v] == seeker.node) return false;
  const bool beside = (x - line.from).dot(across) >= 0 || (xi >= -0.5 && xi <= 1.5);
  return !walls_.at(seeker.node)[p] && against <= -0.5 * seeker.outward.norm() * line.tau.norm() && beside;
}

/// The closest of the straight lines; of two, the one within which the point is.
Place Master::closest(const Seeker& seeker, const Eigen::Matrix2Xd& at) const {
  Place place;
  double least = infinity;
  for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
    if (!may_face(seeker, p, at)) continue;
    const Line line(at, patches[p]);
    const double xi = line.xi(seeker.x.head<2>()), distance = line.distance(seeker.x.head<2>()),
                 band = at_end * line.tau.norm();
    if (distance >= least - band && !(distance <= least + band && xi >= 0 && xi <= 1)) continue;
    place = {p, xi};
    least = distance;
  }
  return place;
}

/// (x - y) . y' = 0 by Newton's method, from patch to patch.
Place Master::along_patches(const Seeker& seeker, const Eigen::Matrix2Xd& at, Place place) const {
  place.xi = std::clamp(place.xi, 0.0, 1.0);
  int hops = 8;
  for (int k = 0; k < 100; ++k) {
    const Vec2 off = seeker.x.head<2>() - position(at, place), slope = position(at, place, 1);
    const double falls = slope.squaredNorm() - off.dot(position(at, place, 2));
    if (!(falls > 0)) return {};
    const double step = std::clamp(off.dot(slope) / falls, -0.5, 0.5);
    place.xi += step;
    const Patch& patch = patches[place.patch];
    if (place.xi < 0 && patch.vertex[0] >= 0 && hops-- > 0)
      place = {patch.previous, place.xi + 1};
    else if (place.xi > 1 && patch.vertex[3] >= 0 && hops-- > 0)
      place = {patch.next, place.xi - 1};
    if (std::abs(step) < 1e-15) break;
  }
  return place;
}

/// A place beyond the end of its patch: nothing past a free end; at a corner the two lines end in their bisector.
Place Master::past_end(const Seeker& seeker, const Eigen::Matrix2Xd& at, const Place& place) const {
  const int end = place.xi > 1;
  const Patch& patch = patches[place.patch];
  const double free_end = frozen_ ? 1e-6 : 0.01;  // of a facet, up to which the end still counts as the master
  if ((place.xi >= 0 && place.xi <= 1) || patch.vertex[end ? 3 : 0] >= 0) return place;
  const int other = end ? patch.next : patch.previous;
  if (other < 0 || !may_face(seeker, other, at)) return (end ? place.xi - 1 : -place.xi) > free_end ? Place{} : place;
  const Vec2 along =
      position(at, {place.patch, 1.0 * end}, 1).normalized() + position(at, {other, 1.0 - end}, 1).normalized();
  const double side = (seeker.x.head<2>() - at.col(patch.vertex[end ? 2 : 1])).dot(along);
  if (end ? side <= 0 : side >= 0) return place;
  Place on{other, 1.0 - end};
  for (int k = 0; k < 20; ++k) {
    const Vec2 off = seeker.x.head<2>() - position(at, on), slope = position(at, on, 1);
    on.xi += off.dot(slope) / (slope.squaredNorm() - off.dot(position(at, on, 2)));
  }
  return on;
}

Place Master::find(const Seeker& seeker, const Eigen::Matrix2Xd& at) const {
  const auto nearest = [&](const Seeker& of) {
    const Place place = closest(of, at);
    if (place.patch < 0) return place;
    const Place along = smooth_ == Smooth::no ? place : along_patches(of, at, place);
    return along.patch < 0 ? along : past_end(of, at, along);
  };
  const auto inside = [&](const Place& place) {
    return (seeker.x.head<2>() - position(at, place)).dot(right_of(position(at, place, 1))) < 0;
  };
  const Place place = nearest(seeker);
  if (place.patch < 0 || itself_ || frozen_ || !inside(place) || seeker.outward.isZero()) return place;
  const Place any = nearest({seeker.node, seeker.x, Vec2::Zero()});  // outside by the nearest face: inside by no other
  return any.patch >= 0 && !inside(any) ? Place{} : place;
}

/// Small strain, at a vertex of facets: the bisector of the two, and half of the slide along each of them.
void Master::share_vertex(const Seeker& seeker, const Eigen::Matrix2Xd& at, Foot& foot) const {
  const bool end = foot.place.xi > 1 - at_end;
  if (!end && !(foot.place.xi < at_end)) return;
  const Patch& patch = patches[foot.place.patch];
  const int other = end ? patch.next : patch.previous;
  if (other < 0) return;
  const Patch &first = end ? patch : patches[other], &second = end ? patches[other] : patch;
  const int v = second.vertex[1];
  foot.y = in_space(at.col(v));
  foot.normal = in_space(right_of(Line(at, first).tau.normalized() + Line(at, second).tau.normalized()).normalized());
  if (rigid()) return;
  std::map<int, double> w{{v, -1}};
  for (const int to : {first.vertex[1], second.vertex[2]}) {
    const Vec2 tau = at.col(to) - at.col(v);
    const double slide = (seeker.x.head<2>() - at.col(v)).dot(tau) / tau.squaredNorm();
    if (std::abs(slide) > at_end) continue;
    w[v] += slide / 2;
    w[to] -= slide / 2;
  }
  foot.weights.clear();
  for (const auto& [vertex, weight] : w) foot.weights.emplace_back(nodes[vertex], weight);
}

Foot Master::foot(const Seeker& seeker, const Eigen::Matrix2Xd& at) const {
  Foot foot;
  if (!patches.empty()) {
    foot.place = find(seeker, at);
    foot.faces = foot.place.patch >= 0;
    if (!foot.faces) {  // beside the place that is nearest; past a free end that end
      foot.place = closest({seeker.node, seeker.x, itself_ ? seeker.outward : Vec2(0, 0)}, at);
      foot.place.xi = std::clamp(foot.place.xi, 0.0, 1.0);
      return foot;
    }
    const Patch& patch = patches[foot.place.patch];
    const auto w = weights(patch, foot.place.xi, 0);
    foot.y = in_space(position(at, foot.place));
    foot.normal = in_space(right_of(position(at, foot.place, 1)).normalized());
    for (int i = 0; i < 4 && !rigid(); ++i)
      if (patch.vertex[i] >= 0) foot.weights.emplace_back(nodes[patch.vertex[i]], -w[i]);
    if (frozen_) share_vertex(seeker, at, foot);
    if (!scene_.finite && !rigid() && !seeker.outward.isZero())  // between two solids: the bisector of their normals
      foot.normal = (foot.normal - in_space(seeker.outward).normalized()).normalized();
    foot.gap = foot.normal.dot(seeker.x - foot.y);
    return foot;
  }
  foot.faces = true;
  if (obstacle_.contains("plane")) {
    foot.normal = vec3(obstacle_["plane"].at("normal")).stableNormalized();
    foot.gap = foot.normal.dot(seeker.x - vec3(obstacle_["plane"].at("point")));
  } else {
    const Json& circle = obstacle_.begin()->contains("radius") ? *obstacle_.begin() : obstacle_.at("circle");
    const double side = circle.value("inside", false) ? -1 : 1;
    const Vec3 arm = seeker.x - vec3(circle.at("center"));
    foot.normal = side * arm.normalized();
    foot.gap = side * (arm.norm() - circle.at("radius").get<double>());
  }
  foot.y = seeker.x - foot.gap * foot.normal;
  return foot;
}

}  // namespace stickslip::verify
