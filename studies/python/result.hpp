/// What a run leaves for Python: the result and, gathered once, all that an array looks into.
#pragma once

#include <string>
#include <vector>

#include "studies/run/run_files.hpp"
#include "studies/run/simulation.hpp"

namespace stickslip {

/// The points of one contact at the end of one step.
struct ContactTable {
  std::vector<int> nodes;            ///< slave node of each
  std::vector<unsigned char> state;  ///< 0 open, 1 stick, 2 slip
  Vector<double> pressure;           ///< positive in compression
  Vector<double> gap;                ///< negative: penetration
  Vector<double> area;               ///< tributary
  Matrix<double> traction;           ///< dimension x points: force per area on the slave
  Matrix<double> shear;              ///< tangents x points: its part along them; no rows where frictionless
  Matrix<double> slip;               ///< tangents x points, in this increment; no rows where frictionless
  Matrix<double> tangent;            ///< (tangents dimension) x points: unit vectors, one below the other
};

/// Nodes of the elements of one body, in the numbering of all nodes.
struct ElementTable {
  std::string body;
  int nodes_per_element = 0;
  std::vector<int> nodes;
};

/// One run, and the memory behind every array of it.
struct RunResult {
  Simulation simulation;
  CaseResult result;
  Vector<double> times;                       ///< of the steps
  Matrix<double> responses;                   ///< steps x responses; not a number of a step without a solution
  std::vector<Matrix<double>> sensitivities;  ///< per response: steps x parameters; not a number where none is known
  std::vector<std::vector<ContactTable>> contacts;  ///< per step and contact
  std::vector<ElementTable> elements;               ///< per body
};

/// Gathers the arrays of a result.
RunResult gather(Simulation simulation, CaseResult result);

}  // namespace stickslip
