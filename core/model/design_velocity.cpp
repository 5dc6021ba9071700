#include "core/model/design_velocity.hpp"

#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "core/mesh/sides.hpp"
#include "core/model/scene.hpp"
#include "core/solids/continuum.hpp"

namespace stickslip {
namespace {

/// Laplace's matrix of a mesh of continuum elements.
Eigen::SparseMatrix<double> laplacian(const Mesh& mesh, const Points<double>& points) {
  std::vector<Eigen::Triplet<double>> entries;
  with_shape(mesh.shape, [&]<class Shape>(Shape) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      const int* nodes = mesh.connectivity.data() + static_cast<std::ptrdiff_t>(e) * Shape::nodes;
      Nodal<double, Shape> X;
      for (int a = 0; a < Shape::nodes; ++a) X.col(a) = points.col(nodes[a]);
      for (const auto& point : Shape::quadrature()) {
        const Gradient<double, Shape> gradient(point, X);
        const Mat<double, Shape::nodes> K = gradient.volume * gradient.dN.transpose() * gradient.dN;
        for (int a = 0; a < Shape::nodes; ++a)
          for (int b = 0; b < Shape::nodes; ++b) entries.emplace_back(nodes[a], nodes[b], K(a, b));
      }
    }
  });
  Eigen::SparseMatrix<double> matrix(mesh.node_count, mesh.node_count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Nodes with a given value: those of the side that moves, and those that stay.
std::vector<char> given_nodes(const ShapeMotion& motion, const Mesh& mesh) {
  std::vector<char> given(mesh.node_count, 0);
  auto mark = [&](const Side& side) {
    for (int node : side.nodes) given[node] = 1;
  };
  mark(evaluate_side(mesh, parse_side_expression(motion.side)));
  if (!motion.fixed.empty()) mark(evaluate_side(mesh, parse_side_expression(motion.fixed)));
  for (const auto& [name, side] : mesh.sides)
    if (motion.fixed.empty()) mark(side);
  return given;
}

}  // namespace

struct ShapeExtension::Factor {
  Eigen::SparseMatrix<double> coupling;  ///< free rows, all columns
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> inner;
};

ShapeExtension::ShapeExtension(const Mesh& mesh, const Points<double>& points, std::vector<char> given)
    : given_(std::move(given)), factor_(std::make_unique<Factor>()) {
  const auto matrix = laplacian(mesh, points);
  std::vector<int> place(given_.size(), -1);
  for (std::size_t i = 0; i < given_.size(); ++i)
    if (!given_[i]) {
      place[i] = static_cast<int>(free_.size());
      free_.push_back(static_cast<int>(i));
    }
  if (free_.empty()) return;
  std::vector<Eigen::Triplet<double>> inner, coupling;
  for (int column = 0; column < matrix.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, column); it; ++it)
      if (place[it.row()] >= 0 && place[column] >= 0)
        inner.emplace_back(place[it.row()], place[column], it.value());
      else if (place[it.row()] >= 0)
        coupling.emplace_back(place[it.row()], column, it.value());
  const auto size = static_cast<Eigen::Index>(free_.size());
  factor_->coupling.resize(size, matrix.cols());
  factor_->coupling.setFromTriplets(coupling.begin(), coupling.end());
  Eigen::SparseMatrix<double> K(size, size);
  K.setFromTriplets(inner.begin(), inner.end());
  factor_->inner.compute(K);
  // a part without given nodes leaves a pivot of nothing but rounding
  const double least = 1e-10 * K.diagonal().maxCoeff();
  if (factor_->inner.info() != Eigen::Success || factor_->inner.vectorD().minCoeff() <= least)
    throw std::runtime_error("a part of the body has neither a side that moves nor one that stays");
}

ShapeExtension::~ShapeExtension() = default;

Vector<double> ShapeExtension::extend(const Vector<double>& values) const {
  Vector<double> field = values;
  if (free_.empty()) return field;
  const Vector<double> inner = factor_->inner.solve(Vector<double>(-(factor_->coupling * values)));
  for (std::size_t i = 0; i < free_.size(); ++i) field[free_[i]] = inner[i];
  return field;
}

Vector<double> ShapeExtension::pull_back(const Vector<double>& by_field) const {
  Vector<double> by_values = by_field;
  if (free_.empty()) return by_values;
  Vector<double> inner(free_.size());
  for (std::size_t i = 0; i < free_.size(); ++i) {
    inner[i] = by_field[free_[i]];
    by_values[free_[i]] = 0;
  }
  return by_values - factor_->coupling.transpose() * factor_->inner.solve(inner);
}

Vector<double> DesignVelocity::share() const {
  Vector<double> values = Vector<double>::Zero(extension->given().size());
  for (int node : moved) values[node] = 1;
  return extension->extend(values);
}

std::vector<DesignVelocity> design_velocities(const Scene& scene, int body, const Mesh& mesh,
                                              const Points<double>& points) {
  std::vector<DesignVelocity> velocities;
  std::shared_ptr<const ShapeExtension> extension;
  for (const auto& motion : scene.shapes) {
    if (motion.body != body) continue;
    auto given = given_nodes(motion, mesh);
    if (!extension || given != extension->given())
      extension = std::make_shared<const ShapeExtension>(mesh, points, std::move(given));
    auto moved = evaluate_side(mesh, parse_side_expression(motion.side)).nodes;
    if (motion.node >= 0) moved = {moved[motion.node]};
    velocities.push_back({body, motion.slot, std::move(moved), motion.direction, extension});
  }
  return velocities;
}

}  // namespace stickslip
