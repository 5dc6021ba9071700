#include <algorithm>
#include <cmath>

#include "studies/verify/state.hpp"

namespace stickslip::verify {

Contact::Contact(const Scene& scene, const std::string& called, const Json& sides)
    : name(called),
      group(sides.at("of")),
      given(scene.json.at("contacts").at(group)),
      itself(sides.at("slave") == sides.at("master")),
      segment(given.value("discretization", "node") == "segment"),
      scene_(scene),
      body_(scene.body(sides.at("slave"))),
      side_(scene.side(sides.at("slave"))),
      master_(scene, given, sides.at("slave"), sides.at("master")),
      facets_(facets_of(side_)),
      areas_(areas_of(scene, body_, side_)) {
  for (auto& [node, area] : areas_)
    if (side_.edges.empty() && body_.element == "bar") area = body_.area;
  std::erase_if(areas_, [&](const auto& of) {  // (no area is left on the axis)
    return segment ? of.second == 0 : body_.quadratic() && scene.axisymmetric && scene.points(0, of.first) == 0;
  });
  std::vector<Seeker> seekers;
  for (const auto& [node, area] : areas_) seekers.push_back(seeker(node, scene.points));
  if (itself) master_.set_walls(seekers);
  advance(Field::Zero(3, scene.points.cols()), at_rest);  // slip is measured from the start
}

Seeker Contact::seeker(int node, const Field& x) const {
  Seeker seeker{node, x.col(node), Vec2::Zero()};
  for (const auto& [a, b] : facets_)
    if (body_.solid() && (a == node || b == node)) seeker.outward += right_of((x.col(b) - x.col(a)).head<2>());
  return seeker;
}

/// Cuts a slave facet where master facets end, seen along its normal; each part faces the nearest of them.
void Contact::cut(const std::array<int, 2>& facet, const Field& x, const Places& at, std::vector<Piece>& all) const {
  const auto [first, second] = facet;
  const Line slave{x.col(first).head<2>(), x.col(second).head<2>()};
  const Vec2 nu = right_of(slave.tau).normalized();
  const auto add = [&](double from, double to, int patch) {
    for (const int node : facet)
      if (side_.has(node))
        all.push_back({first, second, node, patch, from, to, !side_.has(node == first ? second : first)});
  };
  if (master_.patches.empty()) return add(0, 1, -1);
  std::map<int, std::array<double, 2>> shadows;  // on the facet, of the patches that it may face
  std::set<double> breaks{0, 1};
  for (int p = 0; p < std::ssize(master_.patches); ++p) {
    const Patch& patch = master_.patches[p];
    const Line line = patch.line(at);
    const auto cast = [&](const Vec2& y, bool is_free) {  // sides that end together, do so to 1e-6 of a facet
      const double xi = slave.xi(y), end = std::clamp(std::round(xi), 0.0, 1.0);
      return is_free && scene_.finite && std::abs(xi - end) <= 1e-6 ? end : xi;
    };
    const double low = cast(line.to, patch.next < 0), high = cast(line.from, patch.previous < 0);
    const bool is_opposite = nu.dot(right_of(line.tau)) < -at_end * line.tau.norm();
    if (!is_opposite || std::min({high, 1 - low, high - low}) <= at_end) continue;
    shadows[p] = {low, high};
    for (const double xi : {low, high})
      if (xi > at_end && xi < 1 - at_end) breaks.insert(xi);
  }
  for (auto to = std::next(breaks.begin()); to != breaks.end(); ++to) {
    const double from = *std::prev(to), middle = (from + *to) / 2;
    std::pair<double, int> nearest{infinity, -1};
    for (const auto& [p, shadow] : shadows) {
      if (shadow[0] > middle || shadow[1] < middle) continue;
      const Line line = master_.patches[p].line(at);
      const Vec2 off = slave.from + middle * slave.tau - line.from;
      nearest = std::min(nearest, {(cross(off, nu) / cross(line.tau, nu) * line.tau - off).norm(), p});
    }
    if (nearest.second >= 0 && *to - from > at_end) add(from, *to, nearest.second);
  }
}

/// Adds int psi ... dA of a piece, by three Gauss points.
void Contact::integrate(const Piece& piece, const Field& x, const Places& at, Touch& touch, double& share) const {
  const auto& [first, second, carrier, p, from, to, sole] = piece;
  const Vec3 A = scene_.points.col(first), T = scene_.points.col(second) - A, tau = x.col(second) - x.col(first);
  const Vec2 nu = right_of(tau.head<2>()).normalized();
  for (const auto& point : edge_points(3, false)) {
    const double s = from + (to - from) * point.s, psi = sole ? 1 : carrier == first ? 1 - s : s;
    const double length = psi * (to - from) * point.weight * T.norm(),
                 dA = length * scene_.depth(body_, A[0] + s * T[0]);
    const Vec3 x_s = x.col(first) + s * tau;
    Foot foot;
    if (p < 0) {
      foot = master_.foot({carrier, x_s, nu}, at);
    } else {
      const Patch& patch = master_.patches[p];
      const Line line = patch.line(at);
      const double eta = cross(x_s.head<2>() - line.from, nu) / cross(line.tau, nu);
      foot = master_.foot({p, eta}, at);
      if (!master_.rigid()) foot.normal -= in_space(nu);
      touch.tangent += dA / patch.length * in_space(line.tau);
      touch.along += dA * (patch.arc + eta * patch.length + (carrier == first ? s : s - 1) * T.norm());
    }
    share += length;
    touch.area += dA;
    touch.relative += dA * (x_s - foot.y);
    touch.normal += dA * foot.normal;
    touch.y += dA * foot.y;
    foot.weights.insert(foot.weights.end(), {{first, 1 - s}, {second, s}});
    for (const auto& [node, weight] : foot.weights) touch.weights.emplace_back(node, dA * weight);
  }
}

Touch Contact::on_pieces(int node, const std::vector<Piece>& pieces, const Field& x, const Places& at) const {
  Touch touch;
  touch.normal.setZero();
  double share = 0, whole = 0;  // lengths
  for (const auto& [first, second] : facets_)
    if (first == node || second == node)
      whole += (scene_.points.col(second) - scene_.points.col(first)).norm() *
               (side_.has(first) && side_.has(second) ? 0.5 : 1);
  for (const auto& piece : pieces)
    if (piece.carrier == node) integrate(piece, x, at, touch, share);
  const bool along_curve = scene_.finite && !master_.patches.empty();
  if (share <= (along_curve ? 0.01 : 1e-12) * whole) {
    touch = {master_.foot(seeker(node, x), at), node};
    touch.gap = (x.col(node) - touch.y).norm();
    touch.faces = false;
    return touch;
  }
  touch.faces = true;
  touch.node = node;
  touch.normal = (along_curve ? in_space(right_of(touch.tangent.head<2>())) : touch.normal).normalized();
  touch.gap = touch.relative.dot(touch.normal) / touch.area;
  touch.y /= touch.area;
  touch.tangent /= touch.area;
  touch.along /= touch.area;
  for (auto& [n, weight] : touch.weights) weight /= touch.area;
  return touch;
}

/// What a place did since the last increment. Its gap and normal are those in the frame of the master, at small strain
/// those of the start.
void Contact::move(Touch& touch, const Touch& last, const Field& u, const Places& at, double time) const {
  const Motion& motion = master_.motion;
  const bool on_curve = touch.place.patch >= 0 && last.place.patch >= 0;
  touch.carried =
      motion.displacement(touch.y, time, scene_.finite) - motion.displacement(touch.y, last_time_, scene_.finite);
  touch.slip_known = touch.faces && (last.faces || on_curve || !scene_.finite);
  if (!scene_.finite) {
    touch.relative = -motion.displacement(touch.y, time, false);
    for (const auto& [node, weight] : touch.weights) touch.relative += weight * u.col(node);
    touch.gap += touch.normal.dot(touch.relative);
    touch.slip = touch.relative - last.relative;
  } else if (segment && !master_.patches.empty()) {
    const double way = touch.along - last.along;
    touch.slip = (master_.loop > 0 ? std::remainder(way, master_.loop) : way) * touch.tangent;
  } else {
    touch.slip = touch.y - (on_curve ? in_space(master_.position(at, last.place)) : last.y);
  }
  if (scene_.finite) {
    touch.normal = motion.turn(time) * touch.normal;
    touch.slip = motion.turn(time) * touch.slip;
  }
  touch.slip -= touch.normal.dot(touch.slip) * touch.normal;
  if (touch.faces) touch.gap += given.value("offset", 0.0);
  touch.opening = touch.faces && last.faces ? touch.gap - last.gap : 0;
}

std::vector<Touch> Contact::advance(const Field& u, double time) {
  Field x = scene_.places(u);  // in the frame of the master
  for (Eigen::Index n = 0; n < x.cols() && scene_.finite && master_.rigid(); ++n)
    x.col(n) = master_.motion.back(x.col(n), time);
  const auto at = master_.vertices(x);
  std::vector<Piece> pieces;
  for (const auto& facet : facets_)
    if (segment) cut(facet, x, at, pieces);
  std::vector<Touch> touches;
  for (const auto& [node, area] : areas_) {
    Touch touch = segment ? on_pieces(node, pieces, x, at) : Touch{master_.foot(seeker(node, x), at), node, area};
    if (!segment) touch.weights.emplace_back(node, 1);
    const Touch last = last_.contains(node) ? last_[node] : touch;
    move(touch, last, u, at, time);
    touches.push_back(last_[node] = touch);
  }
  last_time_ = time;
  return touches;
}

}  // namespace stickslip::verify
