/// What the faces of a slave side in space see of a master along their normals, for integrals over both
/// (core/README.md, Segment integration in space): polygons clipped in the plane across the normal of each face.
#pragma once

#include "studies/verify/faces.hpp"
#include "studies/verify/solids.hpp"

namespace stickslip::verify {

using Polygon = std::vector<Vec2>;

inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

inline double area_of(const Polygon& polygon) {
  double twice = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) twice += cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]);
  return twice / 2;
}

/// What of a polygon is on the left of the line from a to b.
inline Polygon left_of(const Polygon& polygon, const Vec2& a, const Vec2& b) {
  Polygon left;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
    const double at_p = cross(b - a, p - a), at_q = cross(b - a, q - a);
    if (at_p >= 0) left.push_back(p);
    if (at_p * at_q < 0) left.emplace_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return left;
}

/// A face that contact sees: itself, or a part of a face with middles, which gives places and weights.
struct PartFace {
  Nodes corners, whole;
  const char* kind_of_whole() const {
    switch (whole.size()) {
      case 3:
        return "T3";
      case 4:
        return "Q4";
      case 6:
        return "T6";
      case 8:
        return "Q8";
      default:
        return "Q9";
    }
  }
  /// Coordinates on the whole and their derivatives, of those (s, t) of the part.
  std::pair<Vec3, Mat3> on_whole(const Vec2& at) const {
    const Field& nodes = reference(kind_of_whole()).nodes;
    const Shape own = shape(corners.size() == 3 ? "T3" : "Q4", {at[0], at[1], 0});
    Field of(3, std::ssize(corners));
    for (std::size_t k = 0; k < corners.size(); ++k)
      of.col(static_cast<Eigen::Index>(k)) = nodes.col(std::ranges::find(whole, corners[k]) - whole.begin());
    return {of * own.value, of * own.gradient};
  }
  struct At {
    Vec3 y, across;  ///< across: y_s x y_t by the coordinates of the part
    Weights weights;
  };
  At at(const Field& x, const Vec2& st) const {
    const auto [place, slope] = on_whole(st);
    const Shape N = shape(kind_of_whole(), place);
    const Field of = x(Eigen::all, whole);
    const Mat3 y = of * N.gradient * slope;
    At out{of * N.value, y.col(0).cross(y.col(1)), {}};
    for (std::size_t a = 0; a < whole.size(); ++a) out.weights.emplace_back(whole[a], N.value[static_cast<int>(a)]);
    return out;
  }
};

/// The parts of the faces of a side, as cut_at_middles() has them.
inline std::vector<PartFace> parts_of(const Side& side) {
  std::vector<PartFace> parts;
  for (const auto& whole : side.edges)
    for (const auto& corners : cut_at_middles({side.nodes, {whole}}).edges) parts.push_back({corners, whole});
  return parts;
}

/// A place of a face of the slave, and what it faces.
struct Sample {
  const PartFace* slave;
  Vec2 at;  ///< on the part
  PartFace::At x, y;
  Vec3 normal;  ///< of the master
  double area;
};

/// The places of Gauss over all that parts of a slave side face of parts of a master, each seen along the normal of the
/// slave's; of two behind one another the nearer.
class Overlaps {
 public:
  std::vector<Sample> samples;

  /// `X`, `Y`: nodes of the slave and of the master.
  Overlaps(const Field& X, const Field& Y, const std::vector<PartFace>& slave, const std::vector<PartFace>& master) {
    for (const auto& part : slave) look_from(X, Y, part, master);
  }
  /// Over the whole side, against an obstacle without faces. `foot`: of a place.
  template <class FootOf>
  Overlaps(const Field& X, const std::vector<PartFace>& slave, const FootOf& foot) {
    for (const auto& part : slave) {
      sample(X, {}, part, View(X, part.corners), {0, nullptr, View(X, part.corners).seen(X, part.corners)});
    }
    for (auto& found : samples) {
      const Foot at = foot(found.x.y);
      found.y.y = at.y;
      found.normal = at.normal;
    }
  }

 private:
  struct Piece {
    double depth;  ///< behind the master
    const PartFace* master;
    Polygon polygon;
  };

  /// The plane across the normal of a face.
  struct View {
    Vec3 origin, normal, along, across;
    View(const Field& X, const Nodes& corners)
        : origin(X.col(corners[0])), normal(area_vector(X, corners).normalized()) {
      const Vec3 edge = X.col(corners[1]) - origin;
      along = (edge - edge.dot(normal) * normal).normalized();
      across = normal.cross(along);
    }
    Polygon seen(const Field& x, const Nodes& nodes) const {
      Polygon polygon;
      for (const int node : nodes)
        polygon.emplace_back((x.col(node) - origin).dot(along), (x.col(node) - origin).dot(across));
      return polygon;
    }
  };

  static Vec2 mean_of(const Polygon& polygon) {
    Vec2 mean = Vec2::Zero();
    for (const auto& p : polygon) mean += p / static_cast<double>(polygon.size());
    return mean;
  }

  /// Coordinates (s, t) at which a flat part has the place p of the plane.
  static Vec2 met(const Polygon& corners, const Vec2& p) {
    Vec2 at = corners.size() == 3 ? Vec2(1.0 / 3, 1.0 / 3) : Vec2(0.5, 0.5);
    for (int k = 0; k < 40; ++k) {
      const Shape N = shape(corners.size() == 3 ? "T3" : "Q4", {at[0], at[1], 0});
      Vec2 rest = p;
      Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();
      for (int c = 0; c < std::ssize(corners); ++c) {
        rest -= N.value[c] * corners[c];
        slope += corners[c] * N.gradient.row(c).head<2>();
      }
      const Vec2 step = slope.inverse() * rest;
      at += step;
      if (step.norm() < 1e-15) break;
    }
    return at;
  }

  /// Polygons without what another one covers.
  template <class IsNothing>
  static std::vector<Polygon> without(const std::vector<Polygon>& polygons, const Polygon& cover,
                                      const IsNothing& is_nothing) {
    std::vector<Polygon> beside;
    const auto from = [&](std::size_t k) -> const Vec2& { return cover[k % cover.size()]; };
    for (Polygon rest : polygons) {
      Polygon common = rest;
      for (std::size_t k = 0; k < cover.size(); ++k) common = left_of(common, from(k), from(k + 1));
      if (is_nothing(common)) {
        beside.push_back(rest);
        continue;
      }
      for (std::size_t k = 0; k < cover.size(); ++k) {
        beside.push_back(left_of(rest, from(k + 1), from(k)));
        rest = left_of(rest, from(k), from(k + 1));
      }
    }
    std::erase_if(beside, is_nothing);
    return beside;
  }

  void look_from(const Field& X, const Field& Y, const PartFace& from, const std::vector<PartFace>& master) {
    const View view(X, from.corners);
    const Vec3 outward = area_vector(X, from.corners);
    const Polygon own = view.seen(X, from.corners);
    const auto is_nothing = [&](const Polygon& p) { return p.size() < 3 || area_of(p) <= 1e-12 * outward.norm(); };
    std::vector<Piece> pieces, alike;  // alike: that look its way
    for (const auto& face : master) {
      const Vec3 out = area_vector(Y, face.corners);
      const bool is_opposite = opposes(out, outward);
      if (!is_opposite && out.dot(view.normal) <= at_end * out.norm()) continue;
      Polygon other = view.seen(Y, face.corners), part = own;
      if (is_opposite) std::ranges::reverse(other);  // it goes round the other way
      for (std::size_t k = 0; k < other.size(); ++k) part = left_of(part, other[k], other[(k + 1) % other.size()]);
      if (is_nothing(part)) continue;
      const Vec2 mean = mean_of(part);
      const Vec3 place = view.origin + mean[0] * view.along + mean[1] * view.across;
      const double depth = (place - Y.col(face.corners[0])).dot(out) / view.normal.dot(out);
      (is_opposite ? pieces : alike).push_back({depth, &face, part});
    }
    std::ranges::stable_sort(pieces, {}, [](const Piece& piece) { return std::abs(piece.depth); });
    std::vector<Piece> kept;
    for (const auto& piece : pieces) {
      std::vector<Polygon> left{piece.polygon};
      for (const auto& nearer : kept) left = without(left, nearer.polygon, is_nothing);
      for (const auto& polygon : left) kept.push_back({piece.depth, piece.master, polygon});
    }
    for (const auto& piece : kept) {  // beyond another face of the solid it is inside of none
      std::vector<Polygon> left{piece.polygon};
      for (const auto& face : alike)
        if (face.depth > 0 && face.depth < piece.depth) left = without(left, face.polygon, is_nothing);
      for (const auto& polygon : left) sample(X, Y, from, view, {piece.depth, piece.master, polygon});
    }
  }

  /// Triangles from the mean of the corners, each with points of Gauss that collapse to it: four each way, two if both
  /// faces are triangles without middles.
  void sample(const Field& X, const Field& Y, const PartFace& from, const View& view, const Piece& piece) {
    static const double root = std::sqrt(4.8) / 7, outer = std::sqrt(3.0 / 7 + root);
    static const double third = 1 / std::sqrt(3.0), inner = std::sqrt(3.0 / 7 - root);
    static const double light = 0.5 - std::sqrt(30.0) / 36, heavy = 1 - light;
    static const std::vector<std::pair<double, double>> two{{-third, 1}, {third, 1}},
        four{{-outer, light}, {-inner, heavy}, {inner, heavy}, {outer, light}};
    const bool is_linear = from.whole.size() == 3 && (!piece.master || piece.master->whole.size() == 3);
    const auto& rule = is_linear ? two : four;
    const Polygon own = view.seen(X, from.corners);
    const Vec2 mean = mean_of(piece.polygon);
    for (std::size_t k = 0; k < piece.polygon.size(); ++k) {
      const Vec2 a = piece.polygon[k] - mean, b = piece.polygon[(k + 1) % piece.polygon.size()] - mean;
      for (const auto& [u, weight_u] : rule)
        for (const auto& [v, weight_v] : rule) {
          const double out = (1 + u) / 2, along = (1 + v) / 2;
          const Vec2 p = mean + out * ((1 - along) * a + along * b), at = met(own, p);
          Sample found{&from, at, from.at(X, at), {}, {}, 0};
          const Shape flat = shape(own.size() == 3 ? "T3" : "Q4", {at[0], at[1], 0});
          Eigen::Matrix2d slope = Eigen::Matrix2d::Zero();
          for (int c = 0; c < std::ssize(own); ++c) slope += own[c] * flat.gradient.row(c).head<2>();
          found.area = cross(a, b) * out * weight_u * weight_v / 4 * found.x.across.norm() / slope.determinant();
          if (piece.master) {
            found.y = piece.master->at(Y, met(view.seen(Y, piece.master->corners), p));
            found.normal = found.y.across.normalized();
            const double against = -found.normal.dot(found.x.across.normalized());
            const double share = std::clamp(against / least_opposed - 1, 0.0, 1.0);
            found.area *= share * share * (3 - 2 * share);
          }
          samples.push_back(found);
        }
    }
  }
};

}  // namespace stickslip::verify
