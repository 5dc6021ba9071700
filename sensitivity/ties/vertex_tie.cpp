#include "core/model/loading.hpp"
#include "core/model/master_geometry.hpp"
#include "sensitivity/ties/tie.hpp"

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

/// `positions`: detail::Positions.
template <class T, class At>
VertexGeometry<T> vertex_geometry(const At& positions, int p, int first, int second) {
  const auto& point = positions.model.points[p];
  const auto& curve = positions.model.surfaces[point.surface];
  const auto placed = [&](int vertex) { return positions.vertex(curve, vertex); };
  const auto& patches = curve.template patches<2>();
  const Placed<T> vertex = placed(patches[first].corner(1));
  const auto position = [&](int of) -> Vec<T, 2> { return placed(of) - vertex; };
  const auto end_geometry = [&](int patch, double end) {
    const auto weights = detail::patch_weights<T>(patches[patch], T(end));
    const Vec<T, 2> slope = detail::on_patch<T>(patches[patch], weights.slope, position),
                    bend = detail::on_patch<T>(patches[patch], weights.bend, position);
    const double speed = value(norm(slope));
    const Vec<T, 2> tangent = slope / norm(slope);
    return std::pair(tangent, cross(values(slope), values(bend)) / (speed * speed * speed));
  };
  const Vec<T, 2> facet = -position(patches[first].corner(0));
  const Vec<T, 2> x = positions.slave(point) - vertex;
  const auto [before, bend_before] = end_geometry(first, 1);
  const auto [after, bend_after] = end_geometry(second, 0);
  const Vec<T, 2> along = before + after;
  const double length = value(norm(facet));
  return {dot(x, along) / (norm(along) * length), std::abs(cross(values(before), values(after))),
          std::abs(bend_after - bend_before) * length, length};
}

/// Whether two patches may have a kink at their vertex: not where they join as one B-spline.
bool has_kink(const Patch<2>& first) { return first.smoothing != Smoothing::b_spline || !first.goes_on(1); }

/// Whether derivatives jump at the end of a patch. Splines share the tangent there; theirs jump where the curvature
/// does.
bool changes_at(const Patch<2>& patch, double bend) {
  return !patch.is_smooth() || !patch.goes_on(1) || bend > straight;
}

/// Calls f(first, second) for both ends of the patch that point p faces, if another patch joins there.
template <class F>
void for_each_vertex(const Model& model, const State<double>& state, int p, F&& f) {
  const auto& point = model.points[p];
  if (model.dimension == 3 || point.surface < 0 || !point.segments.empty()) return;
  const auto& patches = model.surfaces[point.surface].patches<2>();
  const int now = faced_at(model, state, p).patch;
  if (now == no_patch) return;
  for (const auto& [first, second] : {std::pair(patches[now].across[0], now), std::pair(now, patches[now].across[1])}) {
    if (first == no_patch || second == no_patch || !has_kink(patches[first])) continue;
    const int other = first == now ? second : first;
    if (point.own.vertex == no_patch || point.own.may_face(patches, other)) f(first, second);
  }
}

}  // namespace

void VertexTie::find(const SolvedState& of, std::vector<Tie>& ties) {
  const auto& [model, slots, state, memory, rho, cone, time, largest] = of;
  if (!model.slides_on_surfaces()) return;
  const Vector<double> compact = to_compact(model, state.displacement);
  for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
    const auto& point = model.points[p];
    if (!has_a_say(of, p)) continue;
    const bool presses = bears(of, p);
    for_each_vertex(model, state, p, [&, &model = model, &slots = slots, time = time](int first, int second) {
      const auto at = vertex_geometry<double>(detail::positions_at(model, slots, compact, time), p, first, second);
      if (!changes_at(model.surfaces[point.surface].patches<2>()[first], at.bend)) return;
      if (std::abs(at.overshoot) <= weak_margin)
        ties.emplace_back(VertexTie{p, first, second, !presses || at.turn <= straight});
    });
  }
}

std::vector<Choice> VertexTie::choices(const Model&) const {
  if (!crosses) return {};
  return {{first}, {second}};
}

Choice VertexTie::now(const Model&, const State<double>& at) const { return {at.contact.facing[point].patch}; }

void VertexTie::set(const Model& model, const Choice& choice, State<double>& at) const {
  const int patch = choice.branch;
  const double xi = patch == first ? 1 : 0;
  at.contact.facing[point] = {.patch = patch, .at = {xi, 0}};
  at.history.patch[point] = patch;
  const auto& of = model.points[point];
  if (of.foot >= 0) at.history.foot[of.foot] = xi - detail::foot_reference<2>(model, of, patch).at[0];
}

Verdict VertexTie::verdict(const SidedDerivative& derivative) const {
  const auto& [of, block, rho, side, scales, flows] = derivative;
  const Vector<Direction> compact = to_compact(of.model, block.current.displacement);
  const auto found =
      vertex_geometry<Direction>(detail::positions_at(of.model, block.slots, compact, of.time), point, first, second);
  const double rate = derivative.rate(found.overshoot);
  const double negligible = scales.negligible(scales.of_mesh / found.length)[0];
  const bool on_second = of.at.contact.facing[point].patch == second;
  const double by = (on_second ? -rate : rate) / negligible;
  if (!(by > 1)) return {};
  return {crosses, Choice{on_second ? first : second}, by};
}

void for_each_vertex_way(const Model& model, const Slots<Direction>& slots, const Vector<Direction>& displacement,
                         const State<double>& state, double time,
                         const std::function<void(const Direction&, double)>& f) {
  const auto visit = [&](const auto& positions) {
    for (int p = 0; p < static_cast<int>(model.points.size()); ++p) {
      if (state.contact.state[p] == ContactState::open) continue;
      for_each_vertex(model, state, p, [&](int first, int second) {
        const auto at = vertex_geometry<Direction>(positions, p, first, second);
        const auto& patch = model.surfaces[model.points[p].surface].patches<2>()[first];
        if (changes_at(patch, at.bend)) f(at.overshoot, at.length);
      });
    }
  };
  if (!model.slides_on_surfaces()) return visit(detail::positions_of_start(model, slots));
  const Vector<Direction> compact = to_compact(model, displacement);
  visit(detail::positions_at(model, slots, compact, time));
}

}  // namespace stickslip
