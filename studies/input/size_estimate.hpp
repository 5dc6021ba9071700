/// Memory that a run needs, estimated before any of it is allocated.
#pragma once

#include <string>

#include "core/mesh/generators.hpp"

namespace stickslip {

/// What is reduced to the contact dofs: nothing; bodies, once; or the tangent of each iteration.
enum class Reduced { nothing, bodies, tangents };

/// What decides how much a run needs.
struct ProblemSize {
  double displacements = 0;
  double contact_dofs = 0;  ///< displacements of the nodes of sides in contact
  double contact_points = 0;
  double steps = 0;
  Reduced reduced = Reduced::nothing;
  double thin_steps = 0;     ///< of these, whose displacements are let go
  bool in_space = false;     ///< of solid bodies
  bool unsymmetric = false;  ///< the tangent
  bool slides = false;       ///< contact in present geometry
};

/// Nodes of a mesh that a generator makes, within a few per cent; of an imported one those it has.
double estimated_nodes(const MeshDescription& mesh, const std::string& element);

/// Bytes of a run, within a factor of two: it separates a megabyte from a terabyte.
double estimated_bytes(const ProblemSize& size);

/// Bytes that this process may have: the machine's memory, or less where a limit of the process or of its control group
/// says so. Linux; elsewhere infinite.
double memory_limit();

/// "some 45 GB of memory".
std::string about(double bytes);

/// "some 45 GB of memory, and there are 16 GB for this process".
std::string too_much(double bytes, double limit);

}  // namespace stickslip
