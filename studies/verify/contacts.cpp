#include <numeric>

#include "studies/verify/state.hpp"

namespace stickslip::verify {
namespace {

/// Whether a contact is integrated over segments. At finite strain it is by default between sides of solid bodies, and
/// against a polyline, of no given surface.
bool is_integrated(const Scene& scene, const Json& given, const Json& sides) {
  if (given.contains("discretization")) return given["discretization"] == "segment";
  const std::string slave = sides.at("slave"), master = sides.at("master");
  const Json obstacles = scene.json.value("obstacles", Json::object());
  return scene.finite && !given.contains("surface") && scene.body(slave).solid() && !scene.side(slave).edges.empty() &&
         (!obstacles.contains(master) || obstacles[master].contains("polyline"));
}

}  // namespace

Contact::Contact(const Scene& scene, const std::string& called, const Json& sides)
    : name(called),
      group(sides.at("of")),
      given(scene.json.at("contacts").at(group)),
      itself(sides.at("slave") == sides.at("master")),
      segment(is_integrated(scene, given, sides)),
      scene_(scene),
      body_(scene.body(sides.at("slave"))),
      side_(scene.side(sides.at("slave"))),
      master_(scene, given, sides.at("slave"), sides.at("master"), segment),
      facets_(body_.in_space() ? Facets{} : facets_of(side_)),
      areas_(areas_of(scene, body_, side_)) {
  for (auto& [node, area] : areas_)
    if (side_.edges.empty() && body_.element == "bar") area = body_.area();
  std::erase_if(areas_, [&](const auto& of) {  // (no area is left on the axis)
    return segment ? of.second == 0 : body_.quadratic() && scene.axisymmetric && scene.points(0, of.first) == 0;
  });
  const auto along = [&](const Facet& facet) -> Vec2 {
    return (scene.points.col(facet.ends[1]) - scene.points.col(facet.ends[0])).head<2>();
  };
  std::map<int, Vec2> before;
  std::map<int, std::vector<double>> lengths;
  for (const auto& facet : facets_) before[facet.ends[1]] = along(facet).normalized();
  for (const auto& facet : facets_) {
    for (const int node : facet.ends) lengths[node].push_back(along(facet).norm());
    const auto found = before.find(facet.ends[0]);
    if (segment && scene.finite && found != before.end() && found->second.dot(along(facet).normalized()) < 0.5 - at_end)
      corners_.insert(facet.ends[0]);
  }
  for (const auto& [node, of] : lengths)
    if (itself)
      master_.set_wall(seeker(node, scene.points), std::accumulate(of.begin(), of.end(), 0.0) / std::ssize(of));
  std::erase_if(areas_, [&](const auto& of) {
    return segment && std::ranges::none_of(
                          facets_, [&](const Facet& facet) { return facet.has(of.first) && carries(of.first, facet); });
  });
  advance(Field::Zero(3, scene.points.cols()), at_rest);  // slip is measured from the start
}

Seeker Contact::seeker(int node, const Field& x) const {
  Seeker seeker{node, x.col(node), Vec2::Zero()};
  for (const auto& facet : facets_)
    if (body_.solid() && facet.has(node))
      seeker.outward += right_of((x.col(facet.ends[1]) - x.col(facet.ends[0])).head<2>());
  return seeker;
}

/// Whether a node carries a multiplier on a facet. A corner carries none if the other node does, since two faces that
/// meet in it face other masters.
bool Contact::carries(int node, const Facet& facet) const {
  const int other = facet.ends[facet.ends[0] == node];
  return side_.has(node) && !(corners_.contains(node) && !corners_.contains(other) && side_.has(other));
}

/// Cuts a slave facet where master facets end, seen along its normal; each part faces the nearest of them. What is
/// beyond the other face of a solid is inside of none of its faces.
std::vector<Contact::Piece> Contact::cut(const Facet& facet, const Field& x) const {
  const Line slave{x.col(facet.ends[0]).head<2>(), x.col(facet.ends[1]).head<2>()};
  const Vec2 nu = right_of(slave.tau).normalized();
  if (master_.patches.empty()) return {{facet, -1, 0, 1}};
  std::map<int, std::array<double, 2>> shadows, alike;  // on the facet: of opposite patches, of those that look its way
  std::set<double> breaks{0, 1};
  for (int p = 0; p < std::ssize(master_.patches); ++p) {
    const Patch& patch = master_.patches[p];
    const Line line = master_.line_of(patch);
    const auto cast = [&](const Vec2& y, bool is_free) {  // sides that end together, do so to 1e-6 of a facet
      double xi = slave.xi(y);                            // (a bend moves no place over an end)
      for (int k = 0; k < 20 && !facet.edge.empty() && xi > 0 && xi < 1; ++k)
        xi += (y - facet.at(x, xi).head<2>()).dot(slave.tau) / facet.at(x, xi, 1).head<2>().dot(slave.tau);
      const double end = std::clamp(std::round(xi), 0.0, 1.0);
      return is_free && scene_.finite && std::abs(xi - end) <= 1e-6 ? end : xi;
    };
    const double at_to = cast(line.to, patch.beside[1] < 0), at_from = cast(line.from, patch.beside[0] < 0);
    const auto [low, high] = std::minmax(at_to, at_from);
    const double against = -nu.dot(right_of(line.tau)) / line.tau.norm();
    const bool is_opposite = itself ? against > 0.5 && master_.depth_in(facet, p, last) >= 0 : against > at_end;
    if ((!is_opposite && against >= -at_end) || std::min({high, 1 - low, high - low}) <= at_end) continue;
    if (patch.vertex[1] == facet.ends[0] && itself) continue;
    (is_opposite ? shadows : alike)[p] = {low, high};
    if (!is_opposite) continue;
    for (const double xi : {low, high})
      if (xi > at_end && xi < 1 - at_end) breaks.insert(xi);
  }
  std::vector<Piece> pieces;
  for (auto to = std::next(breaks.begin()); to != breaks.end(); ++to) {
    const double from = *std::prev(to), middle = (from + *to) / 2;
    const Vec2 y = slave.at(middle);
    const auto depth = [&](int p) {  // of y inside of the patch, along the normal of the slave
      const Line line = master_.line_of(master_.patches[p]);
      return (y - line.at(line.xi(y, nu))).dot(nu);
    };
    const auto covers = [&](const auto& of) { return of.second[0] <= middle && middle <= of.second[1]; };
    std::pair<double, int> nearest{infinity, -1};
    for (const auto& shadow : shadows)
      if (covers(shadow) && !(itself && depth(shadow.first) > master_.depth_in(facet, shadow.first, last)))
        nearest = std::min(nearest, {std::abs(depth(shadow.first)), shadow.first});
    if (nearest.second < 0 || *to - from <= at_end) continue;
    const bool is_inside = depth(nearest.second) > 0;
    if (is_inside && std::ranges::any_of(alike, [&](const auto& of) {
          return covers(of) && depth(of.first) > 0 && depth(of.first) < nearest.first;
        }))
      continue;
    pieces.push_back({facet, nearest.second, from, *to});
  }
  return pieces;
}

/// Adds int psi ... dA of a piece, by three Gauss points; psi is 1 where the facet's other node carries none. The
/// length int psi dS.
double Contact::integrate(const Piece& piece, int node, const Field& x, Touch& touch) const {
  const auto& [facet, p, from, to] = piece;
  const auto [first, second] = facet.ends;
  const bool end = node == second, sole = !carries(end ? first : second, facet);
  double share = 0;
  const double chord = (scene_.points.col(second) - scene_.points.col(first)).norm();
  const Vec2 tau = (x.col(second) - x.col(first)).head<2>(), nu = right_of(tau).normalized();
  for (const auto& point : gauss_points("L3")) {
    const double s = from + (to - from) * point.at[0], psi = sole ? 1 : end ? s : 1 - s;
    const double length = psi * (to - from) * point.weight * facet.at(scene_.points, s, 1).norm(),
                 dA = length * scene_.depth(body_, facet.at(scene_.points, s)[0]);
    const Vec3 x_s = facet.at(x, s);
    Foot foot;
    if (p < 0) {
      foot = master_.foot({node, x_s, nu});
    } else {
      const Patch& patch = master_.patches[p];
      double eta = master_.line_of(patch).xi(x_s.head<2>(), nu);
      Vec3 slope = in_space(master_.line_of(patch).tau);
      if (master_.rigid()) {
        foot = master_.foot({p, eta});
      } else {
        const Facet& of = master_.facets[p];
        for (int k = 0; k < 20 && !of.edge.empty(); ++k)
          eta += (x_s - of.at(x, eta)).head<2>().dot(tau) / of.at(x, eta, 1).head<2>().dot(tau);
        slope = of.at(x, eta, 1);
        foot = {true, of.at(x, eta), in_space(right_of(slope.head<2>()).normalized())};
        for (const auto& [n, weight] : of.weights(eta)) foot.weights.emplace_back(n, -weight);
        foot.normal -= in_space(right_of(facet.at(x, s, 1).head<2>()).normalized());
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

Touch Contact::on_pieces(int node, const Field& x) const {
  Touch touch;
  touch.normal.setZero();
  double share = 0, whole = 0;  // lengths
  for (const auto& facet : facets_) {
    if (!facet.has(node) || !carries(node, facet)) continue;
    const double length = (scene_.points.col(facet.ends[1]) - scene_.points.col(facet.ends[0])).norm();
    whole += carries(facet.ends[0], facet) && carries(facet.ends[1], facet) ? length / 2 : length;
    for (const auto& piece : cut(facet, x)) {
      if (touch.faced < 0) touch.faced = piece.patch;
      share += integrate(piece, node, x, touch);
    }
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
  touch.weights.insert(touch.weights.end(), touch.slave.begin(), touch.slave.end());
  for (auto* of : {&touch.weights, &touch.slave})
    for (auto& [n, weight] : *of) weight /= touch.area;
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
    if (!segment) touch.slave.emplace_back(touch.weights.emplace_back(node, 1));
    move(touch, last[node], u, time);
  }
  last_time_ = time;
}

}  // namespace stickslip::verify
