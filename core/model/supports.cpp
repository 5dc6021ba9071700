#include "core/model/supports.hpp"

#include <Eigen/QR>
#include <map>
#include <set>

namespace stickslip {
namespace {

/// Sine of the least angle between a direction and the span of others at which it counts as a new one.
constexpr double new_direction = 1e-9;

/// JSON pointer of what a constraint comes from.
std::string pointer_of(const Scene& scene, const Constraint& constraint) {
  const std::string support = "/supports/" + std::to_string(constraint.support);
  if (constraint.axis == Constraint::inclined) return support + "/along";
  const bool moves = scene.supports[constraint.support].move.count(constraint.axis) > 0;
  return support + (moves ? std::string("/move/") + constraint.axis : "/rotate");
}

std::vector<Constraint> constraints_of(const Scene& scene, int support) {
  const Support& of = scene.supports[support];
  std::vector<Constraint> all;
  for (const auto& [axis, unused] : of.move)
    if (axis < 'x' || axis >= 'x' + scene.dimension())
      throw ModelError(std::string("there is no axis ") + axis + " in this space",
                       "/supports/" + std::to_string(support));
  if (of.inclined) return {{0, support, Constraint::inclined}};
  for (int i = 0; i < scene.dimension(); ++i)
    if (const char axis = static_cast<char>('x' + i); of.rotate || of.move.count(axis))
      all.push_back({0, support, axis});
  return all;
}

/// A support may say of the axis of revolution only what holds there anyway.
void check_axis(const Scene& scene, const Constraint& constraint) {
  const Support& support = scene.supports[constraint.support];
  bool stays = constraint.axis != Constraint::inclined && !support.rotate;
  if (const auto table = support.move.find('x'); table != support.move.end())
    for (const auto& point : table->second.points) stays &= point.second.value == 0;
  if (!stays)
    throw ModelError("moves a node of the axis of revolution off it; x must be 0 there", pointer_of(scene, constraint));
}

/// The constraints of one node so far, whose directions are independent.
struct Held {
  std::vector<Constraint> constraints;

  /// Adds one; where its direction is not a new one it must prescribe what the others do already.
  void add(const Scene& scene, const Numbers<double>& numbers, const Constraint& constraint, const Eigen::VectorXd& x) {
    const Eigen::VectorXd d = direction(scene, constraint, numbers);
    Eigen::MatrixXd others(d.size(), constraints.size());
    for (std::size_t c = 0; c < constraints.size(); ++c) others.col(c) = direction(scene, constraints[c], numbers);
    Eigen::VectorXd weights;
    if (!constraints.empty()) weights = others.colPivHouseholderQr().solve(d);
    if (constraints.empty() || (d - others * weights).norm() > new_direction) return constraints.push_back(constraint);
    std::set<double> times;
    const auto take = [&](double t) { times.insert(t); };
    for_each_breakpoint(scene.supports[constraint.support], take);
    for (const auto& other : constraints) for_each_breakpoint(scene.supports[other.support], take);
    if (scene.finite_strain)  // between breakpoints a place that is turned runs along an arc
      for (auto next = times.begin(); next != times.end() && std::next(next) != times.end(); ++next)
        next = times.insert((*next + *std::next(next)) / 2).first;
    double largest = 0, difference = 0;
    std::size_t with = 0;  // who has the largest say
    for (std::size_t c = 1; c < constraints.size(); ++c)
      if (std::abs(weights[c]) > std::abs(weights[with])) with = c;
    for (double t : times) {
      const double own = prescribed_value(scene, constraint, x, t, numbers);
      double theirs = 0;
      for (std::size_t c = 0; c < constraints.size(); ++c)
        theirs += weights[c] * prescribed_value(scene, constraints[c], x, t, numbers);
      largest = std::max({largest, std::abs(own), std::abs(theirs)});
      difference = std::max(difference, std::abs(own - theirs));
    }
    if (difference <= 1e-10 * largest) return;  // rounding of directions and of arms
    throw ModelError("moves a node that " + scene.supports[constraints[with].support].on +
                         " has too differently from the support there (" + pointer_of(scene, constraints[with]) + ")",
                     pointer_of(scene, constraint));
  }
};

}  // namespace

void number_dofs(Model& model, const Points<double>& points) {
  const Scene& scene = model.scene;
  const auto numbers = scene.as<double>();
  const int D = model.dimension;
  std::map<int, Held> held;
  std::set<int> axis;  // of revolution: its nodes have no radial direction to move in
  for (int node = 0; node < model.node_count; ++node)
    if (model.is_on_axis(points, node)) axis.insert(node);
  for (int s = 0; s < static_cast<int>(scene.supports.size()); ++s) {
    const auto constraints = constraints_of(scene, s);
    for (int node : model.support_sides[s].nodes)
      for (const auto& constraint : constraints) {
        const bool radial = axis.count(node) > 0 && constraint.axis != 'y';
        if (radial)
          check_axis(scene, constraint);
        else
          held[node].add(scene, numbers, constraint, points.col(node));
      }
  }
  std::set<int> anchors;  // an anchor stays where nobody moves it
  for (const auto& body : model.bodies)
    if (body.mesh.shape == ElementShape::point) anchors.insert(body.first_node + 1);
  for (int anchor : anchors) held[anchor];
  for (int node : axis) held[node].constraints.push_back({0, -1, 'x'});
  for (auto& [node, of] : held) {
    const bool framed = std::any_of(of.constraints.begin(), of.constraints.end(),
                                    [](const auto& c) { return c.axis == Constraint::inclined; });
    for (int k = 0; k < static_cast<int>(of.constraints.size()); ++k)
      of.constraints[k].dof = node * D + (framed ? k : of.constraints[k].axis - 'x');
    for (int dof = node * D; anchors.count(node) && dof < (node + 1) * D; ++dof)
      if (std::none_of(of.constraints.begin(), of.constraints.end(), [&](const auto& c) { return c.dof == dof; }))
        of.constraints.push_back({dof, -1, 'x'});
    std::sort(of.constraints.begin(), of.constraints.end(), [](const auto& a, const auto& b) { return a.dof < b.dof; });
    model.constraints.insert(model.constraints.end(), of.constraints.begin(), of.constraints.end());
    if (framed) model.framed.push_back({node, -1, of.constraints});
  }
  model.free_index.assign(model.dof_count(), 0);
  for (const auto& constraint : model.constraints) model.free_index[constraint.dof] = -1;
  for (int dof = 0; dof < model.dof_count(); ++dof)
    if (model.free_index[dof] == 0) {
      model.free_index[dof] = static_cast<int>(model.free_dofs.size());
      model.free_dofs.push_back(dof);
    }
}

}  // namespace stickslip
