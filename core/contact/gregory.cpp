/// Control points of Gregory patches. At a node a with the spokes x_0, x_1, ... to its neighbours, counter-clockwise,
/// and K faces between them there are a point p and two tangents t_1, t_2. The first control point on spoke k is
///
///   e_k = p + cos(k theta) t_1 + sin(k theta) t_2
///
/// with theta = 2 pi / K inside of a surface and pi / K at its border, so that all e_k lie in one plane through p.
/// Along the edge a -> b the surface has a cubic b_i = p_a, e_a, e_b, p_b, and across it a derivative in the plane of
/// the edge and of a field r, which runs from its value at a to that at b. The inner control point at a is
///
///   (c_b b_0 + (D - 2 c_a - c_b) b_1 + 2 c_a b_2 + r_a) / D,   c = cos theta, D = 3; in a triangle D = 4
///
/// The two faces at an edge use r and -r, so their normals agree there.
///
/// Beyond its border the surface goes on straight from a node along -t_2, and from a corner along -(t_1 + t_2) / sqrt 2
/// (WayBeyond); from a corner of one face it does along both edges. Sources:
///   Gregory, Smooth interpolation without twist constraints, in: Computer Aided Geometric Design (1974)
///   Loop, Schaefer, Ni, Castano, Approximating subdivision surfaces with Gregory patches, ACM TOG 28 (2009) 151
///   Halstead, Kass, DeRose, Efficient, fair interpolation using Catmull-Clark surfaces, SIGGRAPH (1993) 35: limits
#include "core/contact/gregory.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

namespace stickslip::detail {
namespace {

using std::numbers::pi;

/// A point as weights of nodes.
struct Combination {
  std::vector<std::pair<int, double>> weights;  ///< nodes ascending
  Combination() = default;
  explicit Combination(int node) : weights{{node, 1.0}} {}
  Combination& operator+=(const Combination& other) {
    std::vector<std::pair<int, double>> sum;
    sum.reserve(weights.size() + other.weights.size());
    auto own = weights.begin();
    for (const auto& [node, weight] : other.weights) {
      while (own != weights.end() && own->first < node) sum.push_back(*own++);
      const bool is_shared = own != weights.end() && own->first == node;
      sum.emplace_back(node, (is_shared ? (own++)->second : 0) + weight);
    }
    sum.insert(sum.end(), own, weights.end());
    sum.shrink_to_fit();
    weights = std::move(sum);
    return *this;
  }
  friend Combination operator*(double factor, Combination of) {
    for (auto& [node, weight] : of.weights) weight *= factor;
    return of;
  }
  friend Combination operator+(Combination a, const Combination& b) { return a += b; }
  friend Combination operator-(Combination a, const Combination& b) { return a += -1.0 * b; }
};

/// A node with the faces around it over which the surface is smooth.
struct Fan {
  bool is_closed = false;                        ///< the last face joins the first
  std::vector<int> faces;                        ///< patches, counter-clockwise
  std::vector<int> spokes;                       ///< nodes: spoke k is before face k; of an open fan one more
  Combination point;                             ///< p
  std::vector<Combination> edge;                 ///< e_k
  double cosine = 0;                             ///< of theta
  WayBeyond beyond;                              ///< of the face behind the first spoke
  std::vector<Combination> across;               ///< r of the tangents alone, per spoke
  std::vector<std::optional<Combination>> ring;  ///< r of all nodes around; none: r runs from tangents to tangents

  int count() const { return static_cast<int>(spokes.size()); }
  /// The number of the spoke to a node, before or behind a face.
  int spoke(int face, int corner_of_patch_after) const { return (face + corner_of_patch_after) % count(); }
};

class ControlPoints {
 public:
  ControlPoints(Surface<3>& patches, Smoothing smoothing, const std::vector<char>& is_corner)
      : patches_(patches), interpolates_(smoothing == Smoothing::catmull_rom), is_corner_(is_corner) {}

  void set() {
    std::vector<std::array<std::shared_ptr<const Fan>, 4>> fans(patches_.size());
    std::vector<std::array<int, 4>> place(patches_.size());  // of each patch in its fans
    for (int f = 0; f < static_cast<int>(patches_.size()); ++f)
      for (int j = 0; j < patches_[f].corners; ++j) {
        if (fans[f][j]) continue;
        const auto fan = std::make_shared<const Fan>(make_fan(f, j));
        for (int k = 0; k < static_cast<int>(fan->faces.size()); ++k) {
          const int corner = corner_of(fan->faces[k], patches_[f].vertices[j]);
          fans[fan->faces[k]][corner] = fan;
          place[fan->faces[k]][corner] = k;
        }
      }
    for (std::size_t f = 0; f < patches_.size(); ++f) {
      Patch<3>& patch = patches_[f];
      keep(points_of(patch.corners, fans[f], place[f]), patch);
      for (int k = 0; k < patch.corners; ++k)
        if (!patch.goes_on(k)) {
          const WayBeyond &at = fans[f][k]->beyond, &end = fans[f][(k + 1) % patch.corners]->beyond;
          patch.beyond[k] = {at, {-end.along, end.across}};
        }
    }
  }

 private:
  int corner_of(int f, int vertex) const {
    int j = 0;
    while (patches_[f].vertices[j] != vertex) ++j;
    return j;
  }
  int vertex(int f, int corner) const {
    const int n = patches_[f].corners;
    return patches_[f].vertices[((corner % n) + n) % n];
  }
  /// The patch behind the edge that begins, or with `turn` = -1 that ends, at a corner, where the surface is smooth.
  int beside(int f, int corner, int turn) const {
    const int n = patches_[f].corners, edge = turn > 0 ? (corner + n - 1) % n : corner;
    return patches_[f].goes_on(edge) ? patches_[f].across[edge] : no_patch;
  }

  Fan make_fan(int f, int j) const {
    const int a = vertex(f, j);
    int first = f;
    Fan fan;
    for (int next = beside(first, corner_of(first, a), -1); next != no_patch;
         next = beside(first, corner_of(first, a), -1)) {
      first = next;
      if (first == f) break;
    }
    int last = first;
    while (true) {
      fan.faces.push_back(last);
      fan.spokes.push_back(vertex(last, corner_of(last, a) + 1));
      const int next = beside(last, corner_of(last, a), 1);
      fan.is_closed = next == first;
      if (next == no_patch || fan.is_closed) break;
      last = next;
    }
    if (!fan.is_closed) fan.spokes.push_back(vertex(last, corner_of(last, a) - 1));
    if (!fan.is_closed && fan.spokes.front() == fan.spokes.back()) {  // a crease ends here: the node itself is smooth
      fan.is_closed = true;
      fan.spokes.pop_back();
    }
    set_tangents(a, fan);
    return fan;
  }

  Combination centre(int f) const {
    Combination sum;
    for (int j = 0; j < patches_[f].corners; ++j) sum += Combination(vertex(f, j));
    return 1.0 / patches_[f].corners * sum;
  }

  void set_tangents(int a, Fan& fan) const {
    const int n = fan.count(), K = static_cast<int>(fan.faces.size());
    const Combination v(a);
    std::vector<Combination> x, d;  // neighbours; far nodes of faces, of a triangle its centre
    for (int node : fan.spokes) x.emplace_back(node);
    for (int k = 0; k < K; ++k) d.push_back(4.0 * centre(fan.faces[k]) - v - x[k] - x[(k + 1) % n]);
    double theta = fan.is_closed ? 2 * pi / n : pi / K;
    Combination t1, t2;
    const auto turned = [&](int k) { return std::cos(k * theta) * t1 + std::sin(k * theta) * t2; };
    fan.point = v;
    if (fan.is_closed && interpolates_) {
      for (int k = 0; k < n; ++k) {
        t1 += 2.0 / (3 * n) * std::cos(k * theta) * x[k];
        t2 += 2.0 / (3 * n) * std::sin(k * theta) * x[k];
      }
    } else if (fan.is_closed) {
      const double A = tangent_mask(n), size = limit_size(n);
      fan.point = 1.0 * n * n * v;
      for (int k = 0; k < n; ++k) {
        fan.point += 4.0 * x[k] + d[k];
        const double c = std::cos(k * theta), s = std::sin(k * theta);
        t1 += size * (A * c * x[k] + (c + std::cos((k + 1) * theta)) * d[k]);
        t2 += size * (A * s * x[k] + (s + std::sin((k + 1) * theta)) * d[k]);
      }
      fan.point = 1.0 / (n * (n + 5)) * fan.point;
    } else if (is_corner_[a]) {  // the two borders keep their directions, and those between turn from one to the other
      theta = pi / (2 * K);
      t1 = 1.0 / 3 * (x.front() - v);
      t2 = 1.0 / 3 * (x.back() - v);
    } else {
      const double C = std::cos(theta), S = std::sin(theta), D = 3 * K + C;
      t1 = 1.0 / 6 * (x.front() - x.back());
      if (!interpolates_) {
        const double a0 = -(1 + 2 * C) * std::sqrt(1 + C) / (D * std::sqrt(1 - C));
        fan.point = 1.0 / 6 * (x.front() + 4.0 * v + x.back());
        t2 = 1.0 / 3 * (-4 * S / D * v + a0 * (x.front() + x.back()) + S / D * d[0]);
      }
      for (int k = 1; k < K; ++k) {
        const double s = std::sin(k * theta);
        t2 += interpolates_ ? 2.0 / (3 * K) * s * (x[k] - v)
                            : 1.0 / (3 * D) * (4 * s * x[k] + (s + std::sin((k + 1) * theta)) * d[k]);
      }
    }
    for (int k = 0; k < n; ++k) fan.edge.push_back(fan.point + turned(k));
    fan.cosine = std::cos(theta);
    // t_2 and (t_1 + t_2) / sqrt 2 of the derivatives along the first spoke, t_1, and across it, cos t_1 + sin t_2
    const double sine = std::sin(theta), half = std::sqrt(0.5) / sine;
    if (!fan.is_closed && K > 1)
      fan.beyond =
          is_corner_[a] ? WayBeyond{half * (sine - fan.cosine), half} : WayBeyond{-fan.cosine / sine, 1 / sine};
    set_across(x, d, fan);
  }

  /// Sets r, half of the derivative across a spoke, from its right to its left.
  void set_across(const std::vector<Combination>& x, const std::vector<Combination>& d, Fan& fan) const {
    const int n = fan.count(), K = static_cast<int>(fan.faces.size());
    bool regular = fan.is_closed && n == 4;
    for (int f : fan.faces) regular &= patches_[f].corners == 4;
    for (int k = 0; k < n; ++k) {
      const bool has_left = fan.is_closed || k < K, has_right = fan.is_closed || k > 0;
      const int left = (k + 1) % n, right = (k + n - 1) % n;
      const Combination own = 3 * fan.cosine * (fan.edge[k] - fan.point);
      fan.across.push_back(has_left ? 3.0 * (fan.edge[left] - fan.point) - own
                                    : own - 3.0 * (fan.edge[right] - fan.point));
      auto& ring = fan.ring.emplace_back();
      if (!has_left || !has_right) continue;
      if (!interpolates_)
        ring =
            1.0 / 6 * (x[left] - x[right]) + 2.0 / 3 * (centre(fan.faces[k % K]) - centre(fan.faces[(k + K - 1) % K]));
      else if (regular)
        ring = fan.across[k] + 1.0 / 12 * (d[k] - d[right] + d[(k + 2) % 4] - d[left]);
    }
  }

  /// Share of the neighbours in the tangents of subdivision at a node with n faces, the far nodes' being 1.
  static double tangent_mask(int n) {
    const double C = std::cos(2 * pi / n);
    return 1 + C + std::cos(pi / n) * std::sqrt(2 * (9 + C));
  }

  /// Factor of the tangents at a node with n faces, by which |e - p| is 2/3 lambda |q| of Loop et al., lambda the
  /// second eigenvalue of subdivision.
  static double limit_size(int n) {
    const double theta = 2 * pi / n, C = std::cos(theta), half = std::cos(pi / n);
    const double A = tangent_mask(n), sigma = 1 / std::sqrt(4 + half * half);
    const double lambda = (5 + C + half * std::sqrt(18 + 2 * C)) / 16;
    double own = 0, q = 0;  // of a plane star of unit spokes
    for (int k = 0; k < n; ++k) {
      const double c = std::cos(k * theta), far = c + std::cos((k + 1) * theta);
      own += A * c * c + far * far;
      q += 2.0 / n * ((1 - sigma * half) * c * c / 2 + 2 * sigma * std::cos(k * theta + pi / n) * far / 2);
    }
    return 2.0 / 3 * lambda * q / own;
  }

  using Fans = std::array<std::shared_ptr<const Fan>, 4>;

  /// The control points of a patch, in the order of the basis.
  static std::vector<Combination> points_of(int corners, const Fans& fans, const std::array<int, 4>& place) {
    std::vector<Combination> points(points_per_corner * corners);
    for (int j = 0; j < corners; ++j) {
      const int next = (j + 1) % corners;
      const Fan &at = *fans[j], &end = *fans[next];
      const int out = at.spoke(place[j], 0), back = end.spoke(place[next], 1);
      points[j] = at.point;
      points[corners + j] = at.edge[out];
      points[2 * corners + next] = end.edge[back];
      const Combination r_at = at.across[out], r_end = -1.0 * end.across[back];
      const auto &ring_at = at.ring[out], &ring_end = end.ring[back];
      const Combination &b0 = at.point, &b1 = at.edge[out], &b2 = end.edge[back], &b3 = end.point;
      const double D = corners == 4 ? 3 : 4, ca = at.cosine, cb = end.cosine;
      const Combination first = ring_at ? *ring_at : 1.0 / 3 * (2.0 * r_at + r_end);
      const Combination second = ring_end ? -1.0 * *ring_end : 1.0 / 3 * (r_at + 2.0 * r_end);
      points[3 * corners + j] = 1 / D * (cb * b0 + (D - 2 * ca - cb) * b1 + 2 * ca * b2 + first);
      points[4 * corners + next] = 1 / D * (ca * b3 + (D - 2 * cb - ca) * b2 + 2 * cb * b1 + second);
    }
    return points;
  }

  /// Sets the vertices and the matrix of a patch.
  static void keep(const std::vector<Combination>& points, Patch<3>& patch) {
    std::map<int, Eigen::Index> columns;
    for (int j = 0; j < patch.corners; ++j) columns[patch.vertices[j]] = j;
    for (const auto& point : points)
      for (const auto& [node, weight] : point.weights)
        if (columns.emplace(node, static_cast<Eigen::Index>(patch.vertices.size())).second)
          patch.vertices.push_back(node);
    patch.control = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(points.size()),
                                          static_cast<Eigen::Index>(patch.vertices.size()));
    for (std::size_t c = 0; c < points.size(); ++c)
      for (const auto& [node, weight] : points[c].weights)
        patch.control(static_cast<Eigen::Index>(c), columns[node]) = weight;
  }

  Surface<3>& patches_;
  bool interpolates_;
  const std::vector<char>& is_corner_;
};

}  // namespace

void set_control_points(Surface<3>& patches, Smoothing smoothing, const std::vector<char>& is_corner) {
  ControlPoints(patches, smoothing, is_corner).set();
}

}  // namespace stickslip::detail
