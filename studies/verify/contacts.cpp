#include "studies/verify/contacts.hpp"

#include <algorithm>
#include <cmath>

namespace stickslip::verify {

Contact::Contact(const Scene& scene, std::string called, const Json& of, const Json& contact)
    : name(std::move(called)),
      group(of.at("of")),
      given(contact),
      itself(of.at("slave") == of.at("master")),
      scene_(scene),
      body_(scene.body(of.at("slave").get<std::string>())),
      side_(scene.side(of.at("slave").get<std::string>())),
      master_(scene, contact, of.at("slave"), of.at("master")),
      segment_(contact.value("discretization", "node") == "segment") {
  for (const auto& edge : side_.edges) {
    const auto shares = edge_areas(scene, body_, edge);
    for (std::size_t a = 0; a < edge.size(); ++a)
      if (side_.nodes.contains(edge[a])) areas_[edge[a]] += shares[a];
    if (edge.size() == 3) facets_.push_back({edge[0], edge[2]});
    facets_.push_back({edge[edge.size() == 3 ? 2 : 0], edge[1]});
  }
  for (const int node : side_.nodes) {
    if (side_.edges.empty()) areas_[node] = body_.element == "bar" ? body_.area : 1;
    if (segment_ ? areas_[node] == 0 : body_.quadratic() && scene.axisymmetric && scene.points(0, node) == 0)
      areas_.erase(node);
  }
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

Touch Contact::at_node(int node, const Field& x, const Eigen::Matrix2Xd& at) const {
  const Foot foot = master_.foot(seeker(node, x), at);
  Touch touch{node, foot.faces, areas_.at(node), foot.gap, foot.normal};
  touch.weights = foot.weights;
  touch.weights.emplace_back(node, 1);
  touch.foot = foot.y;
  touch.place = foot.place;
  return touch;
}

/// Parts of a slave facet between ends of master facets, each with the facet that is nearest along its normal.
void Contact::add_pieces(const std::array<int, 2>& facet, const Field& x, const Eigen::Matrix2Xd& at,
                         std::vector<Piece>& all) const {
  const auto [first, second] = facet;
  const Vec2 a = x.col(first).head<2>(), tau = x.col(second).head<2>() - a, nu = right_of(tau).normalized();
  const auto add = [&](double from, double to, int patch) {
    for (const int node : facet)
      if (side_.nodes.contains(node))
        all.push_back({first, second, node, patch, from, to, !side_.nodes.contains(node == first ? second : first)});
  };
  if (master_.patches.empty()) return add(0, 1, -1);
  struct Shadow {
    double low, high;
    int patch;
  };
  std::vector<Shadow> shadows;
  std::vector<double> breaks{0, 1};
  for (int p = 0; p < static_cast<int>(master_.patches.size()); ++p) {
    const Patch& patch = master_.patches[p];
    const Vec2 c = at.col(patch.vertex[1]), d = at.col(patch.vertex[2]);
    if (nu.dot(right_of(d - c)) >= -at_end * (d - c).norm()) continue;
    const auto cast = [&](const Vec2& y, bool free) {  // sides that end together, do so to 1e-6 of a facet
      const double xi = (y - a).dot(tau) / tau.squaredNorm(), end = std::round(xi);
      return free && scene_.finite && (end == 0 || end == 1) && std::abs(xi - end) <= 1e-6 ? end : xi;
    };
    const double high = cast(c, patch.previous < 0), low = cast(d, patch.next < 0);
    if (high <= at_end || low >= 1 - at_end || high - low <= at_end) continue;
    shadows.push_back({low, high, p});
    for (const double xi : {low, high})
      if (xi > at_end && xi < 1 - at_end) breaks.push_back(xi);
  }
  std::sort(breaks.begin(), breaks.end());
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    if (breaks[k] - breaks[k - 1] <= at_end) continue;
    const double middle = (breaks[k] + breaks[k - 1]) / 2;
    double least = std::numeric_limits<double>::infinity();
    int facing = -1;
    for (const auto& [low, high, p] : shadows) {
      if (low > middle || high < middle) continue;
      const Vec2 c = at.col(master_.patches[p].vertex[1]), along = at.col(master_.patches[p].vertex[2]) - c;
      const Vec2 off = a + middle * tau - c;
      const double distance = (cross(off, nu) / cross(along, nu) * along - off).norm();
      if (distance < least) facing = p;
      least = std::min(least, distance);
    }
    if (facing >= 0) add(breaks[k - 1], breaks[k], facing);
  }
}

/// Adds int psi ... dA of a piece, by three Gauss points. Foot and normal: as sums, not yet over the area.
void Contact::integrate(const Piece& piece, const Field& x, const Eigen::Matrix2Xd& at, Touch& touch,
                        double& share) const {
  const auto& [first, second, carrier, p, from, to, sole] = piece;
  const Vec3 A = scene_.points.col(first), T = scene_.points.col(second) - A, tau = x.col(second) - x.col(first);
  const Vec2 nu = right_of(tau.head<2>()).normalized();
  for (const auto& point : edge_points(3, false)) {
    const double s = from + (to - from) * point.s, psi = sole ? 1 : carrier == first ? 1 - s : s;
    const double length = psi * (to - from) * point.weight * T.norm(),
                 dA = length * scene_.depth(body_, A[0] + s * T[0]);
    const Vec3 at_s = x.col(first) + s * tau;
    share += length;
    touch.area += dA;
    touch.weights.emplace_back(first, dA * (1 - s));
    touch.weights.emplace_back(second, dA * s);
    if (p < 0) {
      const Foot foot = master_.foot({carrier, at_s, nu}, at);
      touch.relative += dA * (at_s - foot.y);
      touch.normal += dA * foot.normal;
      touch.foot += dA * foot.y;
      continue;
    }
    const Patch& patch = master_.patches[p];
    const Vec2 c = at.col(patch.vertex[1]), edge = at.col(patch.vertex[2]) - c;
    const double eta = cross(at_s.head<2>() - c, nu) / cross(edge, nu);
    const Vec3 y = in_space(c + eta * edge);
    touch.relative += dA * (at_s - y);
    touch.normal += dA * in_space(right_of(edge).normalized() - (master_.rigid() ? 0 : 1) * nu);
    touch.foot += dA * y;
    touch.tangent += dA / patch.length * in_space(edge);
    touch.along += dA * (patch.arc + eta * patch.length + (carrier == first ? s : s - 1) * T.norm());
    if (master_.rigid()) continue;
    touch.weights.emplace_back(master_.nodes[patch.vertex[1]], -dA * (1 - eta));
    touch.weights.emplace_back(master_.nodes[patch.vertex[2]], -dA * eta);
  }
}

Touch Contact::on_pieces(int node, const std::vector<Piece>& pieces, const Field& x, const Eigen::Matrix2Xd& at) const {
  Touch touch{node, false, 0, 0, Vec3::Zero()};
  double share = 0, whole = 0;  // lengths
  for (const auto& [first, second] : facets_)
    if (first == node || second == node)
      whole += (scene_.points.col(second) - scene_.points.col(first)).norm() *
               (side_.nodes.contains(first == node ? second : first) ? 0.5 : 1);
  for (const auto& piece : pieces)
    if (piece.carrier == node) integrate(piece, x, at, touch, share);
  const bool along_curve = scene_.finite && !master_.patches.empty();
  touch.faces = share > (along_curve ? 0.01 : 1e-12) * whole;
  if (!touch.faces) return {node};
  touch.normal = (along_curve ? in_space(right_of(touch.tangent.head<2>())) : touch.normal).normalized();
  touch.gap = touch.relative.dot(touch.normal) / touch.area;
  touch.foot /= touch.area;
  touch.tangent /= touch.area;
  touch.along /= touch.area;
  for (auto& [n, weight] : touch.weights) weight /= touch.area;
  return touch;
}

void Contact::move_small(Touch& touch, const Touch& last, const Field& u, double time) const {
  const Vec3 moved = master_.motion.displacement(touch.foot, time, false);
  touch.carried = moved - master_.motion.displacement(touch.foot, last_time_, false);
  touch.relative = -moved;
  for (const auto& [node, weight] : touch.weights) touch.relative += weight * u.col(node);
  touch.gap += touch.normal.dot(touch.relative);
  touch.slip = touch.relative - last.relative;
  touch.slip_known = touch.faces;
}

void Contact::move_finite(Touch& touch, const Touch& last, const Eigen::Matrix2Xd& at, double time) const {
  const Mat3 turn = master_.motion.turn(time);
  const bool from_curve = !segment_ && touch.place.patch >= 0 && last.place.patch >= 0;
  touch.slip_known = touch.faces && (last.faces || from_curve);
  if (segment_ && !master_.patches.empty())
    touch.slip =
        (master_.loop > 0 ? std::remainder(touch.along - last.along, master_.loop) : touch.along - last.along) *
        touch.tangent;
  else if (from_curve)
    touch.slip = touch.foot - in_space(master_.position(at, last.place));
  else
    touch.slip = touch.foot - last.foot;
  touch.slip = turn * touch.slip;
  touch.normal = turn * touch.normal;
  touch.carried =
      master_.motion.displacement(touch.foot, time, true) - master_.motion.displacement(touch.foot, last_time_, true);
}

std::vector<Touch> Contact::advance(const Field& u, double time) {
  const bool freeze = !scene_.finite && start_.empty();
  Field x = scene_.points;
  for (Eigen::Index n = 0; n < x.cols() && scene_.finite; ++n)
    x.col(n) = master_.motion.back(x.col(n) + u.col(n), time);
  const auto at = master_.vertices(scene_.finite ? u : Field::Zero(3, u.cols()));
  std::vector<Piece> parts;
  for (const auto& facet : facets_)
    if (segment_ && (scene_.finite || freeze)) add_pieces(facet, x, at, parts);
  std::vector<Touch> touches;
  for (const auto& [node, area] : areas_) {
    if (scene_.finite || freeze) start_[node] = segment_ ? on_pieces(node, parts, x, at) : at_node(node, x, at);
    Touch touch = start_[node];
    const Touch& last = last_.contains(node) ? last_[node] : touch;
    if (scene_.finite)
      move_finite(touch, last, at, time);
    else
      move_small(touch, last, u, time);
    touch.slip -= touch.normal.dot(touch.slip) * touch.normal;
    touch.gap += given.value("offset", 0.0);
    touch.opening = touch.faces && last.faces ? touch.gap - last.gap : 0;
    touches.push_back(touch);
  }
  for (const auto& touch : touches) last_[touch.node] = touch;
  last_time_ = time;
  return touches;
}

}  // namespace stickslip::verify
