/// Definitions of the templates in engine.hpp.
#pragma once

#include <limits>

#include "core/engine/condensed_bodies.hpp"
#include "core/engine/dense_system.hpp"
#include "core/engine/engine.hpp"
#include "core/engine/mixed_bodies.hpp"
#include "core/engine/sparse_system.hpp"

namespace stickslip {

template <class T>
void Engine<T>::let_solve(std::size_t system) {
  if (std::exchange(solving_, system) != system) this->system().take_over();
}

template <class T>
Vector<T> Engine<T>::begin(double time, const Vector<T>& displacement, const Vector<T>& before) {
  let_solve(0);
  Vector<T> u = displacement;
  prescribe(model_, slots_, time, u);
  return bodies_->begin(time, into_frames(model_, slots_.frames, NodalLayout::all, std::move(u)), before);
}

template <class T>
Vector<T> Engine<T>::residual(const Vector<T>& u, const Vector<T>& contact, ForceScale& scale) const {
  const int D = model_.dimension;
  Vector<T> rows = bodies_->residual(u, system(), scale);
  scale.force = std::max(scale.force, largest_nodal_norm(contact, D));
  scale.rounding = unit_roundoff * stiffness_ * largest_nodal_norm(u, D);
  bodies_->add_contact(into_frames(model_, slots_.frames, NodalLayout::compact, contact), rows);
  return rows;
}

template <class T>
void Engine<T>::linearise(const BodyMotion<T>& at) {
  if (model_.effects.linear_bulk) return;
  bodies_->linearise(at);
  system().take_bodies();
}

template <class T>
void Engine<T>::fix_linearisation(const BodyMotion<T>& at, const Vector<T>& u, FixedTangent tangent) {
  if (model_.effects.linear_bulk) return;
  if (tangent == FixedTangent::at_motion) linearise(at);
  bodies_->fix(at, u);
}

template <class T>
bool Engine<T>::has_tangent_near(const BodyMotion<T>& at) const {
  constexpr double near = 1e-4;
  const Vector<T>* condensed_at = system().condensed_at();
  if (!condensed_at) return false;
  double facet = std::numeric_limits<double>::infinity();
  for (const auto& point : model_.points) facet = std::min(facet, point.mesh_size);
  const Vector<T> moved = at.displacement - *condensed_at;
  return largest_nodal_norm(moved, model_.dimension) <= near * facet;
}

template <class T>
bool Engine<T>::factorise(const std::vector<PointTangent<T>>& tangents, Counters& counters,
                          const Vector<double>& anchor) {
  if (!system().accepts_bodies(counters)) let_solve(1);
  return system().factorise(tangents, anchor, counters);
}

template <class T>
EngineReport Engine<T>::report() const {
  EngineReport report;
  system().add_to_report(report);
  bodies_->add_to_report(report);
  return report;
}

template <class T>
void Engine<T>::restore(const EngineMemory<T>& memory, Counters& counters) {
  let_solve(0);
  system().restore(memory, counters);
}

template <class T>
Engine<T> sparse_engine(const Model& model, const Slots<T>& slots, const SystemKind& kind) {
  auto bodies = std::make_unique<FullBodies<T>>(model, slots);
  auto system = std::make_unique<SparseSystem<T>>(model, slots, kind, *bodies);
  return {model, slots, std::move(bodies), std::move(system)};
}

template <class T>
Engine<T> condensed_engine(const Model& model, const Slots<T>& slots, const SystemKind& kind,
                           std::shared_ptr<Condensation<T>> condensation) {
  if (model.effects.linear_bulk) {
    auto system = std::make_unique<DenseSystem<T>>(model, slots, kind, condensation->schur());
    return {model, slots, std::make_unique<AllBodiesCondensed<T>>(model, slots, std::move(condensation)),
            std::move(system)};
  }
  auto bodies = std::make_unique<SomeBodiesCondensed<T>>(model, slots, std::move(condensation));
  auto system = std::make_unique<SparseSystem<T>>(model, slots, kind, *bodies);
  return {model, slots, std::move(bodies), std::move(system)};
}

}  // namespace stickslip
