#include "studies/run/obstacle_fields.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "studies/input/obstacle_kinds.hpp"
#include "studies/run/side_curve.hpp"

namespace stickslip {
namespace {

using nlohmann::json;

/// Where the outline of an obstacle is at the start, of a plane as much as lies beside the bodies; empty of what has
/// none here.
std::vector<Eigen::Vector2d> outline_of(const json& drawn, const Points<double>& bodies) {
  const std::string kind = drawn.begin().key();
  const json& shape = drawn.begin().value();
  const auto point = [](const json& x) { return Eigen::Vector2d(x[0], x[1]); };
  std::vector<Eigen::Vector2d> out;
  if (kind == "plane") {
    const Eigen::Vector2d at = point(shape["point"]), n = point(shape["normal"]).normalized(), along(n.y(), -n.x());
    const Eigen::VectorXd s = along.transpose() * (bodies.colwise() - at);
    const double room = s.maxCoeff() - s.minCoeff();
    for (const double end : {s.minCoeff() - room, s.maxCoeff() + room}) out.emplace_back(at + end * along);
  } else if (kind == "circle") {
    constexpr int sides = 128;  // off the circle by 3e-4 of its radius
    for (int i = 0; i <= sides; ++i) {
      const double angle = 2 * std::acos(-1.0) * i / sides;
      out.emplace_back(point(shape["center"]) +
                       shape["radius"].get<double>() * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  } else if (kind == "polyline") {
    for (const auto& vertex : shape["points"]) out.push_back(point(vertex));
  }
  return out;
}

}  // namespace

VtuData obstacle_fields(const Problem& problem, double time) {
  const auto& scene = problem.model.scene;
  VtuData data;
  data.time = time;
  std::vector<Eigen::Vector2d> points, displacements;
  std::vector<double> owner;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    const auto outline = outline_of(drawn(scene.obstacles[o].shape), problem.slots.points);
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (i > 0) {
        data.cells.push_back(VtuCell::line);
        const int last = static_cast<int>(points.size());
        data.connectivity.insert(data.connectivity.end(), {last - 1, last});
        owner.push_back(static_cast<double>(o));
      }
      points.push_back(outline[i]);
      displacements.push_back(obstacle_displacement(problem, scene.obstacles[o], outline[i], time));
    }
  }
  const auto columns = [](const std::vector<Eigen::Vector2d>& list) {
    Matrix<double> out(2, static_cast<Eigen::Index>(list.size()));
    for (std::size_t i = 0; i < list.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = list[i];
    return out;
  };
  data.points = columns(points);
  data.point_fields.push_back({"displacement", columns(displacements)});
  data.cell_fields.push_back(
      {"obstacle",
       Eigen::Map<const Vector<double>>(owner.data(), static_cast<Eigen::Index>(owner.size())).transpose()});
  return data;
}

}  // namespace stickslip
