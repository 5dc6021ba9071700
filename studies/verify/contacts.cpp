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
    if (side_.edges.empty() && body_.element == "bar") area = body_.area();
  std::erase_if(areas_, [&](const auto& of) {  // (no area is left on the axis)
    return segment ? of.second == 0 : body_.quadratic() && scene.axisymmetric && scene.points(0, of.first) == 0;
  });
  for (const auto& [node, area] : areas_)
    if (itself) master_.set_wall(seeker(node, scene.points));
  advance(Field::Zero(3, scene.points.cols()), at_rest);  // slip is measured from the start
}

Seeker Contact::seeker(int node, const Field& x) const {
  Seeker seeker{node, x.col(node), Vec2::Zero()};
  for (const auto& [a, b] : facets_)
    if (body_.solid() && (a == node || b == node)) seeker.outward += right_of((x.col(b) - x.col(a)).head<2>());
  return seeker;
}

/// Cuts a slave facet where master facets end, seen along its normal; each part faces the nearest of them.
std::vector<Contact::Piece> Contact::cut(const std::array<int, 2>& facet, const Field& x) const {
  const auto [first, second] = facet;
  const Line slave{x.col(first).head<2>(), x.col(second).head<2>()};
  const Vec2 nu = right_of(slave.tau).normalized();
  if (master_.patches.empty()) return {{facet, -1, 0, 1}};
  std::map<int, std::array<double, 2>> shadows;  // on the facet, of the patches that it may face
  std::set<double> breaks{0, 1};
  for (int p = 0; p < std::ssize(master_.patches); ++p) {
    const Patch& patch = master_.patches[p];
    const Line line = master_.line_of(patch);
    const auto cast = [&](const Vec2& y, bool is_free) {  // sides that end together, do so to 1e-6 of a facet
      const double xi = slave.xi(y), end = std::clamp(std::round(xi), 0.0, 1.0);
      return is_free && scene_.finite && std::abs(xi - end) <= 1e-6 ? end : xi;
    };
    const double low = cast(line.to, patch.beside[1] < 0), high = cast(line.from, patch.beside[0] < 0);
    const bool is_opposite = nu.dot(right_of(line.tau)) < -at_end * line.tau.norm();
    if (!is_opposite || std::min({high, 1 - low, high - low}) <= at_end) continue;
    shadows[p] = {low, high};
    for (const double xi : {low, high})
      if (xi > at_end && xi < 1 - at_end) breaks.insert(xi);
  }
  std::vector<Piece> pieces;
  for (auto to = std::next(breaks.begin()); to != breaks.end(); ++to) {
    const double from = *std::prev(to), middle = (from + *to) / 2;
    const Vec2 y = slave.at(middle);
    std::pair<double, int> nearest{infinity, -1};
    for (const auto& [p, shadow] : shadows) {
      const Line line = master_.line_of(master_.patches[p]);
      if (shadow[0] > middle || shadow[1] < middle) continue;
      nearest = std::min(nearest, {(line.at(line.xi(y, nu)) - y).norm(), p});
    }
    if (nearest.second >= 0 && *to - from > at_end) pieces.push_back({facet, nearest.second, from, *to});
  }
  return pieces;
}

/// Adds int psi ... dA of a piece, by three Gauss points; psi is 1 where the facet's other node carries none. The
/// length int psi dS.
double Contact::integrate(const Piece& piece, int node, const Field& x, Touch& touch) const {
  const auto& [facet, p, from, to] = piece;
  const auto [first, second] = facet;
  const bool end = node == second, sole = !side_.has(end ? first : second);
  double share = 0;
  const Vec3 A = scene_.points.col(first), T = scene_.points.col(second) - A, tau = x.col(second) - x.col(first);
  const Vec2 nu = right_of(tau.head<2>()).normalized();
  for (const auto& point : edge_points(3, false)) {
    const double s = from + (to - from) * point.s, psi = sole ? 1 : end ? s : 1 - s;
    const double length = psi * (to - from) * point.weight * T.norm(),
                 dA = length * scene_.depth(body_, A[0] + s * T[0]);
    const Vec3 x_s = x.col(first) + s * tau;
    Foot foot;
    if (p < 0) {
      foot = master_.foot({node, x_s, nu});
    } else {
      const Patch& patch = master_.patches[p];
      const Line line = master_.line_of(patch);
      const double eta = line.xi(x_s.head<2>(), nu);
      foot = master_.foot({p, eta});
      if (!master_.rigid()) foot.normal -= in_space(nu);
      touch.tangent += dA / patch.length * in_space(line.tau);
      touch.along += dA * (patch.arc + eta * patch.length + (end ? s - 1 : s) * T.norm());
    }
    share += length;
    touch.area += dA;
    touch.relative += dA * (x_s - foot.y);
    touch.normal += dA * foot.normal;
    touch.y += dA * foot.y;
    foot.weights.insert(foot.weights.end(), {{first, 1 - s}, {second, s}});
    for (const auto& [n, weight] : foot.weights) touch.weights.emplace_back(n, dA * weight);
  }
  return share;
}

Touch Contact::on_pieces(int node, const Field& x) const {
  Touch touch;
  touch.normal.setZero();
  double share = 0, whole = 0;  // lengths
  for (const auto& facet : facets_) {
    if (std::ranges::count(facet, node) == 0) continue;
    const double length = (scene_.points.col(facet[1]) - scene_.points.col(facet[0])).norm();
    whole += side_.has(facet[0]) && side_.has(facet[1]) ? length / 2 : length;
    for (const auto& piece : cut(facet, x)) share += integrate(piece, node, x, touch);
  }
  const bool along_curve = scene_.finite && !master_.patches.empty();
  if (share <= (along_curve ? 0.01 : 1e-12) * whole) {
    const Foot near = master_.foot(seeker(node, x));
    return {{false, near.y, near.normal, (x.col(node) - near.y).norm(), near.place}, node};
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
void Contact::move(Touch& touch, const Touch& last, const Field& u, double time) const {
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
    touch.slip = touch.y - (on_curve ? in_space(master_.position(last.place)) : last.y);
  }
  const Mat3 turn = scene_.finite ? motion.turn(time) : Mat3(Mat3::Identity());
  touch.normal = turn * touch.normal;
  touch.slip = turn * touch.slip;
  touch.slip -= touch.normal.dot(touch.slip) * touch.normal;
  if (touch.faces) touch.gap += given.value("offset", 0.0);
  touch.opening = touch.faces && last.faces ? touch.gap - last.gap : 0;
}

void Contact::advance(const Field& u, double time) {
  Field x = scene_.places(u);  // in the frame of the master
  for (Eigen::Index n = 0; n < x.cols() && scene_.finite; ++n) x.col(n) = master_.motion.back(x.col(n), time);
  master_.place_vertices(x);
  last = std::exchange(touches, {});
  for (const auto& [node, area] : areas_) {
    Touch& touch = touches[node];
    touch = segment ? on_pieces(node, x) : Touch{master_.foot(seeker(node, x)), node, area};
    if (!segment) touch.weights.emplace_back(node, 1);
    move(touch, last[node], u, time);
  }
  last_time_ = time;
}

}  // namespace stickslip::verify
