#include "core/contact/face_search.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <map>

#include "core/contact/surfaces.hpp"

namespace stickslip {
namespace {

/// Whether place a precedes place b at the same distance.
bool precedes(const NearestPlace& a, const NearestPlace& b) {
  const bool a_inside = a.place.part == FacePart::inside, b_inside = b.place.part == FacePart::inside;
  if (a_inside != b_inside) return a_inside;
  return std::lexicographical_compare(a.position.begin(), a.position.end(), b.position.begin(), b.position.end());
}

std::vector<FacePlace> faces_of(const std::vector<std::vector<int>>& all) {
  std::vector<FacePlace> faces;
  for (const auto& nodes : all) {
    auto& face = faces.emplace_back();
    face.corners = static_cast<int>(nodes.size());
    std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
  }
  return faces;
}

std::vector<std::array<char, 4>> borders_of(const std::vector<std::vector<int>>& faces) {
  std::map<std::pair<int, int>, int> count;  // of faces at an edge
  const auto edge = [](const std::vector<int>& nodes, std::size_t k) -> std::pair<int, int> {
    return std::minmax(nodes[k], nodes[(k + 1) % nodes.size()]);
  };
  for (const auto& nodes : faces)
    for (std::size_t k = 0; k < nodes.size(); ++k) ++count[edge(nodes, k)];
  std::vector<std::array<char, 4>> borders;
  for (const auto& nodes : faces) {
    auto& border = borders.emplace_back();
    for (std::size_t k = 0; k < nodes.size(); ++k) border[k] = count[edge(nodes, k)] == 1;
  }
  return borders;
}

}  // namespace

FaceSearch::FaceSearch(Points<double> points, const std::vector<std::vector<int>>& faces)
    : FaceSearch(std::move(points), faces_of(faces), borders_of(faces)) {}

FaceSearch::FaceSearch(Points<double> points, std::vector<FacePlace> faces, std::vector<std::array<char, 4>> border)
    : points_(std::move(points)), faces_(std::move(faces)), border_(std::move(border)) {
  std::vector<int> numbers;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    const auto& face = faces_[f];
    const auto corner = corners(face);
    bool is_finite = true;
    for (int k = 0; k < face.corners; ++k) {
      is_finite &= corner[k].allFinite();
      band_ = std::max(band_, at_face_edge * (corner[(k + 1) % face.corners] - corner[k]).norm());
    }
    if (is_finite) numbers.push_back(static_cast<int>(f));
  }
  boxes_ = BoxTree<3>(std::move(numbers), [this](int f) {
    const auto corner = corners(faces_[f]);
    Bounds<3> bounds{corner[0], corner[0]};
    for (int k = 1; k < faces_[f].corners; ++k) bounds.take_in({corner[k], corner[k]});
    const Vec<double, 3> normal = across(f).normalized();
    if (normal.squaredNorm() > 0) bounds.normal_low = bounds.normal_high = normal;  // (a face without area has any)
    return bounds;
  });
}

std::array<Vec<double, 3>, 4> FaceSearch::corners(const FacePlace& face) const {
  return corners_of<double>(face, [this](int node) -> Vec<double, 3> { return points_.col(node); });
}

double FaceSearch::size() const {
  return boxes_.empty() ? std::numeric_limits<double>::infinity() : (boxes_.whole().high - boxes_.whole().low).norm();
}

Vec<double, 3> FaceSearch::across(int face) const {
  const auto corner = corners(faces_[face]);
  return area_vector<double>(faces_[face].corners, [&](int k) { return corner[k]; });
}

std::vector<FaceSearch::Near> FaceSearch::nearest(const Vec<double, 3>& x, const std::function<bool(int)>& counts,
                                                  const Opposing& opposing) const {
  constexpr double rounding = 1e-12;
  const Eigen::Array3d outward = opposing.outward.array();
  const double most = (rounding - opposing.least) * opposing.outward.norm();
  std::vector<Near> near;  // as near as the nearest so far, and ties
  double least = std::numeric_limits<double>::infinity();
  const auto skips = [&](const Bounds<3>& box) {
    if (box.distance(x) > least + band_) return true;
    return (outward * box.normal_low.array()).min(outward * box.normal_high.array()).sum() > most;
  };
  boxes_.visit(x, skips, [&](int f) {
    if (!counts(f)) return;
    near.push_back({nearest_of_face(faces_[f], corners(faces_[f]), x), f});
    least = std::min(least, near.back().distance);
  });
  std::erase_if(near, [&](const Near& at) { return at.distance > least + band_; });
  if (near.empty()) return near;
  const NearestPlace best = *std::min_element(near.begin(), near.end(), precedes);
  std::erase_if(near, [&](const Near& at) { return (at.position - best.position).norm() > 2 * band_; });
  return near;
}

double FaceSearch::first_hit(const Vec<double, 3>& x, const Vec<double, 3>& way,
                             const std::function<bool(int)>& counts) const {
  constexpr double infinity = std::numeric_limits<double>::infinity(), wider = 1e-9;
  double first = infinity;
  const auto skips = [&](const Bounds<3>& box) {  // the lengths at which the ray is in the box
    double from = 0, to = first;
    for (int i = 0; i < 3; ++i) {
      const double low = box.low[i] - band_ - x[i], high = box.high[i] + band_ - x[i];
      if (way[i] == 0) {
        if (low > 0 || high < 0) return true;
        continue;
      }
      from = std::max(from, std::min(low / way[i], high / way[i]));
      to = std::min(to, std::max(low / way[i], high / way[i]));
    }
    return from > to;
  };
  boxes_.visit(x, skips, [&](int f) {
    if (!counts(f)) return;
    const auto corner = corners(faces_[f]);
    for (int k = 1; k + 1 < faces_[f].corners; ++k) {
      Mat<double, 3> sides;  // x + length way = corner 0 + a side 1 + b side 2
      sides << corner[k] - corner[0], corner[k + 1] - corner[0], -way;
      const double volume = sides.determinant();
      if (volume == 0) continue;
      const Vec<double, 3> at = sides.inverse() * (x - corner[0]);
      if (std::min({at[0], at[1], 1 - at[0] - at[1]}) >= -wider && at[2] > 0) first = std::min(first, at[2]);
    }
  });
  return first;
}

std::vector<FacePlace> FaceSearch::closest(const Vec<double, 3>& x, const Vec<double, 3>& outward) const {
  auto near = nearest(x, [](int) { return true; });
  const auto away = std::stable_partition(near.begin(), near.end(), [&](const Near& at) {
    return outward == Vec<double, 3>::Zero() || opposes<3>(across(at.face), outward);
  });
  const std::vector<Near> ends(away, near.end());
  near.erase(away, near.end());
  if (is_past_border(near, ends, x)) return {};
  std::vector<FacePlace> places;
  for (const auto& at : near) places.push_back(at.place);
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.nodes < b.nodes; });
  return places;
}

bool FaceSearch::is_past_border(const std::vector<Near>& places, const std::vector<Near>& ends,
                                const Vec<double, 3>& x) const {
  for (const auto& near : places) {
    const auto corner = corners(near.place);
    for (int k = 0; k < near.place.corners; ++k) {
      const int from_node = near.place.nodes[k], to_node = near.place.nodes[(k + 1) % near.place.corners];
      const auto is_beyond = [&](const Near& end) { return end.place.has(from_node) && end.place.has(to_node); };
      if (!border_[near.face][k] && std::none_of(ends.begin(), ends.end(), is_beyond)) continue;
      const Vec<double, 3> along = (corner[(k + 1) % near.place.corners] - corner[k]).normalized();
      const Vec<double, 3> from = near.position - corner[k];
      if ((from - from.dot(along) * along).norm() > band_) continue;  // (not on this edge)
      const auto at =
          face_position(corner, face_weights<double>(near.place.corners, near.place.at[0], near.place.at[1]));
      const Vec<double, 3> outward = cross<double>(along, cross(at.along_s, at.along_t)).normalized();
      if ((x - near.position).dot(outward) > mesh_file_rounding * near.size) return true;
    }
  }
  return false;
}

}  // namespace stickslip
