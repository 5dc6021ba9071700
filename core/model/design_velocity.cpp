#include "core/model/design_velocity.hpp"

#include <Eigen/SparseCore>
#include <memory>
#include <optional>
#include <stdexcept>

#include "core/algebra/linear_solver.hpp"
#include "core/mesh/sides.hpp"
#include "core/model/slots.hpp"

namespace stickslip {
namespace {

/// Laplace's matrix of a mesh of continuum elements.
Eigen::SparseMatrix<double> laplacian(const Mesh& mesh, const Points<double>& points) {
  std::vector<Eigen::Triplet<double>> entries;
  with_shape(mesh.shape, [&]<class Shape>(Shape) {
    for (int e = 0; e < mesh.element_count(); ++e) {
      const int* nodes = mesh.connectivity.data() + static_cast<std::ptrdiff_t>(e) * Shape::nodes;
      Mat<double, 2, Shape::nodes> X;
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

/// Solves Laplace's equation for values given at nodes, one column a motion.
class Extension {
 public:
  Extension(const Eigen::SparseMatrix<double>& laplacian, std::vector<char> given) : given_(std::move(given)) {
    std::vector<int> place(given_.size(), -1);
    for (std::size_t i = 0; i < given_.size(); ++i)
      if (!given_[i]) {
        place[i] = static_cast<int>(free_.size());
        free_.push_back(static_cast<int>(i));
      }
    std::vector<Eigen::Triplet<double>> inner, outer;
    for (int column = 0; column < laplacian.cols(); ++column)
      for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, column); it; ++it)
        if (place[it.row()] >= 0 && place[column] >= 0)
          inner.emplace_back(place[it.row()], place[column], it.value());
        else if (place[it.row()] >= 0)
          outer.emplace_back(place[it.row()], column, it.value());
    const auto size = static_cast<Eigen::Index>(free_.size());
    coupling_.resize(size, laplacian.cols());
    coupling_.setFromTriplets(outer.begin(), outer.end());
    if (size == 0) return;
    Eigen::SparseMatrix<double> K(size, size);
    K.setFromTriplets(inner.begin(), inner.end());
    auto pattern = std::make_shared<Pattern>();
    pattern->size = static_cast<int>(size);
    pattern->column_start.assign(K.outerIndexPtr(), K.outerIndexPtr() + size + 1);
    pattern->row.assign(K.innerIndexPtr(), K.innerIndexPtr() + K.nonZeros());
    solver_.analyse(pattern, Symmetry::positive_definite);
    if (!solver_.factorise(K.valuePtr())) throw std::runtime_error("a shape cannot be extended: " + solver_.message());
  }

  const std::vector<char>& given() const { return given_; }

  Matrix<double> operator()(Matrix<double> values) {
    if (free_.empty()) return values;
    const Matrix<double> inner = solver_.solve(Matrix<double>(-(coupling_ * values)));
    for (std::size_t i = 0; i < free_.size(); ++i) values.row(free_[i]) = inner.row(i);
    return values;
  }

 private:
  std::vector<char> given_;
  std::vector<int> free_;
  Eigen::SparseMatrix<double> coupling_;
  LinearSolver<double> solver_{Backend::automatic};
};

}  // namespace

std::vector<DesignVelocity> design_velocities(const Scene& scene, int body, const Mesh& mesh,
                                              const Points<double>& points) {
  std::vector<DesignVelocity> velocities;
  std::optional<Eigen::SparseMatrix<double>> matrix;
  std::unique_ptr<Extension> extension;
  std::vector<const ShapeMotion*> alike;  // motions with the same given nodes share a factor
  auto extend = [&] {
    Matrix<double> values = Matrix<double>::Zero(mesh.node_count, alike.size());
    for (std::size_t k = 0; k < alike.size(); ++k) {
      const auto side = evaluate_side(mesh, parse_side_expression(alike[k]->side));
      for (std::size_t n = 0; n < side.nodes.size(); ++n)
        if (alike[k]->node < 0 || alike[k]->node == static_cast<int>(n)) values(side.nodes[n], k) = 1;
    }
    values = (*extension)(std::move(values));
    for (std::size_t k = 0; k < alike.size(); ++k)
      velocities.push_back({body, alike[k]->slot, values.col(k), alike[k]->direction});
    alike.clear();
  };
  for (const auto& motion : scene.shapes) {
    if (motion.body != body) continue;
    if (!matrix) matrix = laplacian(mesh, points);
    auto given = given_nodes(motion, mesh);
    if (!extension || given != extension->given()) {
      if (!alike.empty()) extend();
      extension = std::make_unique<Extension>(*matrix, std::move(given));
    }
    alike.push_back(&motion);
  }
  if (!alike.empty()) extend();
  return velocities;
}

}  // namespace stickslip
