/// Which pressure the radius of the friction cone follows.
#pragma once

namespace stickslip {

/// Where the radius of the friction cone comes from: the projected normal traction or the multiplier itself.
enum class ConeRadius { augmented, multiplier };

}  // namespace stickslip
