/// Errors of a solution against the contact conditions. The same measure serves every method: it is computed from
/// states alone.
///
/// l: largest relative displacement or A|t|/k of the run so far; p: largest traction; f: largest nodal force
/// (KktScales).
///
///   equilibrium      largest nodal imbalance at free nodes / f
///   gap              largest penetration / l
///   complementarity  largest |min(g_N k / A, -t_N)| / p
///   cone             largest (|t_T| + mu t_N)^+ / p
///   stick            largest slip, summed over increments, of a point that stayed inside its cone, / l. A
///                    regularisation allows such creep
///   slip_direction   largest 1 - cos(slip, t_T) among slipping points on the cone
///
/// All are dimensionless, and 0 for an exact solution of the discrete problem.
#pragma once

#include <functional>
#include <vector>

#include "methods/method.hpp"

namespace stickslip {

struct KktError {
  double equilibrium = 0, gap = 0, complementarity = 0, cone = 0, stick = 0, slip_direction = 0;
  double largest() const;
};

/// Scales of the errors at an increment: the largest values of the run so far, but at least 1e-9 of what the largest
/// displacement makes of lengths, and of what it and the largest relative displacement (an obstacle's too) make of
/// tractions (k / A), and of forces if no load gives their size. Smaller values are mostly rounding.
struct KktScales {
  double length = 0, traction = 0, force = 0;
  double least_traction = 0;  ///< that least scale of the tractions
  double reach = 0;           ///< largest displacement
  double stiffness = 0;       ///< largest stiffness of an element at one node, force per length
};

/// Violations of Signorini's and Coulomb's laws at one contact point.
struct PointDefects {
  double penetration = 0;      ///< length
  double complementarity = 0;  ///< traction
  double cone = 0;             ///< traction beyond the bound
  double creep = 0;            ///< length: slip summed since the point is inside its cone
  double pull = 0;             ///< traction: |t_T| of a slipping point on its cone
  double turn = 0;             ///< 1 - cos(slip, t_T) of this point
  double astray = 0;           ///< length: part of its slip perpendicular to t_T
};

/// Violations of one increment. `imbalance`: largest unbalanced nodal force at free nodes, at `node`.
struct KktDefects {
  KktScales scales;
  double imbalance = 0;
  int node = 0;
  std::vector<PointDefects> points;
};

/// Elastic layer at each contact point (length^3 / force). It penetrates and slips by compliance times traction, and
/// errors are then those against contact with the layer. Empty: no layer. `band`: share of the largest traction within
/// which a point counts as on its cone.
struct ElasticLayer {
  std::vector<double> normal, tangential;
  double band = 0;
};

/// Violations of the increments of a run, read one after the other. Scales grow and creep is summed along the run.
class DefectReader {
 public:
  DefectReader(const Model& model, const Slots<double>& slots);
  /// Reads the next increment. pre: `before` is the state of the increment read last, or the initial one; only its
  /// contact is read. `layer`: nullptr: none.
  void read(const State<double>& before, const Increment<double>& increment, const ElasticLayer* layer);
  const KktDefects& defects() const { return plain_; }                         ///< against exact contact
  const std::vector<PointDefects>& with_layer() const { return with_layer_; }  ///< against contact with the layer

 private:
  using Creep = std::vector<Eigen::VectorXd>;  ///< per point: slip since it is inside its cone
  const Model& model_;
  const Slots<double>& slots_;
  KktDefects plain_;
  std::vector<PointDefects> with_layer_;
  Creep creep_, creep_with_layer_;
};

/// Calls f(n, against exact contact, against contact with the layer) for the increments in order.
void visit_defects(
    const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory,
    const std::function<ElasticLayer(const Increment<double>&)>& layer,
    const std::function<void(std::size_t, const KktDefects&, const std::vector<PointDefects>& with_layer)>& f);

/// The largest violation of each kind, over its scale.
KktError relative(const KktDefects& defects);

struct ContactSummary {
  int open = 0, stick = 0, slip = 0;
  double penetration = 0;                ///< largest, length
  double normal_force = 0;               ///< sum, positive in compression
  std::vector<double> tangential_force;  ///< on the slave, by axis
  bool is_finite() const;
  ContactSummary& operator+=(const ContactSummary& other);
};

/// Errors of the increments of a trajectory, in order.
std::vector<KktError> kkt_errors(const Model& model, const Slots<double>& slots, const Trajectory<double>& trajectory);
std::vector<ContactSummary> summarise(const Model& model, const Slots<double>& slots, const State<double>& state);

}  // namespace stickslip
