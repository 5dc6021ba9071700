#include "core/contact/face_search.hpp"

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
    return bounds;
  });
}

std::array<Vec<double, 3>, 4> FaceSearch::corners(const FacePlace& face) const {
  return corners_of<double>(face, [this](int node) -> Vec<double, 3> { return points_.col(node); });
}

Vec<double, 3> FaceSearch::across(int face) const {
  const auto corner = corners(faces_[face]);
  return area_vector<double>(faces_[face].corners, [&](int k) { return corner[k]; });
}

std::vector<FaceSearch::Near> FaceSearch::nearest(const Vec<double, 3>& x,
                                                  const std::function<bool(int)>& counts) const {
  std::vector<Near> near;  // as near as the nearest so far, and ties
  double least = std::numeric_limits<double>::infinity();
  const auto skips = [&](const Bounds<3>& box) { return box.distance(x) > least + band_; };
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
  const auto has = [](const FacePlace& face, int node) {
    return std::find(face.nodes.begin(), face.nodes.begin() + face.corners, node) != face.nodes.begin() + face.corners;
  };
  for (const auto& near : places) {
    const auto corner = corners(near.place);
    for (int k = 0; k < near.place.corners; ++k) {
      const int from_node = near.place.nodes[k], to_node = near.place.nodes[(k + 1) % near.place.corners];
      const auto is_beyond = [&](const Near& end) { return has(end.place, from_node) && has(end.place, to_node); };
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
