/// One measure of error for every method, computed from states alone by code that does not know which method ran.
///
/// With l the largest relative displacement or A|t|/k of the run so far, p the largest traction, f the largest nodal
/// force (KktScales):
///   equilibrium      largest nodal imbalance at free nodes / f
///   gap              largest penetration / l
///   complementarity  largest |min(g_N k / A, -t_N)| / p
///   cone             largest (|t_T| + mu t_N)^+ / p
///   stick            largest slip, summed over increments, of a point that stayed inside its cone, / l: what a
///                    regularisation lets creep
///   slip_direction   largest 1 - cos(slip, t_T) among points on the cone that slip
/// All are 0 for an exact solution of the discrete problem. Dimensionless, hence the same in any units.
#pragma once

#include <functional>
#include <vector>

#include "methods/method.hpp"

namespace stickslip {

struct KktError {
  double equilibrium = 0, gap = 0, complementarity = 0, cone = 0, stick = 0, slip_direction = 0;
  double largest() const;
};

/// What the errors are relative to, at an increment: the largest of the run so far, but no less than 1e-9 of what the
/// largest displacement makes of lengths, tractions (k / A) and, where no load tells their size, forces, of which
/// rounding leaves little.
struct KktScales {
  double length = 0, traction = 0, force = 0;
  double least_traction = 0;  ///< that share
  double reach = 0;           ///< largest displacement
  double stiffness = 0;       ///< largest of an element against the displacement of a node
};

/// What one contact point misses of Signorini's and Coulomb's laws.
struct PointDefects {
  double penetration = 0;      ///< length
  double complementarity = 0;  ///< traction
  double cone = 0;             ///< traction beyond the bound
  double creep = 0;            ///< length: slip summed since the point came inside its cone
  double pull = 0;             ///< traction: |t_T| of a point on its cone that slips
  double turn = 0;             ///< 1 - cos(slip, t_T) of such a point
  double astray = 0;           ///< length: the part of that slip that is not along t_T
};

/// Of one increment. `imbalance`: largest nodal force at free nodes that nothing balances, at `node`.
struct KktDefects {
  KktScales scales;
  double imbalance = 0;
  int node = 0;
  std::vector<PointDefects> points;
};

/// An elastic layer at each contact point (length^3 / force), which penetrates and slips by compliance times traction:
/// the errors are then against contact with that layer. Empty: none. `band`: share of the largest traction within which
/// a point counts as on its cone.
struct ElasticLayer {
  std::vector<double> normal, tangential;
  double band = 0;
};

/// Measures the increments of a run one after the other; the scales grow on the way, and the creep is summed.
class DefectReader {
 public:
  DefectReader(const Model& model, const Slots<double>& slots);
  /// pre: the state before is that of the increment that was read last, or the initial one; only contact is read of it.
  /// `layer`: none where that is nullptr.
  void read(const State<double>& before, const Increment<double>& increment, const ElasticLayer* layer);
  const KktDefects& defects() const { return plain_; }                         ///< of the states as they are
  const std::vector<PointDefects>& with_layer() const { return with_layer_; }  ///< against contact with the layer

 private:
  using Creep = std::vector<Eigen::VectorXd>;  ///< slip of the points since they came inside their cones
  const Model& model_;
  const Slots<double>& slots_;
  KktDefects plain_;
  std::vector<PointDefects> with_layer_;
  Creep creep_, creep_with_layer_;
};

/// Calls f(n, of the states as they are, against contact with the layer) for the increments in order.
void visit_defects(
    const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
    const std::function<ElasticLayer(const Increment<double>&)>& layer,
    const std::function<void(std::size_t, const KktDefects&, const std::vector<PointDefects>& with_layer)>& f);

/// The largest of each kind, relative to its scale.
KktError relative(const KktDefects& defects);

struct ContactSummary {
  int open = 0, stick = 0, slip = 0;
  double penetration = 0;                ///< largest, length
  double normal_force = 0;               ///< sum, positive in compression
  std::vector<double> tangential_force;  ///< on the slave, by axis
  bool is_finite() const;
  ContactSummary& operator+=(const ContactSummary& other);
};

/// Measures of the increments of a trajectory, in order (the creep of sticking points is summed along the way).
std::vector<KktError> kkt_errors(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory);
std::vector<ContactSummary> summarise(const Model& model, const Slots<double>& slots, const State<double>& state);

}  // namespace stickslip
