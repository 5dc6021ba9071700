#include "sensitivity/differentiation.hpp"

namespace stickslip {

Numbers<Direction> seeded(const Scene& scene, const std::vector<int>& parameters) {
  auto numbers = scene.as<Direction>();
  for (std::size_t d = 0; d < parameters.size(); ++d)
    for (const auto& [slot, weight] : scene.parameters[parameters[d]].slots) numbers.at_slot[slot].d[d] += weight;
  return numbers;
}

bool keeps_stiffness(const Model& model) {
  return model.times.size() > 2 && static_cast<int>(model.scene.parameters.size()) <= columns_together;
}

std::vector<ParameterBlock> parameter_blocks(const Model& model) {
  std::vector<ParameterBlock> blocks;
  for (const auto& group : parameter_groups(model)) {
    blocks.emplace_back(model, group, make_slots<Direction>(model, seeded(model.scene, group)));
    if (keeps_stiffness(model)) blocks.back().keep_stiffness(model);
  }
  return blocks;
}

Vector<Direction> lift(const Vector<double>& v) {
  return v.unaryExpr([](double x) { return Direction(x); });
}

void add_derivatives(Vector<Direction>& v, const Eigen::Ref<const Matrix<double>>& columns,
                     const ParameterBlock& block) {
  for (std::size_t d = 0; d < block.parameters.size(); ++d)
    for (Eigen::Index i = 0; i < v.size(); ++i) v[i].d[d] += columns(i, block.parameters[d]);
}

PseudoLoad pseudo_load(const Differentiation& problem, const State<double>& at, double time) {
  const Model& model = problem.model;
  const Vector<double>& displacement = at.displacement;
  PseudoLoad load;
  std::vector<Vector<Direction>> rows;
  for (auto& block : problem.blocks) {
    Vector<Direction> u = lift(displacement);
    prescribe(model, block.slots, time, u);
    for (Eigen::Index i = 0; i < u.size(); ++i) u[i].v = displacement[i];
    const Vector<Direction> memory = bulk_flow(model, block.slots, u, block.previous.history.bodies, at.flow);
    Vector<Direction> balance = bulk_forces(model, block.slots, u, memory, &block.touched);
    if (block.stiffness) block.stiffness->add_forces(u, balance);
    balance = less_external_forces(model, block.slots, time, u, std::move(balance));
    rows.push_back(into_frames(model, block.slots.frames, NodalLayout::all, std::move(balance)));
    load.displacement.push_back(std::move(u));
  }
  load.rows = gather(
      problem.blocks, problem.parameters, [&](auto&, int b) -> auto& { return rows[b]; });
  return load;
}

void reduce(Differentiation& problem, std::vector<PseudoLoad>& loads) {
  const int parameters = problem.parameters, count = static_cast<int>(loads.size());
  Matrix<double> rows(problem.model.dof_count(), count * parameters);
  for (int n = 0; n < count; ++n) rows.middleCols(n * parameters, parameters) = loads[n].rows;
  const Reduction<double> reduced = problem.engine.reduce(rows);
  for (int n = 0; n < count; ++n) {
    loads[n].rows.resize(0, 0);
    loads[n].reduced = reduced.columns(n * parameters, parameters);
  }
}

std::vector<Vector<Direction>> without_inside(const Differentiation& problem, Unexpanded increment) {
  const Matrix<double> all = problem.engine.spread(increment.increment);
  auto displacements = std::move(increment.load.displacement);
  for (std::size_t b = 0; b < displacements.size(); ++b) add_derivatives(displacements[b], all, problem.blocks[b]);
  return displacements;
}

std::vector<std::vector<Vector<Direction>>> expand(Differentiation& problem, std::vector<Unexpanded> increments,
                                                   const std::vector<int>* wanted) {
  const int parameters = problem.parameters, count = static_cast<int>(increments.size());
  if (count == 0) return {};
  const auto join = [&](double sign, auto&& part) {
    Matrix<double> all(part(increments[0]).rows(), count * parameters);
    for (int n = 0; n < count; ++n) all.middleCols(n * parameters, parameters) = sign * part(increments[n]);
    return all;
  };
  const Matrix<double> all = problem.engine.expand(join(
                                                       1, [](auto& of) -> auto& { return of.increment; }),
                                                   join(
                                                       -1, [](auto& of) -> auto& { return of.load.reduced.others; }),
                                                   wanted);
  std::vector<std::vector<Vector<Direction>>> displacements;
  for (int n = 0; n < count; ++n) {
    displacements.push_back(std::move(increments[n].load.displacement));
    for (std::size_t b = 0; b < displacements[n].size(); ++b)
      add_derivatives(displacements[n][b], all.middleCols(n * parameters, parameters), problem.blocks[b]);
  }
  return displacements;
}

}  // namespace stickslip
