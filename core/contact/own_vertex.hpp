/// A side that is in contact with itself: what a vertex of it may face.
#pragma once

#include "core/contact/face_search.hpp"
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

/// A contact point that is a vertex of the surface that it faces: a side in contact with itself. It faces only places
/// that come after it, so of two places that touch exactly one is the slave. It never faces a patch that it is a vertex
/// of, nor a patch of its own wall.
///
/// Vertices are numbered in the order in which they come. In the plane this is that of the curve, and a patch comes
/// after the vertices before its start. In space it is that of order_in_space(), and a place comes where the mean of
/// the numbers at its corners is, by its weights on the face.
struct OwnVertex {
  int vertex = no_vertex;
  double max_depth = 0;         ///< length: beyond this depth it is not inside of a patch
  std::vector<char> wall = {};  ///< in the plane, per patch: whether it belongs to the wall of the vertex
  double reach = 0;             ///< in space: how far patches of its wall are from it, less their sizes, length

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

/// The middle of the face of a patch in space.
struct FaceMiddle {
  int corners;
  Vec<double, 3> place, along_s, along_t;  ///< the mean of the corners; the slopes y_s, y_t of the face there
  double reach = 0;                        ///< distance of the corner that is farthest from it, length
  /// Whether x projects to the face, as it is in its middle, or past an edge by no more than half its width.
  bool is_beside(const Vec<double, 3>& x) const;
};
FaceMiddle face_middle(const Patch<3>& patch, const Places<3>& positions);

/// The same in space. `faces`: those of the side, by its vertices. There a patch belongs to the wall if the vertex is
/// behind it, and no farther from its middle than 3 thickness plus twice the reach of its corners (is_of_own_wall()).
OwnVertex own_vertex(const FaceSearch& faces, int vertex, const Vec<double, 3>& outward, double mesh_size);

/// Whether a patch belongs to the wall of a vertex in space. `start`: initial positions of the vertices of the side.
bool is_of_own_wall(const OwnVertex& own, const Patch<3>& patch, const Places<3>& start);

/// The vertices of a side in space that is in contact with itself, in the order in which they come: along a direction
/// in which places that may touch are apart, so that of two walls that meet all of one comes before the other.
///
/// The direction is that of the ways across the voids of the solid: of the rays from the vertices along their normals
/// that end at another place of the side, each by its area over the square of its length. If there is no void, it is
/// that in which the side is longest. If several directions are equal, as in a round tube, it is one that is along no
/// axis. It points to where the side has its longer tail.
///
///   facets     three or four vertices each, counter-clockwise seen from outside
///   positions  of the start, 3 x vertices, length
std::vector<int> order_in_space(const std::vector<std::vector<int>>& facets, const Places<3>& positions);

}  // namespace stickslip
