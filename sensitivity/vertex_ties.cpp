#include "sensitivity/vertex_ties.hpp"

#include <algorithm>

#include "core/model/contact_geometry.hpp"
#include "core/model/loading.hpp"
#include "sensitivity/one_sided.hpp"

namespace stickslip {
namespace {

/// A contact point near the vertex of two patches.
template <class T>
struct VertexGeometry {
  T overshoot;    ///< distance past the line that separates the patches, over the length of the first facet
  double turn;    ///< sine of the angle between the tangents
  double bend;    ///< jump of the curvature, times the length
  double length;  ///< of the first facet
};

double cross(const Vec<double, 2>& a, const Vec<double, 2>& b) { return a[0] * b[1] - a[1] * b[0]; }

/// `compact`: displacements of the contact nodes.
template <class T>
VertexGeometry<T> vertex_geometry(const Model& model, const Slots<T>& slots, const Vector<T>& compact, double time,
                                  int p, int first, int second) {
  const auto& point = model.points[p];
  const auto& curve = model.curves[point.curve];
  const auto positions = detail::positions_at(model, slots, compact, time);
  const auto placed = [&](int vertex) { return positions.vertex(curve, vertex); };
  const auto& ends = curve.patches[first].vertices;
  const Placed<T> vertex = placed(ends[2]);
  const auto position = [&](int of) -> Vec<T, 2> { return placed(of) - vertex; };
  const auto end_geometry = [&](int patch, double end) {
    const auto weights = detail::patch_weights<T>(curve.patches[patch], T(end));
    const Vec<T, 2> slope = detail::on_patch<T>(curve.patches[patch], weights.slope, position),
                    bend = detail::on_patch<T>(curve.patches[patch], weights.bend, position);
    const double speed = value(norm(slope));
    const Vec<T, 2> tangent = slope / norm(slope);
    return std::pair(tangent, cross(values(slope), values(bend)) / (speed * speed * speed));
  };
  const Vec<T, 2> facet = -position(ends[1]);
  const Vec<T, 2> x = positions.slave(point) - vertex;
  const auto [before, bend_before] = end_geometry(first, 1);
  const auto [after, bend_after] = end_geometry(second, 0);
  const Vec<T, 2> along = before + after;
  const T length = norm(facet);
  return {dot(x, along) / (norm(along) * length), std::abs(cross(values(before), values(after))),
          std::abs(bend_after - bend_before) * value(length), value(length)};
}

/// Whether two patches may have a kink at their vertex: not where they join as one B-spline.
bool has_kink(const Patch& first) { return first.smoothing != Smoothing::b_spline || !first.goes_on_after(); }

constexpr double straight = 1e-6;  // sine up to which a turn is none, as in sided_geometry.cpp

/// Whether derivatives jump at the end of a patch. Splines share the tangent there; theirs jump where the curvature
/// does.
bool changes_at(const Patch& patch, double bend) {
  return patch.smoothing == Smoothing::none || !patch.goes_on_after() || bend > straight;
}

/// Calls f(first, second) for both ends of the patch that point p faces, if another patch joins there.
template <class F>
void for_each_vertex(const Model& model, const State<double>& state, int p, F&& f) {
  const auto& point = model.points[p];
  if (point.curve < 0 || !point.segments.empty() || state.contact.facing.empty()) return;
  const auto& patches = model.curves[point.curve].patches;
  const int now = state.contact.facing[p].patch;
  if (now == Patch::none) return;
  for (const auto& [first, second] : {std::pair(patches[now].previous, now), std::pair(now, patches[now].next)}) {
    if (first == Patch::none || second == Patch::none || !has_kink(patches[first])) continue;
    const int other = first == now ? second : first;
    if (point.own.vertex == Patch::none || point.own.may_face(patches, other)) f(first, second);
  }
}

bool reads_gaps(const Scene& scene) {
  return std::any_of(scene.responses.begin(), scene.responses.end(),
                     [](const Response& response) { return response.kind == Response::Kind::gap; });
}

}  // namespace

std::vector<VertexTie> vertex_ties(const Model& model, const Slots<double>& slots, const State<double>& state,
                                   double time, double largest) {
  std::vector<VertexTie> ties;
  if (!model.slides_along_curves()) return ties;
  const bool all = reads_gaps(model.scene);
  const Vector<double> compact = to_compact(model, state.displacement);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    const bool open = state.contact.state[p] == ContactState::open;
    const double elastic = slots.stiffness[p] / slots.geometry[p].area;
    const bool touches = open && elastic * state.contact.gap[p] <= weak_margin * largest;
    if (open && !touches && !all) continue;
    const bool bears = -state.contact.traction[point.multiplier] > weak_margin * largest;
    for_each_vertex(model, state, p, [&](int first, int second) {
      const auto at = vertex_geometry(model, slots, compact, time, p, first, second);
      if (!changes_at(model.curves[point.curve].patches[first], at.bend)) return;
      if (std::abs(at.overshoot) <= weak_margin) ties.push_back({p, first, second, !bears || at.turn <= straight});
    });
  }
  return ties;
}

void for_each_vertex_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                         const State<double>& state, double time,
                         const std::function<void(const Direction&, double)>& f) {
  const Vector<Direction> compact = to_compact(model, displacement);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    if (state.contact.state[p] == ContactState::open) continue;
    for_each_vertex(model, state, p, [&](int first, int second) {
      const auto at = vertex_geometry(model, slots, compact, time, p, first, second);
      const auto& patch = model.curves[model.points[p].curve].patches[first];
      if (changes_at(patch, at.bend)) f(at.overshoot, at.length);
    });
  }
}

void set_patch(const Model& model, const VertexTie& tie, int patch, State<double>& at) {
  const double xi = patch == tie.first ? 1 : 0;
  at.contact.facing[tie.point] = {patch, xi, 0};
  at.history.patch[tie.point] = patch;
  const auto& point = model.points[tie.point];
  if (point.foot >= 0) at.history.foot[point.foot] = xi - detail::foot_reference(model, point, patch);
}

VertexVerdict vertex_verdict(const Model& model, const ParameterBlock& block, const VertexTie& tie,
                             const State<double>& at, double time, const SideDirection& along) {
  constexpr double share = 1e-10, rigid = 1e-3;  // as for contact points (sensitivity/branches.cpp)
  const auto found = vertex_geometry(model, block.slots, to_compact(model, block.current.displacement), time, tie.point,
                                     tie.first, tie.second);
  double motion = 0;
  for (const auto& u : block.current.displacement) motion = std::max(motion, std::abs(u.d[0]));
  for (Eigen::Index k = 0; k < block.slots.points.size(); ++k)
    motion = std::max(motion, std::abs(block.slots.points.data()[k].d[0]));
  const double rate = along.side * found.overshoot.d[0];
  const double negligible =
      share * std::max(rigid * motion / found.length, along.parameter > 0 ? 1 / along.parameter : 0.0);
  const bool on_second = at.contact.facing[tie.point].patch == tie.second;
  const double by = (on_second ? -rate : rate) / negligible;
  if (!(by > 1)) return {};
  return {on_second ? tie.first : tie.second, by};
}

}  // namespace stickslip
