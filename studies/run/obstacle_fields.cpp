#include "studies/run/obstacle_fields.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/master_surface.hpp"
#include "core/model/positions.hpp"
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

/// The facets of obstacles in space; others have none.
VtuData facets_in_space(const Problem& problem, double time) {
  const auto& obstacles = problem.model.scene.obstacles;
  VtuData data;
  data.time = time;
  data.points.resize(3, 0);
  Matrix<double> displacements(3, 0);
  std::vector<double> owner;
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (!has_facets(obstacles[o].shape)) continue;
    const auto vertices = vertices_of<3>(obstacles[o], problem.slots.numbers);
    const auto frame = detail::frame_of_obstacle<3>(obstacles[o], time, problem.slots.numbers);
    const auto first = static_cast<int>(data.points.cols());
    data.points.conservativeResize(3, first + vertices.cols());
    displacements.conservativeResize(3, first + vertices.cols());
    for (Eigen::Index v = 0; v < vertices.cols(); ++v) {
      const Vec<double, 3> X = vertices.col(v);
      data.points.col(first + v) = X;
      displacements.col(first + v) = frame.displacement(X);
    }
    for (const auto& facet : facets_of(obstacles[o])) {
      data.cells.push_back(facet.size() == 3 ? VtuCell::triangle : VtuCell::quad);
      for (int vertex : facet) data.connectivity.push_back(first + vertex);
      owner.push_back(static_cast<double>(o));
    }
  }
  data.point_fields.push_back({"displacement", displacements});
  data.cell_fields.push_back(
      {"obstacle",
       Eigen::Map<const Vector<double>>(owner.data(), static_cast<Eigen::Index>(owner.size())).transpose()});
  return data;
}

}  // namespace

bool has_obstacle_fields(const Model& model) {
  const auto& obstacles = model.scene.obstacles;
  if (model.dimension == 2) return !obstacles.empty();
  return std::any_of(obstacles.begin(), obstacles.end(), [](const Obstacle& one) { return has_facets(one.shape); });
}

VtuData obstacle_fields(const Problem& problem, double time) {
  const auto& scene = problem.model.scene;
  if (problem.model.dimension == 3) return facets_in_space(problem, time);
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
