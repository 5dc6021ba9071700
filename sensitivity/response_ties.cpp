#include "sensitivity/response_ties.hpp"

namespace stickslip {
namespace {

/// The values of which Scene::responses[index] takes one. pre: can_tie of it.
std::vector<double> samples_of(const Model& model, const Slots<double>& slots, std::size_t index,
                               const State<double>& state) {
  const Response& response = model.scene.responses[index];
  const ResponsePlace& place = model.response_places[index];
  std::vector<double> samples;
  if (response.kind == Response::Kind::displacement) {
    for (int node : place.nodes) samples.push_back(state.displacement[node * model.dimension + response.axis()]);
    return samples;
  }
  for (int p : place.points) {
    const auto& point = model.points[p];
    if (response.kind == Response::Kind::contact_pressure)
      samples.push_back(-state.contact.traction[point.multiplier]);
    else if (response.kind == Response::Kind::gap)
      samples.push_back(state.contact.gap[p]);
    else if (point.tangents > 0)
      samples.push_back(detail::slip_component(model, slots, state, p, response));
  }
  return samples;
}

}  // namespace

bool has_tied_responses(const Model& model, const Slots<double>& slots, const State<double>& state) {
  for (std::size_t i = 0; i < model.scene.responses.size(); ++i) {
    const Response& response = model.scene.responses[i];
    if (!can_tie(response)) continue;
    const auto samples = samples_of(model, slots, i, state);
    if (samples.empty()) continue;
    const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
    const double taken = response.take == Response::Take::max ? *most : *least;
    const double size = std::max(std::abs(*least), std::abs(*most));
    if (std::count_if(samples.begin(), samples.end(),
                      [&](double sample) { return std::abs(sample - taken) <= take_tie * size; }) > 1)
      return true;
  }
  return false;
}

void take_side_of_ties(const Model& model, const ParameterBlock& block, const State<Direction>& at, Ties side,
                       Matrix<double>& of) {
  constexpr double rounding = 1e-9;
  const auto& responses = model.scene.responses;
  for (int i = 0; i < static_cast<int>(responses.size()); ++i) {
    if (!can_tie(responses[i])) continue;
    const bool is_length = responses[i].kind != Response::Kind::contact_pressure;
    double per_length = is_length ? 1 : 0;  // response per length
    for (std::size_t p = 0; !is_length && p < model.points.size(); ++p)
      per_length = std::max(per_length, value(block.slots.stiffness[p]) / value(block.slots.geometry[p].area));
    const Direction on_side = evaluate_response(model, block.slots, i, at, {}, side);
    Direction::Gradient motion = Direction::Gradient::Zero();
    for (const auto& u : at.displacement) motion = motion.max(u.d.abs());
    for (std::size_t d = 0; d < block.parameters.size(); ++d) {
      const auto k = static_cast<Eigen::Index>(d);
      double& derivative = of(i, block.parameters[d]);
      if (std::abs(on_side.d[k] - derivative) > rounding * per_length * motion[k]) derivative = on_side.d[k];
    }
  }
}

}  // namespace stickslip
