/// The surface of a master in space: a patch for each face, triangles and quadrilaterals mixed, of any valence.
///
///   y(s, t) = sum_c B_c(s, t) sum_i W_ci x_i,    c: p, e+, e-, f+, f- of each corner (Gregory patches)
///
/// W depends on what neighbours what alone. Across a crease nothing does; where all edges are creases, patches are the
/// flat triangles and bilinear quadrilaterals.
///
///   edges cubic:  p, e = p + cos(k theta) t1 + sin(k theta) t2 of spoke k,  theta = 2 pi / K, pi / K of a border,
///                 pi / 2K of a corner, K the faces at the node
///   inside:       D f = c' p + (D - 2c - c') e + 2c e' + r,  D = 3, of triangles 4;  c = cos theta, ' of the edge's
///                 other end, r half of the cross derivative: both sides of an edge have it with opposite signs (G1)
///   beyond:       straight along -t2 of a node of a border, along -(t1 + t2) of a corner of several faces; of a corner
///                 of one face along its two edges; between the ends of an edge the shares of this way are linear
///
/// Masks p, t1, t2: Catmull-Rom's, or limits of Catmull and Clark's B-splines by Halstead, Kass and DeRose; r: Loop,
/// Schaefer, Ni, Castano, Approximating subdivision surfaces with Gregory patches (2009).
#pragma once

#include <complex>

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

/// A patch goes once around its corners, counter-clockwise from outside. Triangles 0 <= s, t, s + t <= 1.
struct FacePatch {
  Nodes face, nodes;      ///< corners; those that the patch is made of
  Eigen::MatrixXd weigh;  ///< W by node and c
  static constexpr int none = -1, smooth = -2;
  std::vector<int> beyond;  ///< per edge: the face behind a crease; none: a border; smooth: the surface goes on
  /// Per edge, at both ends: how the patch goes on beyond it, as shares of its derivatives along the edge and across.
  std::vector<std::array<Vec2, 2>> ways = {};
  int sides() const { return static_cast<int>(face.size()); }
};

/// How far (s, t) is from the edges 0, 1, ..., of which the first goes from corner 0, (0, 0), along s.
template <class Number>
Eigen::VectorX<Number> from_edges(int sides, Number s, Number t) {
  if (sides == 3) return Eigen::Vector3<Number>(t, 1.0 - s - t, s);
  return Eigen::Vector4<Number>(t, 1.0 - s, 1.0 - t, s);
}

/// A corner or an edge in (s, t).
inline Vec2 corner_at(int sides, int j) {
  return std::array{Vec2(0, 0), Vec2(1, 0), sides == 3 ? Vec2(0, 1) : Vec2(1, 1), Vec2(0, 1)}[j % sides];
}
inline Vec2 edge_along(int sides, int j) { return corner_at(sides, j + 1) - corner_at(sides, j); }

using Complex = std::complex<double>;

/// p^2 q / (p + q), how f+ of a corner is blended with f-, and its slopes by p and q. p, q >= 0.
inline std::array<Complex, 3> blend_at_corner(Complex p, Complex q) {
  const Complex sum = p + q, a = sum == 0.0 ? 0.5 : p / sum;
  return {p * q * a, q * a * (2.0 - a), p * a * a};
}

/// B_c and their slopes by s and t, of a place of the patch that is so far from its edges, none below 0. Of a triangle
/// quartic in the middle.
inline Eigen::MatrixX3cd blend_inside(const Eigen::VectorXcd& off) {
  const int sides = static_cast<int>(off.size());
  Eigen::MatrixX3cd B(5 * sides, 3);
  for (int j = 0; j < sides; ++j) {
    // u: from the corner along its edge; v: along that before. Both run straight, so their slopes are differences.
    const int of_u = (j + sides - 1) % sides;
    const auto u = off[of_u], v = off[j];
    const auto slope = [&](int edge, const Vec2& along) {
      return (from_edges(sides, along[0], along[1]) - from_edges(sides, 0.0, 0.0))[edge];
    };
    const auto P = sides == 3 ? 1.0 - u - v : (1.0 - u) * (1.0 - v);
    const auto P_u = sides == 3 ? -1.0 : v - 1.0, P_v = sides == 3 ? -1.0 : u - 1.0;
    const double n = sides == 3 ? 12.0 : 9.0;
    const auto [f, f_u, f_v] = blend_at_corner(u, v);
    const auto [g, g_v, g_u] = blend_at_corner(v, u);
    Eigen::Matrix<Complex, 5, 3> in;                        // the functions, and their slopes by u and v
    in << P * P * P, 3.0 * P * P * P_u, 3.0 * P * P * P_v,  //
        3.0 * u * (1.0 - v) * P * P, 3.0 * (1.0 - v) * P * (P + 2.0 * u * P_u),
        3.0 * u * P * (2.0 * (1.0 - v) * P_v - P),  //
        3.0 * v * (1.0 - u) * P * P, 3.0 * v * P * (2.0 * (1.0 - u) * P_u - P),
        3.0 * (1.0 - u) * P * (P + 2.0 * v * P_v),                                            //
        n * P * P * f, n * P * (P * f_u + 2.0 * P_u * f), n * P * (P * f_v + 2.0 * P_v * f),  //
        n * P * P * g, n * P * (P * g_u + 2.0 * P_u * g), n * P * (P * g_v + 2.0 * P_v * g);
    const auto rows = Eigen::seqN(j, 5, sides);
    B(rows, 0) = in.col(0);
    for (int i = 0; i < 2; ++i) {
      const Vec2 along = Vec2::Unit(i);
      B(rows, 1 + i) = in.col(1) * slope(of_u, along) + in.col(2) * slope(j, along);
    }
  }
  return B;
}

/// B_c. Beyond its edges a patch goes on straight from the nearest place of a quadrilateral in (s, t). In a triangle it
/// does so from the place on the line to the corner across from the edge, or from the corner if it is beyond two.
inline Eigen::VectorXcd blend(const FacePatch& patch, Complex s, Complex t) {
  const int sides = patch.sides();
  const Eigen::VectorXcd whole = from_edges(sides, s, t);
  Eigen::VectorXcd off = whole;  // (not anew from where it begins: a rounding has either sign)
  for (auto& from : off)
    if (from.real() < 0) from = 0;
  if (sides == 3)
    off /= off.sum();
  else
    for (int j = 0; j < 4; ++j)
      if (off[(j + 2) % 4] == 0.0) off[j] = 1;
  Eigen::Vector2cd go(s - off[sides - 1], t - off[0]);
  for (int j = 0; j < sides; ++j) {
    if (whole[j].real() >= 0 || patch.beyond[j] == FacePatch::smooth) continue;
    const Vec2 along = edge_along(sides, j), back = edge_along(sides, j + sides - 1), on = edge_along(sides, j + 1);
    // Shares of both ends; of a triangle beside the edge its inside is towards the third corner.
    const Complex end = off[(j + sides - 1) % sides], start = 1.0 - end;
    const Eigen::Vector2cd inside = -back * start + on * end;
    const Complex by_along = patch.ways[j][0][0] * start + patch.ways[j][1][0] * end,
                  by_inside = patch.ways[j][0][1] * start + patch.ways[j][1][1] * end;
    go += whole[j] * (along * by_along + inside * (by_inside - 1.0));
  }
  const Eigen::MatrixX3cd B = blend_inside(off);
  return B.col(0) + go[0] * B.col(1) + go[1] * B.col(2);
}

/// B_c and their derivatives by s and t: by steps along the imaginary axis, of which the square is nothing.
inline Eigen::MatrixX3d blend(const FacePatch& patch, const Vec2& at) {
  constexpr double h = 1e-60;
  const Eigen::VectorXcd by_s = blend(patch, {at[0], h}, at[1]), by_t = blend(patch, at[0], {at[1], h});
  Eigen::MatrixX3d B(5 * patch.sides(), 3);
  B << by_s.real(), by_s.imag() / h, by_t.imag() / h;
  return B;
}

/// Makes the patches of faces.
class Patchwork {
 public:
  /// `smooth`: 0 facets, 1 Catmull-Rom, 2 B-spline; `corner`: the turn (degrees, of the places X) of a crease.
  Patchwork(const Field& X, const std::vector<Nodes>& faces, int smooth, double corner)
      : faces_(faces), smooth_(smooth), least_(std::cos(corner * std::numbers::pi / 180) - 1e-9) {
    for (int f = 0; f < std::ssize(faces); ++f)
      for (int j = 0; j < sides(f); ++j) {
        left_[{node(f, j), node(f, j + 1)}] = {f, j};
        faces_at_[node(f, j)].push_back(f);
      }
    find_creases(X);
    for (int f = 0; f < std::ssize(faces); ++f) patches.push_back(patch_of(f));
  }

  std::vector<FacePatch> patches;  ///< by face

 private:
  using Corner = std::array<int, 2>;  ///< of a face, and which
  using Mask = Eigen::VectorXd;       ///< weights of a patch's nodes

  int node(int face, int j) const { return faces_[face][j % faces_[face].size()]; }
  /// The edge after a corner, or before it.
  std::array<int, 2> edge(const Corner& at, bool before) const {
    const auto& [face, j] = at;
    const int near = node(face, j), far = node(face, j + (before ? sides(face) - 1 : 1));
    return before ? std::array{far, near} : std::array{near, far};
  }
  int sides(int face) const { return static_cast<int>(faces_[face].size()); }
  bool is_crease(const std::array<int, 2>& edge) const { return creases_.contains({edge[0], edge[1]}); }

  /// Edges, in both directions, where the surface turns or ends, and nodes where these turn, branch or end.
  void find_creases(const Field& X) {
    std::map<int, Nodes> ends;  // of creases by the node where they meet
    const auto normal = [&](const Corner& at) { return area_vector(X, faces_[at[0]]).normalized(); };
    for (const auto& [edge, at] : left_) {
      const std::array back{edge[1], edge[0]};
      const auto other = left_.find(back);
      const bool goes_on = smooth_ > 0 && other != left_.end() && normal(at).dot(normal(other->second)) >= least_;
      if (goes_on) continue;
      creases_.insert(edge);
      if (creases_.insert(back).second) ends[edge[0]].push_back(edge[1]), ends[edge[1]].push_back(edge[0]);
    }
    for (const auto& [here, others] : ends) {
      const auto along = [&X, from = here, &to = others](int k) { return (X.col(to[k]) - X.col(from)).normalized(); };
      if (others.size() == 1)
        tips_.insert(here);
      else if (others.size() > 2 || -along(0).dot(along(1)) < least_)
        corners_.insert(here);
    }
    for (int f = 0; f < std::ssize(faces_); ++f)  // a face that is alone with a node
      for (int j = 0; j < sides(f); ++j)
        if (is_crease(edge({f, j}, false)) && is_crease(edge({f, j}, true))) corners_.insert(node(f, j));
  }

  /// The corner at the same node across the edge after it, or before it.
  Corner next(const Corner& at, bool before) const {
    const auto [from, to] = edge(at, before);
    const auto [face, j] = left_.at({to, from});
    return {face, before ? j : (j + 1) % sides(face)};
  }

  /// What a patch has of a node: masks of p, of e+ - p and e- - p, of r where the ring decides it, and c.
  struct Vertex {
    Mask p;
    std::array<Mask, 2> spoke, twist;
    double cosine;
    std::array<Vec2, 2> way;  ///< FacePatch::ways of the edge after the corner and of that before, if they are ends
  };

  Vertex vertex(const Corner& here, const std::map<int, int>& number) const {
    std::vector<Corner> ring{here};  // counter-clockwise; from a crease on, if there is one
    const bool is_tip = tips_.contains(node(here[0], here[1]));
    const auto goes_on = [&](const Corner& at, bool before) { return is_tip || !is_crease(edge(at, before)); };
    while (goes_on(ring[0], false) && next(ring[0], false) != here) ring[0] = next(ring[0], false);
    const bool closed = goes_on(ring[0], false);
    while (goes_on(ring.back(), true) && next(ring.back(), true) != ring[0]) ring.push_back(next(ring.back(), true));
    const int K = static_cast<int>(ring.size()), own = static_cast<int>(std::ranges::find(ring, here) - ring.begin());
    const auto X = [&](int n) -> Mask { return Mask::Unit(std::ssize(number), number.at(n)); };
    const auto wrap = [&](int k) { return closed ? (k + K) % K : k; };
    const Mask v = X(node(here[0], here[1]));
    std::vector<Mask> x, d;  // of spokes; the far node of faces, of a triangle one of the same centroid
    for (const auto& [f, j] : ring) {
      x.push_back(X(node(f, j + 1)));
      d.push_back(sides(f) == 4 ? X(node(f, j + 2)) : Mask((v + x.back() + X(node(f, j + 2))) / 3));
    }
    if (!closed) x.push_back(X(edge(ring.back(), true)[0]));
    const bool is_corner = corners_.contains(node(here[0], here[1]));
    const double theta = std::numbers::pi * (closed ? 2 : is_corner ? 0.5 : 1) / K, C = std::cos(theta);
    const auto turn = [&](int k) { return Vec2(std::cos(k * theta), std::sin(k * theta)); };
    Vertex vertex{v, {}, {}, C, {Vec2(0, 1), Vec2(0, 1)}};
    if (!closed && K > 1) {  // beyond a border the faces at a node go on along one line: that of t2, or the bisector
      const Vec2 line = is_corner ? Vec2(1, 1).normalized() : Vec2(0, 1);
      vertex.way = {Eigen::Matrix2d{{1, C}, {0, std::sin(theta)}}.inverse() * line,
                    (Eigen::Matrix2d() << -turn(K), turn(K - 1)).finished().inverse() * line};
    }
    Eigen::MatrixX2d T = Eigen::MatrixX2d::Zero(v.size(), 2);  // t1, t2
    if (is_corner) {
      T << x[0] - v, x[K] - v;
      T /= 3;
    } else if (smooth_ == 1) {
      for (int k = 0; k < std::ssize(x); ++k) T += (x[k] - v) * turn(k).transpose() * 2 / (3 * K);
    } else {
      const double c = std::cos(std::numbers::pi / K), root = std::sqrt(4 + c * c), A = 1 + C + 2 * c * root;
      for (int k = 0; k < K; ++k)
        T += (closed ? A : 4) * x[k] * turn(k).transpose() + d[k] * (turn(k) + turn(k + 1)).transpose();
      if (closed) {
        T *= (4 + A) * (1 + 3 * c / root) / (24 * K * (A + 2 + 2 * C));
        vertex.p *= K * K;
        for (int k = 0; k < K; ++k) vertex.p += 4 * x[k] + d[k];
        vertex.p /= K * (K + 5);
      } else {
        T.col(1) -= 4 * std::sin(theta) * v + (1 + 2 * C) * std::sqrt((1 + C) / (1 - C)) * (x[0] + x[K]);
        T /= 3 * (3 * K + C);
        vertex.p = (x[0] + 4 * v + x[K]) / 6;
      }
    }
    if (!closed && !is_corner) T.col(0) = (x[0] - x[K]) / 6;
    for (const int side : {0, 1}) vertex.spoke[side] = T * turn(own + side);
    const bool regular = closed && K == 4 && std::ranges::all_of(ring, [&](auto& at) { return sides(at[0]) == 4; });
    for (const int side : {0, 1}) {  // by the ring, where both sides of a spoke have a face
      const int k = wrap(own + side), on = wrap(k + 1), back = wrap(k - 1);
      if (smooth_ == 0 || (smooth_ == 1 && !regular) || back < 0 || on >= std::ssize(x)) continue;
      vertex.twist[side] = smooth_ == 2 ? Mask((x[on] - x[back]) / 3 + (d[k] - d[back]) / 6)
                                        : Mask(3 * T * turn(k + 1) + (d[k] - d[back] + d[wrap(k + 2)] - d[on]) / 12);
      if (side == 1) vertex.twist[side] *= -1;
    }
    return vertex;
  }

  FacePatch patch_of(int f) const {
    std::map<int, int> number;  // of the nodes of faces that have one in common
    for (const int near : faces_[f])
      for (const int face : faces_at_.at(near))
        for (const int n : faces_[face]) number.emplace(n, std::ssize(number));
    const int m = sides(f);
    FacePatch patch{faces_[f], Nodes(number.size()), Eigen::MatrixXd(number.size(), 5 * m), {}, {}};
    for (const auto& [n, k] : number) patch.nodes[k] = n;
    std::vector<Vertex> vertices;
    for (int j = 0; j < m; ++j) {
      vertices.push_back(vertex({f, j}, number));
      const auto other = left_.find({node(f, j + 1), node(f, j)});
      const bool is_crease_here = is_crease(edge({f, j}, false));
      patch.beyond.push_back(other == left_.end() ? FacePatch::none
                             : is_crease_here     ? other->second[0]
                                                  : FacePatch::smooth);
    }
    for (int j = 0; j < m; ++j) {
      const auto& [p, spoke, twist, c, way] = vertices[j];
      patch.ways.push_back({way[0], vertices[(j + 1) % m].way[1]});
      patch.weigh.col(j) = p;
      for (const int side : {0, 1}) {
        const Vertex& other = vertices[(j + (side == 0 ? 1 : m - 1)) % m];
        const Mask near = spoke[!side] - c * spoke[side], far = other.spoke[side] - other.cosine * other.spoke[!side];
        const Mask r = twist[side].size() > 0 ? twist[side] : Mask(2 * near + far);
        const double D = m == 3 ? 4 : 3;
        patch.weigh.col((1 + side) * m + j) = p + spoke[side];
        patch.weigh.col((3 + side) * m + j) =
            p + ((D - 2 * c - other.cosine) * spoke[side] + 2 * c * (other.p + other.spoke[!side] - p) + r) / D;
      }
    }
    return patch;
  }

  std::vector<Nodes> faces_;
  int smooth_;
  double least_;                                    ///< cosine of the turn of a crease
  std::map<std::array<int, 2>, Corner> left_ = {};  ///< the face on the left of an edge, and the corner it begins at
  std::map<int, Nodes> faces_at_ = {};              ///< by node
  std::set<std::array<int, 2>> creases_ = {};
  std::set<int> corners_ = {};
  std::set<int> tips_ = {};  ///< where one crease ends; there the surface is smooth all around
};

}  // namespace stickslip::verify
