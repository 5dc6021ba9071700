/// Contacts whose forces equilibrium does not determine, because closed constraints repeat one another
/// (sensitivity/redundancy.hpp).
#pragma once

#include <vector>

#include "core/model/contact_assembly.hpp"

namespace stickslip {

/// Per point: stiffness of its slave node, in contacts where more slave nodes face the master at the start than nodes
/// of it, so that the slave alone resists some shifts of pressure between them; 0 in others. Empty if there is no such
/// contact.
std::vector<double> slave_shares(const Model& model, const Slots<double>& slots);

/// Forces that a state does not determine.
struct UndeterminedForces {
  std::vector<char> contacts;  ///< per contact, whether it has some; empty if none has
  /// Changes of the tractions that change no balance: one a column, laid out as ContactField::traction, force per area;
  /// the largest entry of each is the largest pressure. They span all such changes.
  Matrix<double> changes;
};

/// Finds contacts whose forces a state does not determine: their constraints repeat one another, so that other forces,
/// between which the conditions of contact do not decide, balance the same loads. Two examples: a node in two contacts
/// that sticks in one of them; three nodes of a body that hardly yields on one facet of a soft one.
class ForceSearch {
 public:
  ForceSearch(const Model& model, const Slots<double>& slots);
  /// Whether constraints of the model can repeat one another at all. Otherwise no state is searched.
  bool is_called_for() const { return !suspects_.empty(); }
  /// The forces that are undetermined. `compliance`: per point, length^3 / force, of the tangential springs of a
  /// penalty; empty if constraints are exact. pre: is_called_for()
  UndeterminedForces undetermined(const State<double>& state, const std::vector<double>& compliance) const;

 private:
  const Model& model_;
  const Slots<double>& slots_;
  std::vector<char> stiff_;    ///< per node: as good as held; empty if there is none
  std::vector<int> suspects_;  ///< points whose own slave node does not keep their constraints apart from others
};

}  // namespace stickslip
