/// Masters, and the foot of a point on them by the plainest search there is, every point against every facet
/// (core/README.md, Notation, Along a curve, Finite strain, A side that touches itself). All in the frame of the
/// master: of an obstacle the one that moves with it. At small strain what is faced, n and weights are of the start.
///
///   y(xi) = sum N_i(xi) y_i,   (x - y) . y' = 0,   n across y',   g = n . (x - y)      on facets and smooth patches
///   g = n . (x - p)                                                                    on a plane
///   g = +- (|x - c| - r)                                                               on a circle or sphere; c on the
///                                                                                      axis of a cylinder
#pragma once

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

constexpr double at_end = 1e-9;  ///< share of a facet within which a foot is at its end: rounding of coordinates

struct Line {
  Vec3 from, to, tau = to - from;
  Vec3 at(double xi) const { return from + xi * tau; }
  double xi(const Vec3& x) const { return (x - from).dot(tau) / tau.squaredNorm(); }
  /// Where it is met from x, along a direction.
  double xi(const Vec3& x, const Vec3& along) const {
    return (x - from).dot(right_of(along)) / tau.dot(right_of(along));
  }
  double distance(const Vec3& x) const { return (x - at(std::clamp(xi(x), 0.0, 1.0))).norm(); }
};

/// From vertex 1 to vertex 2; 0 and 3 are their neighbours, where the master is smooth there.
struct Patch {
  std::array<int, 4> vertex;             ///< nodes, or vertices of an obstacle
  std::array<int, 2> beside = {-1, -1};  ///< the patches before and behind it; -1: a free end
  std::array<double, 2> slope = {1, 1};  ///< Catmull-Rom: factors of (y_next - y_previous) / 2 at both ends
  double length = 0, arc = -1;           ///< of the start; along the master to its beginning
  /// Whether it goes on smoothly, into the patch before or behind it.
  bool goes_on(bool end) const { return end ? vertex[3] != vertex[2] : vertex[0] != vertex[1]; }
  bool has(int node) const { return vertex[1] == node || vertex[2] == node; }
};

struct Place {
  int patch = -1;  ///< -1: none
  double xi = 0, eta = 0;
};

struct Foot {
  bool faces = false;
  Vec3 y = Vec3::Zero(), normal = Vec3::UnitY();
  double gap = 0;        ///< of what faces nothing the distance
  Place place = {};      ///< of what faces nothing the nearest
  Weights weights = {};  ///< -N_i of the nodes of a master that deforms
  /// The same of a point that faces nothing.
  Foot away_from(const Vec3& x) const { return {false, y, normal, (x - y).norm(), place}; }
};

/// A slave point that looks for its foot.
struct Seeker {
  int node = -1;
  Vec3 x = Vec3::Zero();
  Vec3 outward = Vec3::Zero();  ///< sum of the normals of its facets, times their lengths; zero: it has none
  double size = 0;              ///< mean length of its facets
  double rounded = 0;         ///< of ends, on an obstacle in space: mean length of the edges of its faces at the start
  bool comes_on = false;      ///< it faced nothing in the last increment
  int faced = -1;             ///< the patch that it faced then; -1: none
  std::vector<Vec3> normals;  ///< of which it is the sum
  /// The sum of those that face a normal of the master within 60 degrees; of all if none does.
  Vec3 against(const Vec3& across) const {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& own : normals)
      if (own.dot(across) <= -0.5 * own.norm() * across.norm()) sum += own;
    return sum.isZero(0) ? outward : sum;
  }
};

/// Cosine by which what is faced looks against the slave's side: no more than 75 degrees from facing it.
constexpr double least_opposed = 0.25;
inline bool opposes(const Vec3& normal, const Vec3& outward) {
  return outward.isZero(0) || normal.dot(outward) < -least_opposed * normal.norm() * outward.norm();
}

/// A place of contact: a slave node, or the multiplier of one. Its weights are 1 of the slave, -N_i of the master. The
/// traction and the springs are of whoever solved it.
struct Touch : Foot {
  int node = -1;
  double area = 0;                                       ///< of the start, on which its traction acts
  Vec3 slip = Vec3::Zero();                              ///< of this increment, across the normal
  bool slip_known = false;                               ///< false: it faced nothing before
  Mat3 turned = Mat3::Identity();                        ///< of directions across the normal in this increment
  Mat3 frame = Mat3::Identity();                         ///< y_s, y_t and n, on a master in space that deforms
  double opening = 0;                                    ///< of the gap in this increment
  Vec3 carried = Vec3::Zero();                           ///< motion of an obstacle's surface there in this increment
  Vec3 relative = Vec3::Zero(), tangent = Vec3::Zero();  ///< w of small strain; m of segments
  double along = 0;                                      ///< Z of segments
  Weights slave = {};                                    ///< weights of the slave's nodes, without those of the master
  int faced = -1;                                        ///< of segments: the patch of the first
  Vec3 traction = Vec3::Zero();                          ///< on the slave, force per area of the start
  Vec2 compliance = Vec2::Zero();  ///< of the springs of a penalty, normal and tangential; zero: multipliers
  double slid = 0;                 ///< slip since the start along e
  Vec3 e() const { return -right_of(normal); }
  double pressure() const { return traction.dot(normal); }
  Vec3 friction() const { return traction - pressure() * normal; }
};

class Master {
 public:
  /// `slave`: side expression; the same as `master` where a side touches itself. `integrated`: over segments.
  Master(const Scene& scene, const Json& contact, const std::string& slave, const std::string& master, bool integrated)
      : obstacle(part(part(scene.json, "obstacles"), master)),
        motion(obstacle),
        scene_(scene),
        itself_(slave == master) {
    const Json surface = contact.value("surface", Json(scene.finite && !integrated ? "smooth" : "faceted"));
    const std::string kind = surface.is_object() ? surface.value("smooth", "catmull_rom") : surface.get<std::string>();
    smooth = kind == "faceted" ? 0 : kind == "b_spline" ? 2 : 1;
    if (surface.is_object()) corner = surface.value("corner", corner);
    frozen_ = !scene.finite && smooth == 0 && !itself_;
    if (!rigid() && scene.dimension == 2) facets = facets_of(scene.side(master));
    if (const auto made = scene.faces.find(master); made != scene.faces.end() && scene.dimension == 2) {
      at = made->second.vertices;
      for (const auto& ends : made->second.faces) facets.push_back({{ends.at(0), ends.at(1)}});
    } else {
      const Json points = part(part(obstacle, "polyline"), "points");  // the solid is on its right
      at.resize(3, std::ssize(points));
      for (int v = 0; v < std::ssize(points); ++v) at.col(v) = vec3(points[v]);
      for (int v = 0; v + 1 < std::ssize(points); ++v)
        facets.push_back({{v + 2 == std::ssize(points) && points.front() == points.back() ? 0 : v + 1, v}});
    }
    for (const auto& [ends, edge] : facets) patches.push_back({{ends[0], ends[0], ends[1], ends[1]}});
    place_vertices(scene.points);
    link();
    number_nodes();
  }

  bool rigid() const { return !obstacle.empty(); }

  /// Where they are from now on, of nodes at x.
  void place_vertices(const Field& x) {
    if (!rigid()) at = x;
  }

  Line line_of(int patch) const { return {at.col(patches[patch].vertex[1]), at.col(patches[patch].vertex[2])}; }

  Vec3 position(const Place& place, int derivative = 0) const {
    return at(Eigen::all, patches[place.patch].vertex) * functions(place, derivative);
  }

  Foot foot(const Seeker& seeker) const {
    const Vec3 &x = seeker.x, &outward = seeker.outward;
    if (patches.empty()) return foot_on_shape(x);
    const Place faced = find(seeker);
    const Place place = faced.patch >= 0 ? faced : closest({seeker.node, x, itself_ ? outward : Vec3(0, 0, 0)});
    if (place.patch < 0) return {};
    const Eigen::Vector4d N = functions(place);
    Foot foot{true, position(place), right_of(position(place, 1)).normalized(), 0, place};
    if (faced.patch < 0) return foot.away_from(x);
    for (int i = 0; i < 4 && !rigid(); ++i) foot.weights.emplace_back(patches[place.patch].vertex[i], -N[i]);
    if (frozen_) share_vertex(seeker, foot);
    if (!scene_.finite && !rigid() && !outward.isZero(0))  // between two solids: the bisector of their normals
      foot.normal = (foot.normal - seeker.against(foot.normal).normalized()).normalized();
    foot.gap = foot.normal.dot(x - foot.y);
    return foot;
  }

  /// The distance of a point that faces nothing; the size of the scene if there is nothing that it may touch.
  Foot nearest(const Seeker& seeker) const {
    if (patches.empty()) return foot_on_shape(seeker.x).away_from(seeker.x);
    const Place place = closest({seeker.node, seeker.x, itself_ ? seeker.outward : Vec3(0, 0, 0)});
    if (place.patch < 0) return {.gap = (at.rowwise().maxCoeff() - at.rowwise().minCoeff()).norm()};
    return Foot{false, position(place), right_of(position(place, 1)).normalized(), 0, place}.away_from(seeker.x);
  }

  /// What a point of a side that touches itself does not face: its own wall. `seeker`: the point at the start.
  void set_wall(const Seeker& seeker) {
    const Vec3 x = seeker.x, inward = -seeker.outward.normalized();
    double thickness = infinity;
    for (int p = 0; p < std::ssize(patches); ++p) {
      const Line line = line_of(p);
      const double xi = line.xi(x, inward), depth = (line.at(xi) - x).dot(inward);
      if (!patches[p].has(seeker.node) && xi >= 0 && xi <= 1 && depth > 0) thickness = std::min(thickness, depth);
    }
    Wall& wall = walls_[seeker.node];
    wall.depth = std::max(seeker.size, thickness);
    for (int p = 0; p < std::ssize(patches); ++p) {
      const Line line = line_of(p);
      const bool is_behind = (x - line.from).dot(right_of(line.tau)) < -at_end * line.tau.squaredNorm();
      const double distance = std::min(line.distance(x), line.distance(x + thickness * inward));
      wall.own.push_back(thickness < infinity && is_behind && distance < 2 * thickness + patches[p].length);
    }
  }

  /// How deep a facet of a side that touches itself may be inside of a patch; negative: it may not face it.
  double depth_in(const Facet& facet, int patch, const std::map<int, Touch>& last) const {
    const auto number_of = [&](int p) { return walls_.at(patches[p].vertex[1]).number; };
    const int count = static_cast<int>(patches.size());
    double depth = infinity;
    for (const int node : facet.ends) {
      const Wall& wall = walls_.at(node);
      if (number_of(patch) <= wall.number || wall.own[patch] || patches[patch].has(node)) return -1;
      double share = 0.25;  // of the wall, unless the patch is near what was faced last
      for (const int end : facet.ends)
        if (const auto found = last.find(end); found != last.end() && found->second.faced >= 0) {
          const int apart = std::abs(number_of(found->second.faced) - number_of(patch));
          if (std::min(apart, count - apart) <= 8) share = 1;
        }
      depth = std::min(depth, share * wall.depth);
    }
    return depth;
  }

  std::vector<Patch> patches;
  Facets facets;       ///< those of the patches
  Field at;            ///< where nodes are, or the vertices of an obstacle
  double loop = 0;     ///< length of a closed master; 0: it is open
  Json obstacle;       ///< empty: the master deforms
  Motion motion;       ///< of an obstacle
  int smooth = 0;      ///< 0: facets, 1: Catmull-Rom, 2: B-spline
  double corner = 30;  ///< degrees by which facets turn at most where they are smooth

 private:
  /// Neighbours of the patches, corners, and lengths.
  void link() {
    std::map<int, int> starts;
    for (int p = 0; p < std::ssize(patches); ++p) starts[patches[p].vertex[1]] = p;
    for (int p = 0; p < std::ssize(patches); ++p) {
      Patch& patch = patches[p];
      patch.length = line_of(p).tau.norm();
      if (!starts.contains(patch.vertex[2])) continue;
      Patch& other = patches[patch.beside[1] = starts[patch.vertex[2]]];
      other.beside[0] = p;
      const Vec3 tau = line_of(p).tau, next = line_of(patch.beside[1]).tau;
      if (smooth == 0 || tau.normalized().dot(next.normalized()) < std::cos(corner * std::numbers::pi / 180)) continue;
      patch.vertex[3] = other.vertex[2];
      other.vertex[0] = patch.vertex[1];
      if (smooth == 2) continue;
      const double ratio = tau.norm() / next.norm(), whole = std::floor(std::max(ratio, 1 / ratio) + 0.381966011250105);
      patch.slope[1] = other.slope[0] = 2 / (1 + whole);
    }
  }

  /// Lengths along the master, and numbers of its nodes: chain by chain, long ones first. A loop begins at the node
  /// that is farthest from the mean of its nodes; of equals, at that with the least x, then y.
  void number_nodes() {
    std::vector<std::pair<double, Nodes>> chains;  // with their lengths
    for (int first = 0; first < std::ssize(patches); ++first) {
      if (patches[first].arc >= 0) continue;
      int start = first;
      while (patches[start].beside[0] >= 0 && patches[start].beside[0] != first) start = patches[start].beside[0];
      const bool is_loop = patches[start].beside[0] == first;
      auto& [length, nodes] = chains.emplace_back();
      for (int p = is_loop ? first : start; p >= 0 && patches[p].arc < 0; p = patches[p].beside[1]) {
        patches[p].arc = length;
        length += patches[p].length;
        nodes.push_back(patches[p].vertex[1]);
        if (patches[p].beside[1] < 0) nodes.push_back(patches[p].vertex[2]);
      }
      if (!is_loop) continue;
      loop = std::max(loop, length);
      const Vec3 mean = at(Eigen::all, nodes).rowwise().mean();
      const auto comes_first = [this, mean, same = at_end * length](int a, int b) {
        const double apart = (at.col(a) - mean).norm() - (at.col(b) - mean).norm(), across = at(0, a) - at(0, b);
        return std::abs(apart) > same ? apart > 0 : std::abs(across) > same ? across < 0 : at(1, a) < at(1, b);
      };
      std::rotate(nodes.begin(), std::ranges::min_element(nodes, comes_first), nodes.end());
    }
    std::ranges::stable_sort(chains, [](auto& a, auto& b) { return a.first > b.first * (1 + at_end); });
    for (const auto& [length, nodes] : chains)
      for (const int node : nodes) walls_.try_emplace(node, Wall{static_cast<int>(walls_.size())});
  }

  /// N_i of the vertices of a patch, or their derivatives.
  Eigen::Vector4d functions(const Place& place, int derivative = 0) const {
    // powers of xi against vertices: facets; Catmull-Rom, through the vertices; cubic B-spline, near them
    static const Eigen::Matrix4d shapes[3] = {
        Eigen::Matrix4d{{0, 1, 0, 0}, {0, -1, 1, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}},
        Eigen::Matrix4d{{0, 2, 0, 0}, {-1, 0, 1, 0}, {2, -5, 4, -1}, {-1, 3, -3, 1}} / 2,
        Eigen::Matrix4d{{1, 4, 1, 0}, {-3, 0, 3, 0}, {3, -6, 3, 0}, {-1, 3, -3, 1}} / 6};
    const double s = place.xi;
    const Eigen::Vector4d powers[3] = {{1, s, s * s, s * s * s}, {0, 1, 2 * s, 3 * s * s}, {0, 0, 2, 6 * s}};
    Eigen::Vector4d N = shapes[smooth].transpose() * powers[derivative];
    const Patch& patch = patches[place.patch];
    for (const auto& [end, near, far] : {std::array{0, 1, 2}, {3, 2, 1}}) {
      const bool goes_on = patch.goes_on(end == 3);  // else 2 y_near - y_far stands for the outer vertex
      const double slope = patch.slope[end == 3];    // y_far + slope (y_end - y_far)
      N[near] += goes_on ? 0 : 2 * N[end];
      N[far] += (goes_on ? 1 - slope : -1) * N[end];
      N[end] *= goes_on ? slope : 0;
    }
    return N;
  }

  bool may_face(const Seeker& seeker, int p) const {
    const Line line = line_of(p);
    const Vec3 across = right_of(line.tau);
    const double against = seeker.outward.dot(across), xi = line.xi(seeker.x);
    if (!itself_) return frozen_ || verify::opposes(across, seeker.outward);
    if (std::ranges::count(patches[p].vertex, seeker.node) > 0) return false;
    const bool beside = (seeker.x - line.from).dot(across) >= 0 || (xi >= -0.5 && xi <= 1.5);
    return !walls_.at(seeker.node).own[p] && against <= -0.5 * seeker.outward.norm() * line.tau.norm() && beside;
  }

  bool opposes(const Seeker& seeker, int p) const {
    return rigid() || verify::opposes(right_of(line_of(p).tau), seeker.outward);
  }

  /// The closest place of all patches, 0 <= xi <= 1; where two end in it, that on whose side of their bisector the
  /// point is.
  Place closest(const Seeker& seeker) const {
    Place best;
    double least = infinity, least_past = 0;  // distance; how far the point is past the end of the patch
    const Vec3& x = seeker.x;
    for (int p = 0; p < std::ssize(patches); ++p) {
      const Line line = line_of(p);
      if (line.distance(x) > least + 2 * line.tau.norm() || !may_face(seeker, p)) continue;
      Place place{p, std::clamp(line.xi(x), 0.0, 1.0)};
      for (int k = 0; k < 50 && smooth > 0; ++k) {  // Newton's method for (x - y) . y' = 0
        const Vec3 off = x - position(place), slope = position(place, 1);
        const double step = off.dot(slope) / std::abs(slope.squaredNorm() - off.dot(position(place, 2)));
        const double last = std::exchange(place.xi, std::clamp(place.xi + std::clamp(step, -0.5, 0.5), 0.0, 1.0));
        if (std::abs(place.xi - last) < 1e-15) break;
      }
      const Vec3 off = x - position(place);
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
  Place find(const Seeker& seeker) const {
    const Vec3& x = seeker.x;
    const auto facing = [&](const Seeker& point) {
      Place place = closest(point);
      if (place.patch < 0) return place;
      bool end = place.xi > 1 - at_end;
      const bool inside = place.xi > at_end && !end;
      if (frozen_ && !opposes(point, place.patch)) {  // at a corner, the other patch of it may
        const int other = inside ? -1 : patches[place.patch].beside[end];
        if (other < 0 || !opposes(point, other)) return Place{};
        end = !end;
        place = {other, end ? 1.0 : 0.0};
      }
      if ((place.xi > 0 && place.xi < 1) || patches[place.patch].goes_on(end)) return place;
      for (int k = 0; k < 20 && std::abs(place.xi - 0.5) < 1.5; ++k) {  // (a cubic far past its end overflows)
        const Vec3 off = x - position(place), slope = position(place, 1);
        place.xi += off.dot(slope) / (slope.squaredNorm() - off.dot(position(place, 2)));
      }
      const int other = patches[place.patch].beside[end];
      const bool is_free = other < 0 || !may_face(point, other) || (frozen_ && !opposes(point, other));
      const double past = end ? place.xi - 1 : -place.xi, still_faced = frozen_ ? 1e-6 : 0.01;  // of a facet
      return is_free && past > still_faced ? Place{} : place;
    };
    const auto gap = [&](const Place& place) {
      return (x - position(place)).dot(right_of(position(place, 1)).normalized());
    };
    const Place place = facing(seeker);
    if (place.patch < 0 || itself_ || frozen_ || seeker.outward.isZero(0)) return place;
    const double size = line_of(place.patch).tau.norm();
    if (gap(place) >= -1e-6 * size) return place;
    const Place any = facing({seeker.node, x});
    if (any.patch < 0) return place;
    const bool is_beside = !seeker.comes_on && gap(place) > -0.25 * size &&
                           !verify::opposes(right_of(position(any, 1)), right_of(position(place, 1)));
    return gap(any) >= (is_beside ? 0.01 * size : 0) ? Place{} : place;  // (a little past the end of a sole)
  }

  /// Small strain, at a vertex of facets: the bisector of the two, and half of the slide along each of them.
  void share_vertex(const Seeker& seeker, Foot& foot) const {
    const bool end = foot.place.xi > 1 - at_end;
    const int here = foot.place.patch, other = patches[here].beside[end];
    if (other < 0 || (!end && foot.place.xi > at_end) || !opposes(seeker, other)) return;
    const int first = end ? here : other, second = end ? other : here;
    const Line before = line_of(first), after = line_of(second);
    foot.y = after.from;
    foot.normal = right_of(before.tau.normalized() + after.tau.normalized()).normalized();
    if (rigid()) return;
    const auto half = [](double slide) { return std::abs(slide) > at_end ? 0 : slide / 2; };
    const double back = half(before.xi(seeker.x) - 1), on = half(after.xi(seeker.x));
    const auto& vertex = patches[second].vertex;
    foot.weights = {{vertex[1], on - back - 1}, {patches[first].vertex[1], back}, {vertex[2], -on}};
  }

  /// On a plane; a circle or sphere; a cylinder from its axis.
  Foot foot_on_shape(const Vec3& x) const {
    const char* kind = "plane";
    for (const char* round : {"circle", "sphere", "cylinder"})
      if (obstacle.contains(round)) kind = round;
    const Json& shape = obstacle.at(kind);
    Vec3 arm = x - vec3(shape.at(shape.contains("center") ? "center" : "point"));
    Foot foot{true};
    if (shape.contains("normal")) {
      foot.normal = vec3(shape["normal"]).stableNormalized();
      foot.gap = foot.normal.dot(arm);
    } else {
      const double side = shape.value("inside", false) ? -1 : 1;
      const Vec3 axis = shape.contains("axis") ? vec3(shape["axis"]).normalized() : Vec3(0, 0, 0);
      arm -= axis.dot(arm) * axis;
      foot.normal = side * arm.normalized();
      foot.gap = side * (arm.norm() - shape.at("radius").get<double>());
    }
    foot.y = x - foot.gap * foot.normal;
    return foot;
  }

  /// Of a node of a side that touches itself.
  struct Wall {
    int number = 0;              ///< of the node, along the side
    double depth = 0;            ///< thickness, or the size of its facets
    std::vector<char> own = {};  ///< the patches of it
  };

  const Scene& scene_;
  bool itself_ = false, frozen_ = false;  ///< frozen: facets of the start, at small strain
  std::map<int, Wall> walls_;
};

}  // namespace stickslip::verify
