/// Search for what a point faces of a surface in space. The faces may come in any order.
#pragma once

#include <functional>
#include <vector>

#include "core/contact/box_tree.hpp"
#include "core/contact/face.hpp"
#include "core/mesh/mesh.hpp"

namespace stickslip {

/// The faces of one side at given nodal positions.
class FaceSearch {
 public:
  /// `points`: nodal positions, 3 x nodes; `faces`: three or four nodes each, counter-clockwise seen from outside.
  FaceSearch(Points<double> points, const std::vector<std::vector<int>>& faces);
  /// `faces`: their nodes and corners; `border`: per face and edge, whether no other face has it.
  FaceSearch(Points<double> points, std::vector<FacePlace> faces, std::vector<std::array<char, 4>> border);

  struct Near : NearestPlace {
    int face;
  };
  /// Normals that make an angle with `outward` whose cosine is less than -`least`; all, if `outward` is zero.
  struct Opposing {
    Vec<double, 3> outward = Vec<double, 3>::Zero();
    double least = 0;
  };
  /// The closest places to x, which are as near as one another: on one face, or on several at an edge or a corner.
  /// `counts(face)`: whether the face is looked at; `opposing`: what holds for the normals of all that count.
  std::vector<Near> nearest(const Vec<double, 3>& x, const std::function<bool(int)>& counts,
                            const Opposing& opposing) const;
  std::vector<Near> nearest(const Vec<double, 3>& x, const std::function<bool(int)>& counts) const {
    return nearest(x, counts, {});
  }
  /// How far it is from x along `way`, a unit vector, to the first face that counts, length; infinite if none is there.
  /// A quadrilateral is taken for two triangles.
  double first_hit(const Vec<double, 3>& x, const Vec<double, 3>& way, const std::function<bool(int)>& counts) const;

  /// The closest place of the surface to x, on each face that has it and opposes `outward`, if that is not zero; none
  /// if x projects past a border of the surface, or past an edge beyond which it does not oppose. Of places that are
  /// equally close it is one inside of a face, then that of least x, y, z: geometry alone decides.
  std::vector<FacePlace> closest(const Vec<double, 3>& x, const Vec<double, 3>& outward) const;

  Vec<double, 3> position(int node) const { return points_.col(node); }
  Vec<double, 3> across(int face) const;  ///< area vector of a face
  double size() const;                    ///< diagonal of the box of all faces, length; infinite if there is none
  bool has(int face, int node) const { return faces_[face].has(node); }

 private:
  /// Whether x projects past an edge at which `places` are, and which a border or one of `ends` is beyond.
  bool is_past_border(const std::vector<Near>& places, const std::vector<Near>& ends, const Vec<double, 3>& x) const;
  std::array<Vec<double, 3>, 4> corners(const FacePlace& face) const;

  Points<double> points_;
  std::vector<FacePlace> faces_;
  std::vector<std::array<char, 4>> border_;  ///< per face and edge: whether no other face has it
  BoxTree<3> boxes_;
  double band_ = 0;  ///< length above the rounding of a distance
};

}  // namespace stickslip
