/// The .vtu and .pvd of a case that ParaView reads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// What the names of the files of fields are.
inline constexpr const char* field_names[] = {"fields.pvd", "fields_#.vtu", "obstacles_#.vtu"};

/// A time whose fields are kept.
struct Moment {
  std::size_t number;  ///< of the step, from 1 on; 0: the start
  double time;
  const State<double>& state;
};

/// Every `every`-th solved step and the last of them, and the start before them; 0: the last step alone.
std::vector<Moment> kept_moments(const CaseResult& result, int every);

/// Gives name and content of fields_NNNN.vtu for every `every`-th step and the last one (0: the last alone), and of
/// fields.pvd. Of several steps there is the start too, as fields_0000.vtu, and in the plane the obstacles of each as
/// obstacles_NNNN.vtu, a block of their own with the same displacement field.
/// Point fields: displacement, contact_state (-1: no contact point, 0 open, 1 stick, 2 slip), contact_pressure,
/// contact_traction (force per area on the slave), gap (no number where a node is no slave, or faces nothing),
/// contact_force (nodal forces of all contacts on both sides); at the last step d_displacement_d_NAME per parameter.
/// Cell fields: body, and for continua stress (xx yy zz xy yz xz) and von_mises; where a body flows plastic_strain, the
/// mean equivalent one of the element. A node that is a slave in several contacts has the state that holds most (stick,
/// then slip, then open), the sum of the pressures and of the tractions, and the smallest gap; the four fields of each
/// contact NAME alone then follow, contact_state_NAME and so on.
void for_each_field(const CaseResult& result, int every, const std::function<void(std::string, std::string)>& take);

/// Names of the files that write_fields() of studies/run/run_files.hpp writes, in order.
std::vector<std::string> field_files(const CaseResult& result, int every);

/// Whether some node is a slave in more than one contact.
bool contacts_share_nodes(const Model& model);

/// Force per area on the slave at contact point p.
Vector<double> traction_vector(const Problem& problem, const State<double>& state, int p);

}  // namespace stickslip
