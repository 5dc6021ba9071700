/// Rigid statics: whether forces of contacts and supports can balance the loads on the bodies, taken as rigid. This is
/// necessary for any equilibrium, and separates "cannot be solved" from "was not solved".
#pragma once

#include <map>
#include <string>

#include "core/model/contact_assembly.hpp"
#include "core/model/loading.hpp"

namespace stickslip {

/// Forces that contacts and supports can exert, one per column. Three rows per body: force along x, force along y,
/// moment about the middle of the model over its size.
struct RigidStatics {
  /// Three columns per contact point, with factors >= 0: the edges n - mu e and n + mu e of its cone, and zero. If its
  /// friction law has no cone: n, -e and e.
  Matrix<double> pushes;
  Matrix<double> holds;  ///< one column per constraint, with factors of either sign
  Vector<double> load;
  Matrix<double> tangential;  ///< one row per point with a limited law: its tangential force per factor of `pushes`
  Vector<double> limit;       ///< largest size of these tangential forces, force
};

/// Share of the load that these forces cannot balance: the least |load + pushes x + holds y| / |load| over x >= 0 and y
/// with |tangential x| <= limit; if the limit cannot be met, the excess counts too. 0 without load. By non-negative
/// least squares [LH74].
double unbalanced_share(const RigidStatics& statics);

/// Whether the normal of a point is that of the start at all times: of a plane that does not rotate, or if the geometry
/// is that of the start.
inline bool keeps_its_normal(const Model& model, const ContactPoint& point) {
  if (!model.scene.finite_strain) return true;
  if (point.obstacle < 0) return false;
  const auto& obstacle = model.scene.obstacles[point.obstacle];
  return is_flat(obstacle.shape) && !obstacle.rotate;
}

/// Adds forces at nodes, or their moments too, to columns of RigidStatics.
struct ForceColumns {
  const Model& model;
  Matrix<double> X;  ///< coordinates of the nodes
  Vec<double, 2> centre;
  double size;       ///< of the model
  bool has_moments;  ///< false where arms change, and of a model that is one place

  ForceColumns(const Model& model, Matrix<double> at)
      : model(model),
        X(std::move(at)),
        centre((X.rowwise().maxCoeff() + X.rowwise().minCoeff()).head<2>() / 2),
        size((X.rowwise().maxCoeff() - X.rowwise().minCoeff()).norm()),
        has_moments(!model.scene.finite_strain && size > 0) {}

  template <class Column>
  void add(Column column, int node, const Vec<double, 2>& force) const {
    std::size_t body = 0;
    while (body + 1 < model.bodies.size() && node >= model.bodies[body + 1].first_node) ++body;
    const Vec<double, 2> arm = X.col(node).head<2>() - centre;
    const double moment = has_moments ? (arm[0] * force[1] - arm[1] * force[0]) / size : 0;
    column.template segment<3>(3 * static_cast<Eigen::Index>(body)) += Vec<double, 3>(force[0], force[1], moment);
  }
};

/// Sets the columns of point p, and adds the row of a law that is limited.
template <class T>
void add_pushes(const Slots<T>& slots, const ForceColumns& columns, std::size_t p, RigidStatics& statics) {
  const Model& model = columns.model;
  const auto& point = model.points[p];
  if (!keeps_its_normal(model, point)) {
    constexpr double third = 2 * M_PI / 3;  // three directions with factors >= 0 span all
    for (int k = 0; k < 3; ++k) {
      const Vec<double, 2> force(std::cos(k * third), std::sin(k * third));
      columns.add(statics.pushes.col(3 * p + k), point.nodes[0], force);
      if (point.obstacle < 0)
        columns.add(statics.pushes.col(3 * p + k), model.surfaces[point.surface].nodes[0], -force);
    }
    return;
  }
  const auto& geometry = slots.geometry[p];
  const auto& law = slots.friction[point.contact];
  const bool rough = point.tangents > 0 && !law.bears_nothing(), has_cone = !rough || law.couples();
  const double mu = rough ? value(law.slope_at_apex()) : 0;
  const Vec<double, 2> normal = values(geometry.normal);
  const Vec<double, 2> along = rough ? Vec<double, 2>(values(geometry.tangents.col(0))) : Vec<double, 2>(0, 0);
  const auto push = [&](int k, double across, double tangential) {
    const double size = std::hypot(across, tangential);
    for (std::size_t n = 0; n < point.nodes.size(); ++n)
      columns.add(statics.pushes.col(3 * p + k), point.nodes[n],
                  value(geometry.weights[n]) * Vec<double, 2>((across * normal + tangential * along) / size));
    return tangential / size;
  };
  Vec<double, 3> tangential = Vec<double, 3>::Zero();
  if (has_cone)
    tangential.head<2>() = Vec<double, 2>(push(0, 1, -mu), push(1, 1, mu));
  else
    tangential = Vec<double, 3>(push(0, 1, 0), push(1, 0, -1), push(2, 0, 1));
  if (!rough || !law.has(ContactState::limited)) return;
  statics.tangential.conservativeResize(statics.tangential.rows() + 1, statics.pushes.cols());
  statics.tangential.bottomRows(1).setZero();
  statics.tangential.bottomRows(1).middleCols(3 * p, 3) = tangential.transpose();
  statics.limit.conservativeResize(statics.tangential.rows());
  statics.limit[statics.limit.size() - 1] = value(law.bound(T(0), ContactState::limited)) * value(geometry.area);
}

/// Direction in space of a dof in the plane.
template <class T>
Vec<double, 2> direction_of(const Slots<T>& slots, const Model& model, int dof) {
  const int framed = framed_index(model, dof / 2);
  if (framed < 0) return Vec<double, 2>::Unit(dof % 2);
  return values(slots.frames[framed]).col(dof % 2);
}

/// Rigid statics of a model at a time. At finite strain moments are left out, for arms change, and a point whose
/// normal may turn can push in all directions: what is not balanced then cannot be balanced anywhere.
/// pre: 2D, not axisymmetric; no load follows its side.
template <class T>
RigidStatics rigid_statics(const Model& model, const Slots<T>& slots, double time) {
  const ForceColumns columns(model, slots.points.unaryExpr([](const T& x) { return value(x); }));
  const auto rows = static_cast<Eigen::Index>(3 * model.bodies.size());
  RigidStatics statics{Matrix<double>::Zero(rows, 3 * model.points.size()),
                       Matrix<double>::Zero(rows, model.constraints.size()),
                       Vector<double>::Zero(rows),
                       {},
                       {}};
  for (std::size_t p = 0; p < model.points.size(); ++p) add_pushes(slots, columns, p, statics);
  for (std::size_t k = 0; k < model.constraints.size(); ++k)
    columns.add(statics.holds.col(k), model.constraints[k].dof / 2,
                direction_of(slots, model, model.constraints[k].dof));
  const Vector<double> external =
      values(external_forces(model, slots, time, Vector<T>::Constant(model.dof_count(), T(0)).eval()));
  for (int node = 0; node < model.node_count; ++node)
    columns.add(statics.load.col(0), node, Vec<double, 2>(external.segment(2 * node, 2)));
  return statics;
}

/// Results of unbalanced_body() that are no index: all bodies can be balanced; only several together cannot.
inline constexpr int balanced = -1, a_group = -2;

/// Index of a body whose load cannot be balanced. `balanced` if there is none, or if this is not known: in 3D, for
/// bodies of revolution, and for loads that follow their sides.
template <class T>
int unbalanced_body(const Model& model, const Slots<T>& slots, double time) {
  constexpr double rounding = 1e-9;  // of the least squares: a smaller share counts as balanced
  if (model.dimension != 2 || model.scene.space == Space::axisymmetric || !model.followers.empty()) return balanced;
  const RigidStatics all = rigid_statics(model, slots, time);
  if (!(unbalanced_share(all) > rounding)) return balanced;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const auto rows = static_cast<Eigen::Index>(3 * b);
    const RigidStatics one{all.pushes.middleRows(rows, 3), all.holds.middleRows(rows, 3), all.load.segment(rows, 3),
                           all.tangential, all.limit};
    if (unbalanced_share(one) > rounding) return static_cast<int>(b);
  }
  return a_group;
}

/// A contact point whose node contacts with obstacles leave no place: wherever it goes, it is inside of one. -1 if
/// there is none, or if this is not known: normals may turn, or 3D. `gap`: of the points, in some state. By Farkas'
/// lemma: no motion d has n_i . d >= -g_i for all i if factors y >= 0 balance the normals, sum y_i n_i = 0 but for what
/// a support takes, while sum y_i g_i < 0.
template <class T>
int contradicted_point(const Model& model, const Slots<T>& slots, const Vector<T>& gap) {
  constexpr double rounding = 1e-9;  // of the least squares
  if (model.dimension != 2) return -1;
  std::map<int, std::vector<int>> at;  // points by node
  for (int p = 0; p < static_cast<int>(gap.size()); ++p) {
    const auto& point = model.points[p];
    if (point.obstacle >= 0 && point.nodes.size() == 1 && keeps_its_normal(model, point))
      at[point.nodes[0]].push_back(p);
  }
  for (const auto& [node, points] : at) {
    if (points.size() < 2) continue;
    double largest = 0;
    for (const int p : points) largest = std::max(largest, std::abs(value(gap[p])));
    RigidStatics statics{
        Matrix<double>::Zero(3, points.size()), Matrix<double>::Zero(3, 2), Vector<double>::Unit(3, 2), {}, {}};
    for (std::size_t k = 0; k < points.size(); ++k)
      statics.pushes.col(k) << values(slots.geometry[points[k]].normal),
          (value(gap[points[k]]) + model.points[points[k]].tie_length) / largest;
    for (int d = 0; d < 2; ++d)
      if (model.free_index[2 * node + d] < 0)
        statics.holds.col(d).template head<2>() = direction_of(slots, model, 2 * node + d);
    if (largest > 0 && unbalanced_share(statics) < rounding) return points.front();
  }
  return -1;
}

/// Whether a point with friction bears a tangential traction however small its pressure, and none once it is open.
template <class T>
bool has_abrupt_friction(const Model& model, const Slots<T>& slots) {
  return std::any_of(model.points.begin(), model.points.end(), [&](const auto& point) {
    return point.tangents > 0 && !slots.friction[point.contact].has_apex();
  });
}

inline constexpr auto abrupt_friction_message =
    "friction that does not grow with the pressure ends at once where a point opens, and then there may be no "
    "equilibrium; try one that grows with it";

}  // namespace stickslip
