#include "studies/verify/state.hpp"

namespace stickslip::verify {
namespace {

/// Powers of xi against vertices: facets; Catmull-Rom, through the vertices; cubic B-spline, near them.
const Eigen::Matrix4d shapes[3] = {Eigen::Matrix4d{{0, 1, 0, 0}, {0, -1, 1, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}},
                                   Eigen::Matrix4d{{0, 2, 0, 0}, {-1, 0, 1, 0}, {2, -5, 4, -1}, {-1, 3, -3, 1}} / 2,
                                   Eigen::Matrix4d{{1, 4, 1, 0}, {-3, 0, 3, 0}, {3, -6, 3, 0}, {-1, 3, -3, 1}} / 6};

}  // namespace

Master::Master(const Scene& scene, const Json& contact, const std::string& slave, const std::string& master,
               bool integrated)
    : obstacle(part(part(scene.json, "obstacles"), master)), motion(obstacle), scene_(scene), itself_(slave == master) {
  const Json surface = contact.value("surface", Json(scene.finite && !integrated ? "smooth" : "faceted"));
  const std::string kind = surface.is_object() ? surface.value("smooth", "catmull_rom") : surface.get<std::string>();
  smooth_ = kind == "faceted" ? 0 : kind == "b_spline" ? 2 : 1;
  frozen_ = !scene.finite && smooth_ == 0 && !contact.contains("between") && !itself_;
  if (!rigid()) facets = facets_of(scene.side(master));
  std::vector<std::array<int, 2>> lines;
  for (const auto& facet : facets) lines.push_back(facet.ends);
  if (obstacle.contains("polyline")) {  // the solid is on its right
    const Json& points = obstacle["polyline"].at("points");
    const bool closed = points.front() == points.back();
    const int count = static_cast<int>(points.size()) - closed;
    at_.resize(2, count);
    for (int v = 0; v < count; ++v) at_.col(v) = vec3(points[v]).head<2>();
    for (int v = 0; v + 1 < count + closed; ++v) lines.push_back({(v + 1) % count, v});
  }
  for (const auto& [from, to] : lines) patches.push_back({{from, from, to, to}});
  place_vertices(scene.points);
  link(surface.is_object() ? surface.value("corner", 30.0) : 30.0);
  if (itself_) number_nodes();
}

/// Numbers the nodes chain by chain, long ones first. A loop begins at the node that is farthest from the mean of its
/// nodes; of equals, at that with the least x, then y.
void Master::number_nodes() {
  struct Chain {
    double length = 0;
    std::vector<int> nodes = {};
  };
  std::vector<Chain> chains;
  for (int first = 0; first < std::ssize(patches); ++first) {
    const bool is_seen = std::ranges::any_of(
        chains, [&](const Chain& chain) { return std::ranges::count(chain.nodes, patches[first].vertex[1]) > 0; });
    int start = first;
    while (patches[start].beside[0] >= 0 && patches[start].beside[0] != first) start = patches[start].beside[0];
    if (is_seen) continue;
    const bool is_loop = patches[start].beside[0] >= 0;
    Chain chain;
    int p = start;
    do {
      chain.nodes.push_back(patches[p].vertex[1]);
      chain.length += patches[p].length;
      if (patches[p].beside[1] < 0) chain.nodes.push_back(patches[p].vertex[2]);
      p = patches[p].beside[1];
    } while (p >= 0 && p != start);
    Vec2 mean = Vec2::Zero();
    for (const int node : chain.nodes) mean += at_.col(node) / static_cast<double>(chain.nodes.size());
    const double same = at_end * chain.length;
    const auto comes_first = [&](int a, int b) {
      const double apart = (at_.col(a) - mean).norm() - (at_.col(b) - mean).norm(), across = at_(0, a) - at_(0, b);
      return std::abs(apart) > same ? apart > 0 : std::abs(across) > same ? across < 0 : at_(1, a) < at_(1, b);
    };
    if (is_loop) std::ranges::rotate(chain.nodes, std::ranges::min_element(chain.nodes, comes_first));
    chains.push_back(chain);
  }
  std::ranges::stable_sort(chains, [](const Chain& a, const Chain& b) { return a.length > b.length * (1 + at_end); });
  for (const auto& chain : chains)
    for (const int node : chain.nodes) number_.emplace(node, static_cast<int>(number_.size()));
}

/// Neighbours of the patches, corners, and lengths along the master at the start.
void Master::link(double corner) {
  std::map<int, int> starts;
  for (int p = 0; p < std::ssize(patches); ++p) starts[patches[p].vertex[1]] = p;
  for (int p = 0; p < std::ssize(patches); ++p) {
    Patch& patch = patches[p];
    patch.length = line_of(patch).tau.norm();
    if (!starts.contains(patch.vertex[2])) continue;
    Patch& other = patches[patch.beside[1] = starts[patch.vertex[2]]];
    other.beside[0] = p;
    const double cosine = line_of(patch).tau.normalized().dot(line_of(other).tau.normalized());
    if (smooth_ == 0 || cosine < std::cos(corner * std::numbers::pi / 180)) continue;
    patch.vertex[3] = other.vertex[2];
    other.vertex[0] = patch.vertex[1];
  }
  for (const bool loops : {false, true})  // from where a chain begins, then from the first patch of a loop
    for (int first = 0; first < std::ssize(patches); ++first) {
      double length = 0;
      for (int p = loops || patches[first].beside[0] < 0 ? first : -1; p >= 0 && patches[p].arc < 0;) {
        patches[p].arc = length;
        length += patches[p].length;
        p = patches[p].beside[1];
      }
      if (loops) loop = std::max(loop, length);
    }
}

void Master::place_vertices(const Field& x) {
  if (!rigid()) at_ = x.topRows<2>();
}

Eigen::Vector4d Master::functions(const Place& place, int derivative) const {
  const double s = place.xi;
  const Eigen::Vector4d powers[3] = {{1, s, s * s, s * s * s}, {0, 1, 2 * s, 3 * s * s}, {0, 0, 2, 6 * s}};
  Eigen::Vector4d N = shapes[smooth_].transpose() * powers[derivative];
  for (const auto& [end, near, far] : {std::array{0, 1, 2}, {3, 2, 1}}) {  // a vertex that is missing is 2 y_1 - y_2
    if (patches[place.patch].goes_on(end == 3)) continue;
    N[near] += 2 * N[end];
    N[far] -= N[end];
    N[end] = 0;
  }
  return N;
}

Vec2 Master::position(const Place& place, int derivative) const {
  return at_(Eigen::all, patches[place.patch].vertex) * functions(place, derivative);
}

double Master::depth_in(const Facet& facet, int patch, const std::map<int, Touch>& last) const {
  const auto& vertex = patches[patch].vertex;
  const int count = static_cast<int>(patches.size());
  double depth = infinity;
  for (const int node : facet.ends) {
    const bool comes_after = number_.at(vertex[1]) > number_.at(node);
    if (!comes_after || walls_.at(node)[patch] || vertex[1] == node || vertex[2] == node) return -1;
    double share = 0.25;  // of the wall, unless the patch is near what was faced last
    for (const int end : facet.ends)
      if (const auto found = last.find(end); found != last.end() && found->second.faced >= 0) {
        const int apart = std::abs(number_.at(patches[found->second.faced].vertex[1]) - number_.at(vertex[1]));
        if (std::min(apart, count - apart) <= 8) share = 1;
      }
    depth = std::min(depth, share * depths_.at(node));
  }
  return depth;
}

void Master::set_wall(const Seeker& seeker, double size) {
  const Vec2 x = seeker.x.head<2>(), inward = -seeker.outward.normalized();
  double thickness = infinity;
  for (const auto& patch : patches) {
    const Line line = line_of(patch);
    const double xi = line.xi(x, inward), depth = (line.at(xi) - x).dot(inward);
    const bool is_own = patch.vertex[1] == seeker.node || patch.vertex[2] == seeker.node;
    if (!is_own && xi >= 0 && xi <= 1 && depth > 0) thickness = std::min(thickness, depth);
  }
  depths_[seeker.node] = std::max(size, thickness);
  for (const auto& patch : patches) {
    const Line line = line_of(patch);
    const bool is_behind = cross(x - line.from, line.tau) < -at_end * line.tau.squaredNorm();
    const double distance = std::min(line.distance(x), line.distance(x + thickness * inward));
    walls_[seeker.node].push_back(thickness < infinity && is_behind && distance < 2 * thickness + patch.length);
  }
}

bool Master::may_face(const Seeker& seeker, int p) const {
  const Line line = line_of(patches[p]);
  const Vec2 x = seeker.x.head<2>(), across = right_of(line.tau);
  const double against = seeker.outward.dot(across), xi = line.xi(x);
  if (!itself_) return frozen_ || !(against > 0);
  if (std::ranges::count(patches[p].vertex, seeker.node) > 0) return false;
  const bool beside = (x - line.from).dot(across) >= 0 || (xi >= -0.5 && xi <= 1.5);
  return !walls_.at(seeker.node)[p] && against <= -0.5 * seeker.outward.norm() * line.tau.norm() && beside;
}

/// The closest place of all patches, 0 <= xi <= 1; where two end in it, that on whose side of their bisector the point
/// is.
Place Master::closest(const Seeker& seeker) const {
  Place best;
  double least = infinity, least_past = 0;  // distance; how far the point is past the end of the patch
  const Vec2 x = seeker.x.head<2>();
  for (int p = 0; p < std::ssize(patches); ++p) {
    const Line line = line_of(patches[p]);
    if (line.distance(x) > least + 2 * line.tau.norm() || !may_face(seeker, p)) continue;
    Place place{p, std::clamp(line.xi(x), 0.0, 1.0)};
    for (int k = 0; k < 50 && smooth_ > 0; ++k) {  // Newton's method for (x - y) . y' = 0
      const Vec2 off = x - position(place), slope = position(place, 1);
      const double step = off.dot(slope) / std::abs(slope.squaredNorm() - off.dot(position(place, 2)));
      const double last = std::exchange(place.xi, std::clamp(place.xi + std::clamp(step, -0.5, 0.5), 0.0, 1.0));
      if (std::abs(place.xi - last) < 1e-15) break;
    }
    const Vec2 off = x - position(place);
    const double past = std::abs(off.dot(position(place, 1).normalized())), band = at_end * line.tau.norm();
    if (off.norm() >= least - band && !(off.norm() <= least + band && past < least_past)) continue;
    best = place;
    least = off.norm();
    least_past = past;
  }
  return best;
}

/// What a point faces: at a corner also past the end of a patch, and a little past a free end; inside of a master by
/// one face only where it is outside by none that is nearer.
Place Master::find(const Seeker& seeker) const {
  const Vec2 x = seeker.x.head<2>();
  const auto facing = [&](const Seeker& point) {
    Place place = closest(point);
    const bool end = place.xi == 1;
    if (place.patch < 0 || (place.xi > 0 && !end) || patches[place.patch].goes_on(end)) return place;
    for (int k = 0; k < 20; ++k) {
      const Vec2 off = x - position(place), slope = position(place, 1);
      place.xi += off.dot(slope) / (slope.squaredNorm() - off.dot(position(place, 2)));
    }
    const int other = patches[place.patch].beside[end];
    const bool is_free = other < 0 || !may_face(point, other);
    const double past = end ? place.xi - 1 : -place.xi, still_faced = frozen_ ? 1e-6 : 0.01;  // of a facet
    return is_free && past > still_faced ? Place{} : place;
  };
  const auto inside = [&](const Place& place) { return (x - position(place)).dot(right_of(position(place, 1))) < 0; };
  const Place place = facing(seeker);
  if (place.patch < 0 || itself_ || frozen_ || !inside(place) || seeker.outward.isZero()) return place;
  const Place any = facing({seeker.node, seeker.x});
  return any.patch >= 0 && !inside(any) ? Place{} : place;
}

/// Small strain, at a vertex of facets: the bisector of the two, and half of the slide along each of them.
void Master::share_vertex(const Seeker& seeker, Foot& foot) const {
  const bool end = foot.place.xi > 1 - at_end;
  const int here = foot.place.patch, other = patches[here].beside[end];
  if (other < 0 || (!end && foot.place.xi > at_end)) return;
  const Patch &first = patches[end ? here : other], &second = patches[end ? other : here];
  const Line before = line_of(first), after = line_of(second);
  foot.y = in_space(after.from);
  foot.normal = in_space(right_of(before.tau.normalized() + after.tau.normalized()).normalized());
  if (rigid()) return;
  const Vec2 x = seeker.x.head<2>();
  const auto half = [](double slide) { return std::abs(slide) > at_end ? 0 : slide / 2; };
  const double back = half(before.xi(x) - 1), on = half(after.xi(x));
  foot.weights = {{second.vertex[1], on - back - 1}, {first.vertex[1], back}, {second.vertex[2], -on}};
}

Foot Master::foot(const Place& place) const {
  const Eigen::Vector4d N = functions(place);
  Foot foot{true, in_space(position(place)), in_space(right_of(position(place, 1)).normalized()), 0, place};
  for (int i = 0; i < 4 && !rigid(); ++i) foot.weights.emplace_back(patches[place.patch].vertex[i], -N[i]);
  return foot;
}

Foot Master::foot(const Seeker& seeker) const {
  const auto& [node, x, outward] = seeker;
  if (patches.empty()) {
    Foot foot{true};
    if (obstacle.contains("plane")) {
      foot.normal = vec3(obstacle["plane"].at("normal")).stableNormalized();
      foot.gap = foot.normal.dot(x - vec3(obstacle["plane"].at("point")));
    } else {
      const bool has_axis = obstacle.contains("cylinder");
      const Json& round =
          has_axis ? obstacle["cylinder"] : obstacle.at(obstacle.contains("sphere") ? "sphere" : "circle");
      const double side = round.value("inside", false) ? -1 : 1;
      Vec3 arm = x - vec3(round.at(has_axis ? "point" : "center"));
      if (has_axis) {
        const Vec3 axis = vec3(round.at("axis")).normalized();
        arm -= axis.dot(arm) * axis;
      }
      foot.normal = side * arm.normalized();
      foot.gap = side * (arm.norm() - round.at("radius").get<double>());
    }
    foot.y = x - foot.gap * foot.normal;
    return foot;
  }
  const Place faced = find(seeker);
  const Place place = faced.patch >= 0 ? faced : closest({node, x, itself_ ? outward : Vec2(0, 0)});
  if (place.patch < 0) return {};
  Foot foot = this->foot(place);
  if (faced.patch < 0) return {false, foot.y, foot.normal, (x - foot.y).norm(), place};
  if (frozen_ && !rigid()) foot.faces = !(outward.dot(foot.normal.head<2>()) > 0);  // else it looks away
  if (frozen_) share_vertex(seeker, foot);
  if (!scene_.finite && !rigid() && !outward.isZero())  // between two solids: the bisector of their normals
    foot.normal = (foot.normal - in_space(outward).normalized()).normalized();
  foot.gap = foot.normal.dot(x - foot.y);
  return foot;
}

}  // namespace stickslip::verify
