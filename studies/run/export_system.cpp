#include "studies/run/export_system.hpp"

#include <fmt/format.h>

#include <Eigen/SparseCore>
#include <iterator>

#include "core/engine/body_matrix.hpp"
#include "core/model/loading.hpp"
#include "studies/io/output_folder.hpp"
#include "studies/io/printing.hpp"
#include "studies/run/contact_points.hpp"

namespace stickslip {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The bodies' stiffness over all dofs, in the frames of the nodes.
Sparse stiffness_of(const Model& model, const Slots<double>& slots) {
  const int D = model.dimension;
  std::vector<Eigen::Triplet<double>> entries;
  for (int b = 0; b < static_cast<int>(model.bodies.size()); ++b)
    for_each_framed_tangent<double>(model, slots, b, nullptr, [&](const auto& nodes, const auto& K) {
      for (Eigen::Index i = 0; i < K.rows(); ++i)
        for (Eigen::Index j = 0; j < K.cols(); ++j)
          entries.emplace_back(nodes[i / D] * D + i % D, nodes[j / D] * D + j % D, K(i, j));
    });
  Sparse matrix(model.dof_count(), model.dof_count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Nodal forces of the residual per unit traction: one column a multiplier component, over all dofs, in the frames.
Sparse gradient_of(const Model& model, const Slots<double>& slots) {
  const int D = model.dimension;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const auto& geometry = slots.geometry[p];
    for (int c = 0; c < point.components(); ++c)
      for (std::size_t n = 0; n < point.nodes.size(); ++n) {
        Vector<double> force(D);
        for (int i = 0; i < D; ++i)
          force[i] = geometry.area * geometry.weights[n] * (c == 0 ? geometry.normal[i] : geometry.tangents(i, c - 1));
        if (const int framed = framed_index(model, point.nodes[n]); framed >= 0)
          force = (slots.frames[framed].transpose() * force).eval();
        for (int i = 0; i < D; ++i) entries.emplace_back(point.nodes[n] * D + i, point.multiplier + c, force[i]);
      }
  }
  Sparse matrix(model.dof_count(), model.multiplier_count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Rows (and columns) of the free dofs.
Sparse selection(const Model& model) {
  Sparse select(static_cast<Eigen::Index>(model.free_dofs.size()), model.dof_count());
  std::vector<Eigen::Triplet<double>> ones;
  for (std::size_t i = 0; i < model.free_dofs.size(); ++i) ones.emplace_back(i, model.free_dofs[i], 1.0);
  select.setFromTriplets(ones.begin(), ones.end());
  return select;
}

std::string rows_csv(const Model& model, const Slots<double>& slots) {
  std::string text = "row,body,node,x,y,z,component\n";
  for (std::size_t row = 0; row < model.free_dofs.size(); ++row) {
    const int dof = model.free_dofs[row], node = dof / model.dimension;
    std::size_t body = model.bodies.size() - 1;
    while (model.bodies[body].first_node > node) --body;
    text += fmt::format("{},{},{},{},{},{},{}\n", row + 1, csv_text(model.scene.bodies[body].name),
                        node - model.bodies[body].first_node, slots.points(0, node), slots.points(1, node),
                        model.dimension == 3 ? slots.points(2, node) : 0.0,
                        framed_index(model, node) >= 0 ? "inclined" : std::string(1, "xyz"[dof % model.dimension]));
  }
  return text;
}

std::string points_csv(const Model& model, const State<double>& state) {
  std::string text = "row,contact,slave_node,component,state\n";
  for (std::size_t p = 0; p < model.points.size(); ++p)
    for (int c = 0; c < model.points[p].components(); ++c)
      text += fmt::format("{},{},{},{},{}\n", model.points[p].multiplier + c + 1,
                          csv_text(model.scene.contacts[model.points[p].contact].name), model.points[p].nodes[0],
                          c == 0 ? "normal" : "tangent " + std::to_string(c), branch_name(state.contact.state[p]));
  return text;
}

/// A matrix in the format of Matrix Market, all digits.
std::string matrix_market(const Sparse& matrix) {
  std::string text = fmt::format("%%MatrixMarket matrix coordinate real general\n{} {} {}\n", matrix.rows(),
                                 matrix.cols(), matrix.nonZeros());
  for (int j = 0; j < matrix.outerSize(); ++j)
    for (Sparse::InnerIterator entry(matrix, j); entry; ++entry)
      fmt::format_to(std::back_inserter(text), "{} {} {}\n", entry.row() + 1, entry.col() + 1, entry.value());
  return text;
}

std::string matrix_market(const Vector<double>& vector) {
  std::string text = fmt::format("%%MatrixMarket matrix array real general\n{} 1\n", vector.size());
  for (const double x : vector) fmt::format_to(std::back_inserter(text), "{}\n", x);
  return text;
}

constexpr const char* readme =
    R"(The system of the last step, small strain, at time {} ({} displacements, {} multipliers).

  K.mtx       n x n, stiffness of the bodies over the free displacements (force per length)
  G.mtx       n x m, nodal forces per unit traction (area): columns as in points.csv
  lambda.mtx  m, tractions of the contact points; normal ones negative in compression
  f.mtx       n, loads, and what prescribed displacements exert (force)
  u.mtx       n, displacements
  g.mtx       m, area times initial gap and what prescribed displacements add to it; 0 instead of the gap for tangents
  rows.csv    what the rows of K are; points.csv: what the multipliers are

  K u + G lambda = f,    G^T u + g = area * (gap, or slip since the start)

Where a support is inclined, a row is a direction of its frame, not an axis. What obstacles move by is part of g.
)";

}  // namespace

std::vector<std::string> exported_files() {
  return {"K.mtx", "G.mtx", "lambda.mtx", "f.mtx", "u.mtx", "g.mtx", "rows.csv", "points.csv", "README"};
}

std::vector<std::string> export_system(const std::filesystem::path& folder, const CaseResult& result) {
  const auto& model = result.problem->model;
  const auto& slots = result.problem->slots;
  const auto& increment = result.trajectory.increments.back();
  const auto& state = increment.state;
  const auto in_frames = [&](const Vector<double>& v) { return into_frames(model, slots.frames, NodalLayout::all, v); };
  const Sparse K = stiffness_of(model, slots), G = gradient_of(model, slots), select = selection(model);
  const Vector<double> u = in_frames(state.displacement);
  const Vector<double> prescribed = u - Vector<double>(select.transpose() * (select * u));
  const Vector<double> f = in_frames(dead_forces(model, slots, increment.time)) - K * prescribed;
  const RegularisationField<double> no_rho;
  const History<double> no_history;
  const ContactInput<double> input{model, slots, no_rho, no_history, ConeRadius::augmented, increment.time};
  Vector<double> g = G.transpose() * prescribed;
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    const auto& geometry = slots.geometry[p];
    g[point.multiplier] += geometry.area * geometry.gap;
    with_dimension(model.dimension, [&]<int D>() {
      const auto moved = detail::obstacle_displacement<double, D>(input, static_cast<int>(p));
      for (int c = 0; c < point.components(); ++c)
        for (int i = 0; i < D; ++i)
          g[point.multiplier + c] -=
              geometry.area * (c == 0 ? geometry.normal[i] : geometry.tangents(i, c - 1)) * moved[i];
    });
  }
  const Sparse K_free = select * K * select.transpose(), G_free = select * G;
  const std::vector<std::string> names = exported_files(),
                                 contents = {matrix_market(K_free),
                                             matrix_market(G_free),
                                             matrix_market(state.contact.traction),
                                             matrix_market(Vector<double>(select * f)),
                                             matrix_market(Vector<double>(select * u)),
                                             matrix_market(g),
                                             rows_csv(model, slots),
                                             points_csv(model, state),
                                             fmt::format(readme, increment.time, K_free.rows(), G.cols())};
  NamedContents files;
  for (std::size_t i = 0; i < names.size(); ++i) files.emplace_back(names[i], contents[i]);
  write_outputs(folder, files);
  return names;
}

}  // namespace stickslip
