/// The gap, normal and slip of the places of a contact: at nodes, or weighted over segments (core/README.md, A point
/// that comes on, Segment integration).
///
///   small strain:   g = g_0 + offset + n . w,   w = sum of weights u - u_obstacle,   slip = what w grew by, across n
///   finite strain:  slip = y(xi) - y(xi_last) on the master as it is now, across n; of an obstacle both in its frame
///   segments:  g_j = n_j . 1/A_j int psi_j (x_s - y) dA,   along a master slip = |m_j| (Z_j - Z_j,last), e_j along
///              m_j = 1/A_j int psi_j dy/dS dA,   Z_j = 1/A_j int psi_j (S(y) + S_s) dA
#pragma once

#include "studies/verify/faces.hpp"
#include "studies/verify/masters.hpp"
#include "studies/verify/overlaps.hpp"
#include "studies/verify/solids.hpp"

namespace stickslip::verify {

/// The rotation that takes one unit vector to another the shortest way; in the plane about its normal.
inline Mat3 shortest_turn(const Vec3& from, const Vec3& to) {
  const Vec3 across = from.cross(to);
  const double sine = across.norm();
  const Vec3 axis = sine > 0 ? Vec3(across / sine) : Vec3(0, 0, 1);
  return Eigen::AngleAxisd(std::atan2(sine, from.dot(to)), axis).toRotationMatrix();
}

/// A contact of a slave side and a master.
class Contact {
 public:
  /// `sides`: {"of": entry of the scene, "slave", "master"}.
  Contact(const Scene& scene, const std::string& called, const Json& sides)
      : name(called),
        group(sides.at("of")),
        given(scene.json.at("contacts").at(group)),
        itself(sides.at("slave") == sides.at("master")),
        segment(is_integrated(scene, given, sides)),
        scene_(scene),
        body_(scene.body(sides.at("slave"))),
        side_(cut_at_middles(scene.side(sides.at("slave")))),
        master_(scene, given, sides.at("slave"), sides.at("master"), segment),
        facets_(body_.in_space() ? Facets{} : facets_of(side_)),
        areas_(areas_of(scene, body_, body_.element == "H27" ? scene.side(sides.at("slave")) : side_)) {
    const auto rigid = scene.faces.find(sides.at("master"));
    if (body_.in_space() && segment) {
      integrate(scene.side(sides.at("slave")), sides.at("master"), rigid);
    } else if (body_.in_space() && rigid != scene.faces.end())
      faces_.emplace(rigid->second.vertices, rigid->second.faces, master_.smooth, master_.corner, true);
    else if (body_.in_space() && !master_.rigid())
      faces_.emplace(scene.points, cut_at_middles(scene.side(sides.at("master"))).edges, master_.smooth, master_.corner,
                     scene.finite);
    for (auto& [node, area] : areas_)
      if (side_.edges.empty() && body_.element == "bar") area = body_.area();
    std::map<int, Vec3> before;
    for (const auto& facet : facets_) before[facet.ends[1]] = facet.chord(scene.points).normalized();
    for (const auto& facet : facets_) {
      const auto found = before.find(facet.ends[0]);
      const bool is_inner = segment && scene.finite && found != before.end();
      if (is_inner && found->second.dot(facet.chord(scene.points).normalized()) < 0.5 - at_end)
        corners_.insert(facet.ends[0]);
    }
    std::vector<Seeker> seekers;
    for (const int node : side_.nodes) seekers.push_back(seeker(node, scene.points));
    if (itself && faces_) faces_->touch_itself(seekers);
    for (const Seeker& at : seekers)
      if (itself && !faces_) master_.set_wall(at);
    std::erase_if(areas_, [&](const auto& of) {
      const int node = of.first;  // (no area is left on the axis)
      if (body_.in_space() && segment) return false;
      if (!segment) return body_.quadratic() && scene.axisymmetric && scene.points(0, node) == 0;
      return of.second == 0 || std::ranges::none_of(facets_, [&](const Facet& facet) { return carries(node, facet); });
    });
    advance(Field::Zero(3, scene.points.cols()), at_rest);  // slip is measured from the start
  }

  /// Moves all places to displacements. Call it in order of time.
  void advance(const Field& u, double time) {
    Field x = scene_.places(u);  // in the frame of the master
    for (Eigen::Index n = 0; n < x.cols() && scene_.finite; ++n) x.col(n) = master_.motion.back(x.col(n), time);
    master_.place_vertices(x);
    if (faces_ && !master_.rigid()) faces_->place_nodes(x);
    last = std::exchange(touches, {});
    for (const auto& [node, area] : areas_) {
      Touch& touch = touches[node];
      Seeker point = seeker(node, x);
      point.comes_on = last.contains(node) && !last.at(node).faces;
      point.faced = last.contains(node) && last.at(node).faces ? last.at(node).place.patch : -1;
      touch = segment && body_.in_space() ? over_samples(node)
              : segment                   ? on_pieces(node, x)
                                          : Touch{faces_ ? faces_->foot(point) : master_.foot(point), node, area};
      if (faces_ && master_.rigid()) touch.weights.clear();
      if (!segment) touch.slave.emplace_back(touch.weights.emplace_back(node, 1));
      move(touch, last[node], u, time);
    }
    last_time_ = time;
  }

  std::string name, group;
  Json given;                          ///< its entry in the scene
  bool itself, segment;                ///< it is a side that touches itself; it is integrated over segments
  std::map<int, Touch> touches, last;  ///< the places by slave node, now and in the last increment
  double heat = 0;                     ///< of plastic slip since the start; NaN: not known

 private:
  /// Part of a slave facet that sees one patch of the master (-1: an obstacle without patches) along its normal;
  /// whether the two are opposite, or the patch looks its way.
  struct Part {
    int patch;
    double from, to;
    bool is_opposite = true;
  };

  /// Whether a contact is integrated over segments. At finite strain it is by default between sides of solid bodies,
  /// and against a polyline or a side of a mesh, of no given surface.
  static bool is_integrated(const Scene& scene, const Json& given, const Json& sides) {
    if (given.contains("discretization")) return given["discretization"] == "segment";
    const std::string slave = sides.at("slave");
    const Json& obstacle = part(part(scene.json, "obstacles"), sides.at("master"));
    return scene.finite && scene.dimension == 2 && !given.contains("surface") && scene.body(slave).solid() &&
           !scene.side(slave).edges.empty() &&
           (obstacle.empty() || obstacle.contains("polyline") || obstacle.contains("mesh_side"));
  }

  Seeker seeker(int node, const Field& x) const {
    Seeker seeker{node, x.col(node)};
    const auto add = [&](const Vec3& normal) {
      seeker.outward += normal;
      seeker.normals.push_back(normal);
    };
    double count = 0;
    for (const auto& facet : facets_) {
      if (!facet.has(node)) continue;
      if (body_.solid()) add(right_of(facet.chord(x)));
      seeker.size += (facet.chord(x).norm() - seeker.size) / ++count;
    }
    for (const auto& face : side_.edges)
      if (faces_ && std::ranges::count(face, node) > 0) add(area_vector(x, face));
    if (faces_ && scene_.finite && master_.rigid()) seeker.rounded = size_of_faces(node);
    return seeker;
  }

  /// Mean length of the edges of the faces at a node, at the start.
  double size_of_faces(int node) const {
    double sum = 0, count = 0;
    for (const auto& face : side_.edges)
      for (std::size_t j = 0; std::ranges::count(face, node) > 0 && j < face.size(); ++j, ++count)
        sum += (scene_.points.col(face[j]) - scene_.points.col(face[(j + 1) % face.size()])).norm();
    return count > 0 ? sum / count : 0;
  }

  /// Whether a node carries a multiplier on a facet. A corner carries none if the other node does, since two faces that
  /// meet in it face other masters.
  bool carries(int node, const Facet& facet) const {
    const int other = facet.ends[facet.ends[0] == node];
    const bool is_left_out = corners_.contains(node) && !corners_.contains(other) && side_.has(other);
    return facet.has(node) && side_.has(node) && !is_left_out;
  }

  /// What a slave facet sees of each patch.
  std::vector<Part> shadows(const Facet& facet, const Field& x) const {
    const Vec3 tau = facet.chord(x), nu = right_of(tau).normalized();
    std::vector<Part> seen;
    for (int p = 0; p < std::ssize(master_.patches); ++p) {
      const Patch& patch = master_.patches[p];
      const Line line = master_.line_of(p);
      const auto cast = [&](const Vec3& y, bool is_free) {  // sides that end together, do so to 1e-6 of a facet
        const double xi = facet.met(x, y, tau), end = std::clamp(std::round(xi), 0.0, 1.0);
        return is_free && scene_.finite && std::abs(xi - end) <= 1e-6 ? end : xi;
      };
      const double at_to = cast(line.to, patch.beside[1] < 0), at_from = cast(line.from, patch.beside[0] < 0);
      const auto [low, high] = std::minmax(at_to, at_from);
      const double against = -nu.dot(right_of(line.tau)) / line.tau.norm();
      const bool is_opposite =
          itself ? against > 0.5 && master_.depth_in(facet, p, last) >= 0 : against > least_opposed;
      if ((!is_opposite && against >= -at_end) || std::min({high, 1 - low, high - low}) <= at_end) continue;
      if (!itself || patch.vertex[1] != facet.ends[0]) seen.push_back({p, low, high, is_opposite});
    }
    return seen;
  }

  /// Cuts a slave facet where what it faces changes: of master facets, seen along its normal, the nearest. What is
  /// beyond the other face of a solid is inside of none of its faces.
  std::vector<Part> cut(const Facet& facet, const Field& x) const {
    if (master_.patches.empty()) return {{-1, 0, 1}};
    const auto seen = shadows(facet, x);
    std::set<double> breaks{0, 1};
    for (const auto& shadow : seen)
      for (const double xi : {shadow.from, shadow.to})
        if (shadow.is_opposite && xi > at_end && xi < 1 - at_end) breaks.insert(xi);
    std::vector<Part> pieces;
    for (auto to = std::next(breaks.begin()); to != breaks.end(); ++to) {
      const double from = *std::prev(to), middle = (from + *to) / 2;
      const Vec3 y = x.col(facet.ends[0]) + middle * facet.chord(x), nu = right_of(facet.chord(x)).normalized();
      Part piece{-1, from, *to};
      double least = infinity, least_inside = infinity;  // distance, and depth in what looks its way
      bool is_inside = false;
      for (const auto& [p, low, high, is_opposite] : seen) {
        if (middle < low || middle > high) continue;
        const Line line = master_.line_of(p);
        const double depth = (y - line.at(line.xi(y, nu))).dot(nu);
        if (!is_opposite && depth > 0) least_inside = std::min(least_inside, depth);
        if (!is_opposite || std::abs(depth) >= least) continue;
        if (itself && depth > master_.depth_in(facet, p, last)) continue;
        piece.patch = p;
        least = std::abs(depth);
        is_inside = depth > 0;
      }
      const bool is_beyond = is_inside && least_inside < least;
      if (piece.patch < 0 || is_beyond || *to - from <= at_end) continue;
      if (!pieces.empty() && pieces.back().patch == piece.patch && pieces.back().to == from)
        pieces.back().to = *to;  // what ends there is behind it
      else
        pieces.push_back(piece);
    }
    return pieces;
  }

  /// Adds int psi ... dA of a piece, by three Gauss points; psi is 1 where the facet's other node carries none. What is
  /// seen at more than 60 degrees counts less, at 75 nothing. The length int psi dS.
  double integrate(const Facet& facet, const Part& piece, int node, const Field& x, Touch& touch) const {
    const auto& [p, from, to, is_opposite] = piece;
    const bool end = node == facet.ends[1], sole = !carries(facet.ends[!end], facet);
    const double chord = facet.chord(scene_.points).norm();
    const Vec3 tau = facet.chord(x);
    double share = 0;
    for (const auto& point : gauss_points("L3")) {
      const double s = from + (to - from) * point.at[0], psi = sole ? 1 : end ? s : 1 - s;
      double length = psi * (to - from) * point.weight * facet.at(scene_.points, s, 1).norm(),
             dA = length * scene_.depth(body_, facet.at(scene_.points, s)[0]);
      const Vec3 x_s = facet.at(x, s);
      Foot foot;
      if (p < 0) {
        foot = master_.foot({node, x_s});
      } else {
        const Patch& patch = master_.patches[p];
        const Facet& of = master_.facets[p];
        const double eta = of.met(master_.at, x_s, tau);
        const Vec3 slope = of.at(master_.at, eta, 1), across = right_of(facet.at(x, s, 1)).normalized();
        foot = {true, of.at(master_.at, eta), right_of(slope).normalized()};
        const double against = std::clamp(-across.dot(foot.normal) / least_opposed - 1, 0.0, 1.0);
        dA *= against * against * (3 - 2 * against);
        length *= against * against * (3 - 2 * against);
        if (!master_.rigid()) {
          foot.normal -= across;
          for (const auto& [n, weight] : of.weights(eta)) foot.weights.emplace_back(n, -weight);
        }
        touch.tangent += dA / patch.length * slope;
        const double turns =  // from the seam of a loop on, arcs go on as from the first patch that is faced
            master_.loop > 0 ? std::round((master_.patches[touch.faced].arc - patch.arc) / master_.loop) : 0;
        touch.along += dA * (patch.arc + turns * master_.loop + eta * patch.length + (end ? s - 1 : s) * chord);
      }
      share += length;
      touch.area += dA;
      touch.relative += dA * (x_s - foot.y);
      touch.normal += dA * foot.normal;
      touch.y += dA * foot.y;
      for (const auto& [n, weight] : foot.weights) touch.weights.emplace_back(n, dA * weight);
      for (const auto& [n, weight] : facet.weights(s)) touch.slave.emplace_back(n, dA * weight);
    }
    return share;
  }

  Touch on_pieces(int node, const Field& x) const {
    Touch touch{{true}, node};
    touch.normal.setZero();
    double share = 0, whole = 0, whole_area = 0;  // the first two lengths
    for (const auto& facet : facets_) {
      if (!carries(node, facet)) continue;
      const bool is_shared = carries(facet.ends[0], facet) && carries(facet.ends[1], facet);
      whole += facet.chord(scene_.points).norm() / (is_shared ? 2 : 1);
      for (const auto& point : gauss_points("L3")) {
        const double s = point.at[0], psi = !is_shared ? 1 : node == facet.ends[1] ? s : 1 - s;
        whole_area += psi * point.weight * facet.at(scene_.points, s, 1).norm() *
                      scene_.depth(body_, facet.at(scene_.points, s)[0]);
      }
      for (const auto& piece : cut(facet, x)) {
        if (touch.faced < 0) touch.faced = piece.patch;
        share += integrate(facet, piece, node, x, touch);
      }
    }
    const bool along_curve = scene_.finite && !master_.patches.empty();
    if (share <= (along_curve ? 0.01 : 1e-12) * whole) return {master_.nearest(seeker(node, x)), node};
    touch.normal = (along_curve ? right_of(touch.tangent) : touch.normal).normalized();
    touch.gap = touch.relative.dot(touch.normal) / touch.area;
    if (const double faces = touch.area / whole_area; along_curve && faces < 0.1)  // its end is rounded off
      touch.gap += 0.01 * whole * (0.1 / faces - 1) * (0.1 / faces - 1);
    touch.y /= touch.area;
    touch.tangent /= touch.area;
    touch.along /= touch.area;
    touch.weights.insert(touch.weights.end(), touch.slave.begin(), touch.slave.end());
    for (auto* of : {&touch.weights, &touch.slave})
      for (auto& [n, weight] : *of) weight /= touch.area;
    return touch;
  }

  /// Finds the places of Gauss of a contact in space.
  template <class Rigid>
  void integrate(const Side& slave, const std::string& master, const Rigid& rigid) {
    slave_parts_ = parts_of(slave);
    if (rigid != scene_.faces.end()) {
      master_parts_ = parts_of({{}, rigid->second.faces});
      samples_ = Overlaps(scene_.points, rigid->second.vertices, slave_parts_, master_parts_).samples;
    } else if (master_.rigid()) {
      samples_ = Overlaps(scene_.points, slave_parts_, [this](const Vec3& x) { return master_.foot({-1, x}); }).samples;
    } else {
      master_parts_ = parts_of(scene_.side(master));
      samples_ = Overlaps(scene_.points, scene_.points, slave_parts_, master_parts_).samples;
    }
  }

  /// psi of a node at a place of a face: its shape function there, and an equal share of those of nodes that carry no
  /// multiplier.
  double psi(int node, const Sample& at) const {
    const Nodes& corners = at.slave->corners;
    const Shape N = shape(corners.size() == 3 ? "T3" : "Q4", {at.at[0], at.at[1], 0});
    double psi = 0;
    const auto carrying = std::ranges::count_if(corners, [&](int corner) { return side_.has(corner); });
    for (int k = 0; k < std::ssize(corners); ++k)
      psi += corners[k] == node ? N.value[k] : side_.has(corners[k]) ? 0 : N.value[k] / static_cast<double>(carrying);
    return psi;
  }

  Touch over_samples(int node) const {
    Touch touch{{true}, node};
    touch.normal.setZero();
    for (const auto& at : samples_) {
      if (std::ranges::count(at.slave->corners, node) == 0) continue;
      const double dA = psi(node, at) * at.area;
      touch.area += dA;
      touch.relative += dA * (at.x.y - at.y.y);
      touch.normal += dA * (master_.rigid() ? at.normal : at.normal - at.x.across.normalized());
      touch.y += dA * at.y.y;
      for (const auto& [n, weight] : at.x.weights) touch.slave.emplace_back(n, dA * weight);
      if (master_.rigid()) continue;
      for (const auto& [n, weight] : at.y.weights) touch.weights.emplace_back(n, -dA * weight);
    }
    if (touch.area <= 1e-12 * areas_.at(node)) return {Foot{}, node};
    touch.normal.normalize();
    touch.gap = touch.relative.dot(touch.normal) / touch.area;
    touch.y /= touch.area;
    touch.weights.insert(touch.weights.end(), touch.slave.begin(), touch.slave.end());
    for (auto* of : {&touch.weights, &touch.slave})
      for (auto& [n, weight] : *of) weight /= touch.area;
    return touch;
  }

  /// What a place did since the last increment. Its gap and normal are those in the frame of the master, at small
  /// strain those of the start.
  void move(Touch& touch, const Touch& last, const Field& u, double time) const {
    const Motion& motion = master_.motion;
    const bool on_curve = touch.place.patch >= 0 && last.place.patch >= 0;
    const Vec3 moved = motion.displacement(touch.y, time, scene_.finite);
    touch.carried = moved - motion.displacement(touch.y, last_time_, scene_.finite);
    touch.slip_known = touch.faces && (last.faces || on_curve || !scene_.finite);
    if (!scene_.finite) {
      touch.relative = -moved;
      for (const auto& [node, weight] : touch.weights) touch.relative += weight * u.col(node);
      touch.gap += touch.normal.dot(touch.relative);
      touch.slip = touch.relative - last.relative;
    } else if (segment && !master_.patches.empty()) {
      const double way = touch.along - last.along;
      touch.slip = (master_.loop > 0 ? std::remainder(way, master_.loop) : way) * touch.tangent;
    } else {
      touch.slip = touch.y - (!on_curve ? last.y
                              : faces_  ? faces_->position(last.place)
                                        : master_.position(last.place));
    }
    if (scene_.finite) {  // with what the master does at the last foot, then from normal to normal the shortest way
      Mat3 turn = motion.turn(time) * motion.turn(last_time_).transpose();
      touch.normal = motion.turn(time) * touch.normal;
      touch.slip = motion.turn(time) * touch.slip;
      if (faces_ && touch.place.patch >= 0) touch.frame = faces_->frame(touch.place);
      if (faces_ && on_curve && !master_.rigid()) {
        const Eigen::JacobiSVD<Mat3> deformed(faces_->frame(last.place) * last.frame.inverse(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
        turn = deformed.matrixU() * deformed.matrixV().transpose();
      }
      touch.turned = shortest_turn(turn * last.normal, touch.normal) * turn;
    }
    touch.slip -= touch.normal.dot(touch.slip) * touch.normal;
    if (touch.faces) touch.gap += given.value("offset", 0.0);
    touch.opening = touch.faces && last.faces ? touch.gap - last.gap : 0;
  }

  const Scene& scene_;
  const Body& body_;
  Side side_;
  Master master_;
  std::optional<Faces> faces_;  ///< of a master in space that deforms, or an obstacle that has facets
  Facets facets_;
  std::vector<PartFace> slave_parts_, master_parts_;
  std::vector<Sample> samples_;  ///< of a contact in space that is integrated
  std::map<int, double> areas_;
  std::set<int> corners_;  ///< where the slave side turns by more than 60 degrees
  double last_time_ = at_rest;
};

}  // namespace stickslip::verify
