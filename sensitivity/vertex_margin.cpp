#include "sensitivity/vertex_margin.hpp"

#include <algorithm>
#include <limits>

#include "core/model/loading.hpp"
#include "core/model/moved_point.hpp"

namespace stickslip {
namespace {

using Place = Vec<double, 2>;

bool is_facet(const Patch& patch) { return patch.smoothing == Smoothing::none; }

/// The least way of a point at x to an end of what it faces, over its length. `place(vertex)`: where that is.
template <class Places>
double least_way(const std::vector<Patch>& patches, int faced, const Place& x, Places&& place) {
  const auto along = [&](int patch) -> Place {
    const auto& ends = patches[patch].vertices;
    return place(ends[2]) - place(ends[1]);
  };
  double least = std::numeric_limits<double>::infinity();
  const double length = along(faced).norm();
  for (const int side : {0, 1}) {
    const int other = side == 0 ? patches[faced].previous : patches[faced].next;
    if (other == Patch::none) continue;
    const Place vertex = place(patches[faced].vertices[1 + side]);
    const Place half = (along(faced).normalized() + along(other).normalized()).normalized();
    least = std::min(least, std::abs((x - vertex).dot(half)) / length);
  }
  return least;
}

}  // namespace

bool slides_along_facets(const Model& model) {
  const auto has_facets = [](const MasterCurve& curve) {
    return std::any_of(curve.patches.begin(), curve.patches.end(), is_facet);
  };
  return model.slides_along_curves() && std::any_of(model.curves.begin(), model.curves.end(), has_facets);
}

double vertex_margin(const Model& model, const Slots<double>& slots, const State<double>& state, double time) {
  double least = std::numeric_limits<double>::infinity();
  if (!slides_along_facets(model)) return least;
  const RegularisationField<double> unread_rho;
  const ContactInput<double> input{model, slots, unread_rho, state.history, ConeRadius::augmented, time, nullptr};
  const Vector<double> compact = to_compact(model, state.displacement);
  const auto moved = detail::displacement_in(compact);
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const auto& point = model.points[p];
    if (point.curve < 0 || state.contact.state[p] == ContactState::open) continue;
    const auto& curve = model.curves[point.curve];
    const int faced = state.contact.facing[p].patch;
    if (faced == Patch::none || !is_facet(curve.patches[faced])) continue;
    const Place x = slots.points.col(point.nodes[0]).head<2>() + moved(point.places[0]);
    least = std::min(least, least_way(curve.patches, faced, x, [&](int vertex) {
                       return detail::vertex_of<double, double>(input, curve, vertex, moved);
                     }));
  }
  return least;
}

}  // namespace stickslip
