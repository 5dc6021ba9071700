/// A side of the plane that is in contact with itself: what a vertex of it may face.
#pragma once

#include "core/contact/surface.hpp"

namespace stickslip {

/// Two places of one side can touch only if the cosine of the angle between their outward normals is less than minus
/// this. So the angle exceeds 120 degrees, and the two sides of a corner never touch.
inline constexpr double least_against = 0.5;

/// Whether a place whose foot has the coordinate xi on a facet is beside it, up to half its length past an end. Farther
/// away a place is not inside of the facet.
inline bool is_beside_facet(double xi) {
  constexpr double past_end = 0.5;
  return xi >= -past_end && xi <= 1 + past_end;
}

/// A contact point that is a vertex of the curve that it faces: a side in contact with itself. It faces only patches
/// that come after it on the curve, so of two positions that touch exactly one is the slave. It never faces a patch
/// that it is a vertex of, nor a patch of its own wall.
struct OwnVertex {
  int vertex = no_vertex;
  double max_depth = 0;         ///< length: beyond this depth it is not inside of a patch
  std::vector<char> wall = {};  ///< per patch: whether it belongs to the wall of the vertex (own_vertex())

  /// Number of patches from the one that was faced last within which it may be inside by all of max_depth; elsewhere by
  /// a share of that.
  static constexpr int neighbourhood = 8;
  static constexpr double share_of_depth = 0.25;
  /// How deep inside of patch p it may be, length. `last`: the patch that was faced last, or no_patch.
  double depth_in(int p, int last) const {
    const int count = static_cast<int>(wall.size());
    bool is_near_last = false;
    for (const int turn : {-count, 0, count}) is_near_last |= std::abs(p - last - turn) <= neighbourhood;
    return (last != no_patch && is_near_last ? 1 : share_of_depth) * max_depth;
  }
  /// Whether the vertex may touch patch p, as slave or as a place of the master.
  bool may_touch(const Surface<2>& patches, int p) const {
    const auto& vertices = patches[p].vertices;
    return !wall[p] && std::find(vertices.begin(), vertices.end(), vertex) == vertices.end();
  }
  bool may_face(const Surface<2>& patches, int p) const {
    return patches[p].corner(0) > vertex && may_touch(patches, p);
  }
  bool may_face_some(const Surface<2>& patches) const {
    for (int p = 0; p < static_cast<int>(patches.size()); ++p)
      if (may_face(patches, p)) return true;
    return false;
  }
};

/// OwnVertex of a vertex of a side in contact with itself, from initial positions.
///
///   positions  of the vertices, 2 x vertices, length
///   outward    outward normal of the side at the vertex, any length
///   mesh_size  at the vertex, length
///
/// The thickness is the length of the ray from the vertex along -outward until it leaves the solid. max_depth is the
/// larger of thickness and mesh size. The wall consists of the patches on the opposite face of the same wall. A patch
/// belongs to it if the vertex is behind the patch, and the patch is nearer than 2 thickness plus its own length to the
/// vertex or to the end of the ray.
OwnVertex own_vertex(const Surface<2>& patches, const Places<2>& positions, int vertex, const Vec<double, 2>& outward,
                     double mesh_size);

}  // namespace stickslip
