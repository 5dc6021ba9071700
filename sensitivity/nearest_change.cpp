#include "sensitivity/nearest_change.hpp"

#include <limits>

#include "core/model/positions.hpp"
#include "sensitivity/ties/tie.hpp"

namespace stickslip {
namespace {

using ByDirection = RateScales::ByDirection;

/// 1 over the size of each parameter of a block; 0 where it is not known.
ByDirection per_size(const Model& model, const ParameterBlock& block) {
  ByDirection per = ByDirection::Zero();
  for (std::size_t d = 0; d < block.parameters.size(); ++d)
    if (const double value = model.scene.parameters[block.parameters[d]].value; value != 0)
      per[static_cast<Eigen::Index>(d)] = 1 / std::abs(value);
  return per;
}

/// Reads the margins of one increment.
class ChangeReader {
 public:
  ChangeReader(const Model& model, const Slots<double>& slots, const DifferentiatedIncrement& of,
               NearestChange& nearest)
      : model_(model),
        slots_(slots),
        of_(of),
        nearest_(nearest),
        scales_(model, slots, of.block, of.at, per_size(model, of.block), of.largest),
        negligible_(rounding_share * scales_.of_tractions) {}

  void read_contact() {
    for (int p = 0; p < static_cast<int>(model_.points.size()); ++p) read_point(p);
  }

  void read_flow() {
    const BodyMotion<Direction> motion{of_.at.displacement, of_.memory, of_.time, &of_.state.flow};
    for_each_flow_point<Direction>(model_, of_.block.slots, motion, nullptr,
                                   [&](const FlowPoint<Direction>& point) { read_flow_point(point); });
  }

  /// At small strain: a slave node leaves the facet, face or patch that it faced at the start.
  void read_places_of_start() {
    for (int p = 0; p < static_cast<int>(model_.points.size()); ++p)
      if (of_.state.contact.state[p] != ContactState::open) read_place_of_start(p);
    read_vertices();
  }

  void read_vertices() {
    const auto read = [&](const Direction& way, double length) {
      read_way(way, length, std::abs(way.v) <= weak_margin);
    };
    const auto for_each_way = model_.dimension == 3 ? for_each_edge_way : for_each_vertex_way;
    for_each_way(model_, of_.block.slots, of_.at.displacement, of_.state, of_.time, read);
  }

 private:
  /// Lowers the distances by those to the zero of a margin. `tie`: it counts as zero; `negligible`: derivatives up to
  /// this count as zero.
  void lower(const Direction& margin, bool tie, const ByDirection& negligible) {
    for (std::size_t d = 0; d < of_.block.parameters.size(); ++d) {
      const auto k = static_cast<Eigen::Index>(d);
      const int j = of_.block.parameters[d];
      const double rate = margin.d[k];
      if (!(std::abs(rate) > negligible[k]) || !std::isfinite(margin.v)) continue;
      if (tie) {
        nearest_.row(j).setZero();
        continue;
      }
      lower_way(j, -margin.v / rate);
    }
  }

  void lower_way(int parameter, double way) {
    double& side = nearest_(parameter, way < 0 ? 0 : 1);
    side = std::min(side, std::abs(way));
  }

  /// A way to where another part of the master is faced, as a share of a length; `tie`: it is none.
  void read_way(const Direction& way, double length, bool tie) {
    lower(way, tie, scales_.negligible(scales_.of_mesh / length));
  }

  /// (A place may be past the end of its facet by rounding.)
  void read_place(const Direction& way, double length) { read_way(way, length, way.v <= weak_margin); }

  /// On a facet the way is that to its ends. In a face the weight of a corner is zero where the node leaves the face.
  void read_place_of_start(int p) {
    using Master = ContactPoint::Master;
    const auto& point = model_.points[p];
    const auto& slots = of_.block.slots;
    if (point.master == Master::facet) {
      const auto place = [&](int node) { return detail::start_of<2>(model_, point.obstacle, slots, node); };
      const auto c = place(point.corners[0]), x = place(point.nodes[0]);
      const Vec<Direction, 2> along = place(point.corners[1]) - c;
      const Direction length = norm(along), way = dot(Vec<Direction, 2>(x - c), along) / length;
      for (const Direction& to : {way, Direction(length - way)}) read_place(to / value(length), value(length));
    } else if (point.master == Master::faces && point.faces.size() == 1 && point.mesh_size > 0) {
      const auto& weights = slots.geometry[p].weights;
      for (Eigen::Index k = point.slave_nodes; k < weights.size(); ++k) read_place(-weights[k], point.mesh_size);
    }
  }

  void read_point(int p) {
    const auto& point = model_.points[p];
    const auto& contact = of_.at.contact;
    const ContactState state = of_.state.contact.state[p];
    const double elastic = elastic_traction(slots_, p);
    const double none = weak_margin * of_.largest;
    if (state == ContactState::open)
      return lower(contact.gap[p], elastic * contact.gap[p].v <= none, negligible_ / elastic);
    const Direction pressure = -contact.traction[point.multiplier];
    lower(pressure, pressure.v <= none, negligible_);
    if (point.tangents == 0) return;
    const auto& law = of_.block.slots.friction[point.contact];
    const double size = law.bound(pressure.v);
    if (!(size > 0)) return;
    if (state == ContactState::stick) {
      const Vector<Direction> traction = contact.traction.segment(point.multiplier + 1, point.tangents);
      return read_stick(law.bound(pressure, law.piece(pressure.v)), traction);
    }
    const Direction slip = slip_of(p, law.bound(pressure, state));
    lower(slip, elastic * slip.v <= weak_margin * size, negligible_ / elastic);
    if (!law.corner()) return;
    const Direction apart = law.bound(pressure, ContactState::slip) - law.bound(pressure, ContactState::limited);
    lower(apart, std::abs(apart.v) <= weak_margin * size, negligible_);
  }

  /// A traction that moves along a line leaves its cone at both ends: |t + Dt w| = bound + Dbound w.
  void read_stick(const Direction& bound, const Vector<Direction>& traction) {
    const double least = weak_margin * bound.v;
    const Direction now = norm(traction);
    const bool tie = bound.v - now.v <= least;
    if (tie) return lower(bound - now, tie, negligible_);
    for (std::size_t d = 0; d < of_.block.parameters.size(); ++d) {
      const auto k = static_cast<Eigen::Index>(d);
      double squared = 0, along = 0;  // Dt . Dt and t . Dt
      for (const auto& t : traction) {
        squared += t.d[k] * t.d[k];
        along += t.v * t.d[k];
      }
      if (std::max(std::sqrt(squared), std::abs(bound.d[k])) <= negligible_[k]) continue;
      const double a = squared - bound.d[k] * bound.d[k], h = along - bound.v * bound.d[k];
      const double c = now.v * now.v - bound.v * bound.v, root = h * h - a * c;
      constexpr double rounding = 1e-12;  // of h^2: without a traction the two ends are one, where the bound is zero
      if (!(root >= -rounding * h * h)) continue;
      const double q = -(h + std::copysign(std::sqrt(std::max(root, 0.0)), h));
      for (const double way : {q / a, c / q})
        if (std::isfinite(way) && bound.v + bound.d[k] * way >= -least) lower_way(of_.block.parameters[d], way);
    }
  }

  static ByDirection size_of_rates(const Vector<Direction>& of) {
    ByDirection squares = ByDirection::Zero();
    for (const auto& component : of) squares += component.d.square();
    return squares.sqrt();
  }

  /// Slip of the increment of a point that slips, length; of a spring what it does not hold of it.
  Direction slip_of(int p, const Direction& bound) const {
    const auto& point = model_.points[p];
    const Vector<Direction> slip = of_.at.contact.slip.segment(tangential_offset(model_, p), point.tangents);
    if (!of_.springs) return norm(values(slip)) > 0 ? norm(slip) : Direction(0.0, size_of_rates(slip));
    const Direction& rho = (*of_.springs)[p].tangential;
    Vector<Direction> trial = of_.at.multiplier.segment(point.multiplier + 1, point.tangents);
    for (int a = 0; a < point.tangents; ++a) trial[a] += rho * slip[a];
    return (norm(trial) - bound) / rho;
  }

  void read_flow_point(const FlowPoint<Direction>& point) {
    const auto& [stress, before, after, modulus] = point.trial;
    const Direction bound = point.hardening.bound(before);
    const Direction excess = (stress - bound) / bound.v;
    const ByDirection negligible = negligible_of_flow(point, bound, ByDirection::Zero(), scales_);
    lower(excess, std::abs(excess.v) <= weak_margin, negligible);
    if (!(after.v > before.v)) return;
    for (const auto& row : point.hardening.rows)
      lower((after - row.strain) * (modulus.v / bound.v), std::abs(after.v / row.strain.v - 1) <= weak_margin,
            negligible);
  }

  const Model& model_;
  const Slots<double>& slots_;
  const DifferentiatedIncrement& of_;
  NearestChange& nearest_;
  RateScales scales_;
  ByDirection negligible_;  ///< of tractions
};

}  // namespace

NearestChange no_change(const Model& model) {
  return NearestChange::Constant(static_cast<Eigen::Index>(model.scene.parameters.size()), 2,
                                 std::numeric_limits<double>::infinity());
}

void lower_nearest_change(const Model& model, const Slots<double>& slots, const DifferentiatedIncrement& increment,
                          NearestChange& nearest) {
  ChangeReader reader(model, slots, increment, nearest);
  reader.read_contact();
  if (model.effects.plasticity) reader.read_flow();
  model.slides_on_surfaces() ? reader.read_vertices() : reader.read_places_of_start();
}

}  // namespace stickslip
