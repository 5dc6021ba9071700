/// Fields of a state over nodes and elements, for pictures.
#pragma once

#include <vector>

#include "studies/run/case.hpp"

namespace stickslip {

/// Numbers of dofs as columns, one a node.
Matrix<double> nodal(const Model& model, const Eigen::Ref<const Vector<double>>& dofs);

/// Mean stress of each element, xx yy zz xy yz xz; zero for lumped elements. Plane strain: zz = nu (xx + yy);
/// axisymmetric: zz is the hoop stress.
Matrix<double> element_stress(const Problem& problem, const State<double>& state);

/// Von Mises stress of xx yy zz xy yz xz.
double von_mises(const Eigen::Ref<const Eigen::Matrix<double, 6, 1>>& stress);

/// Whether bodies change their thickness.
bool thins(const Model& model);

/// Mean stretch of the thickness of each element, one row.
Matrix<double> element_thickness(const Problem& problem, const State<double>& state);

/// Mean equivalent plastic strain of each element of a body; 0 where it does not flow.
std::vector<double> mean_plastic_strains(const Problem& problem, const State<double>& state, int body);

/// The same of all bodies, one row.
Matrix<double> element_plastic_strain(const Problem& problem, const State<double>& state);

}  // namespace stickslip
