#include "studies/run/obstacle_fields.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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
  }
  return out;
}

/// What is written of obstacles, one after the other.
struct Lines {
  VtuData data;
  std::vector<double> owner = {};

  /// Adds points of obstacle `o`, D x points, and the cells between them, by these points.
  void add(const Problem& problem, std::size_t o, const Points<double>& points,
           const std::vector<std::vector<int>>& cells) {
    const auto first = static_cast<int>(data.points.cols());
    const Eigen::Index dimension = points.rows(), count = first + points.cols();
    data.points.conservativeResize(dimension, count);
    data.points.rightCols(points.cols()) = points;
    displacements_.conservativeResize(dimension, count);
    for (Eigen::Index p = 0; p < points.cols(); ++p)
      displacements_.col(first + p) = displacement(problem, problem.model.scene.obstacles[o], points.col(p));
    for (const auto& cell : cells) {
      data.cells.push_back(cell.size() == 2 ? VtuCell::line : cell.size() == 3 ? VtuCell::triangle : VtuCell::quad);
      for (const int point : cell) data.connectivity.push_back(first + point);
      owner.push_back(static_cast<double>(o));
    }
  }
  VtuData finished() {
    data.point_fields.push_back({"displacement", std::move(displacements_)});
    data.cell_fields.push_back(
        {"obstacle",
         Eigen::Map<const Vector<double>>(owner.data(), static_cast<Eigen::Index>(owner.size())).transpose()});
    return std::move(data);
  }

 private:
  Vector<double> displacement(const Problem& problem, const Obstacle& obstacle, const Vector<double>& X) const {
    if (X.size() == 2) return obstacle_displacement(problem, obstacle, X, data.time);
    return detail::frame_of_obstacle<3>(obstacle, data.time, problem.slots.numbers).displacement(Vec<double, 3>(X));
  }
  Matrix<double> displacements_ = {};
};

}  // namespace

bool has_obstacle_fields(const Model& model) {
  const auto& obstacles = model.scene.obstacles;
  if (model.dimension == 2) return !obstacles.empty();
  return std::any_of(obstacles.begin(), obstacles.end(), [](const Obstacle& one) { return has_facets(one.shape); });
}

VtuData obstacle_fields(const Problem& problem, double time) {
  const auto& obstacles = problem.model.scene.obstacles;
  Lines lines;
  lines.data.time = time;
  lines.data.points.resize(problem.model.dimension, 0);
  for (std::size_t o = 0; o < obstacles.size(); ++o) {
    if (has_facets(obstacles[o].shape)) {
      lines.add(problem, o, problem.slots.vertices[o], facets_of(obstacles[o].shape));
    } else if (problem.model.dimension == 2) {
      const auto outline = outline_of(drawn(obstacles[o].shape, problem.slots.numbers), problem.slots.points);
      Points<double> points(2, static_cast<Eigen::Index>(outline.size()));
      std::vector<std::vector<int>> cells;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        points.col(static_cast<Eigen::Index>(i)) = outline[i];
        if (i > 0) cells.push_back({static_cast<int>(i) - 1, static_cast<int>(i)});
      }
      lines.add(problem, o, points, cells);
    }
  }
  return lines.finished();
}

}  // namespace stickslip
