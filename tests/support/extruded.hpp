/// A scene of plane strain drawn out along z by one layer, and held there along z: the same solution in space.
#pragma once

#include "core/model/scene.hpp"

namespace stickslip::scenes {

/// The scene in space. Moments and half widths, which are asked of the plane alone, are left out.
/// pre: plane strain, bodies of generated meshes and quadrilaterals, masters that are obstacles but no
/// polylines.
Scene extruded(Scene scene);

}  // namespace stickslip::scenes
