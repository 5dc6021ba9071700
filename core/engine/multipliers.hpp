/// What a system that is solved does with multipliers.
#pragma once

namespace stickslip {

/// Whether lambda is given or an unknown: then systems have the layout [displacements; multipliers].
enum class Multipliers { given, unknown };

}  // namespace stickslip
