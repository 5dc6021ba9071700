/// What the nodes of a side in space that touches itself may face (core/README.md, A side that touches itself): by
/// comparison of all nodes with all faces.
#pragma once

#include <map>

#include "studies/verify/masters.hpp"

namespace stickslip::verify {

class OwnWalls {
 public:
  /// `X`: nodes at the start; `faces`: corners of the side; `seekers`: its nodes at the start.
  OwnWalls(const Field& X, const std::vector<Nodes>& faces, const std::vector<Seeker>& seekers) : X_(X), faces_(faces) {
    for (const Seeker& seeker : seekers) {
      double size = 0, edges = 0;
      for (const Nodes& face : faces)
        for (std::size_t j = 0; std::ranges::count(face, seeker.node) > 0 && j < face.size(); ++j)
          size += (X.col(face[j]) - X.col(face[(j + 1) % face.size()])).norm(), ++edges;
      const double thickness = first_face(seeker, -seeker.outward.normalized(), 1);
      walls_[seeker.node] = {std::max(size / edges, thickness), thickness < infinity ? 3 * thickness : -infinity};
    }
    const Vec3 way = way_across(seekers);
    std::vector<std::pair<double, int>> along;
    for (const Seeker& seeker : seekers) along.emplace_back(way.dot(seeker.x), seeker.node);
    std::ranges::sort(along);
    for (int k = 0; k < std::ssize(along); ++k) walls_[along[k].second].number = k;
  }

  /// Whether a node may touch a face: it is none of its corners, and not of the other side of its own wall.
  bool may_touch(int node, int face) const {
    const Wall& wall = walls_.at(node);
    const Vec3 area = area_vector(X_, faces_[face]), off = X_.col(node) - middle(X_, face);
    const double half = half_width(X_, face);
    const bool is_own = off.dot(area) < -at_end * half * area.norm() && off.norm() < wall.reach + 2 * half;
    return !is_own && std::ranges::count(faces_[face], node) == 0;
  }

  /// Whether it may face it, where nodes are at x: they look at one another, and the node is not too deep inside.
  bool may_face(const Seeker& seeker, int face, const Field& x) const {
    const Vec3 area = area_vector(x, faces_[face]), normal = area.normalized();
    if (seeker.outward.dot(normal) > -0.5 * seeker.outward.norm() || !may_touch(seeker.node, face)) return false;
    const Vec3 off = seeker.x - middle(x, face);
    const double depth = -off.dot(normal);
    if (depth <= 0) return true;
    const bool is_near =
        seeker.faced >= 0 && (middle(x, face) - middle(x, seeker.faced)).norm() <= 16 * half_width(x, seeker.faced);
    return is_beside(off, x(Eigen::all, faces_[face])) && depth <= (is_near ? 1 : 0.25) * walls_.at(seeker.node).depth;
  }

  /// Whether a place of a face, of weights N of its corners, comes after a node.
  bool comes_after(int node, int face, const Eigen::VectorXd& N) const {
    double number = 0;
    for (Eigen::Index j = 0; j < N.size(); ++j) number += N[j] * walls_.at(faces_[face][j]).number;
    return number > walls_.at(node).number;
  }

 private:
  /// Of a node: thickness, or the size of its faces; how far its wall goes; its number in the order of the side.
  struct Wall {
    double depth, reach, number = 0;
  };

  Vec3 middle(const Field& x, int face) const { return x(Eigen::all, faces_[face]).rowwise().mean(); }
  double half_width(const Field& x, int face) const {
    return (x(Eigen::all, faces_[face]).colwise() - middle(x, face)).colwise().norm().maxCoeff();
  }

  /// Whether a place, `off` the middle of a face of these corners, projects past no edge of it by more than half its
  /// width: the face is taken for a triangle, or for the parallelogram of the lines between middles of its edges.
  static bool is_beside(const Vec3& off, const Field& corner) {
    const bool is_triangle = corner.cols() == 3;
    Eigen::Matrix<double, 3, 2> sides;
    if (is_triangle)
      sides << corner.col(1) - corner.col(0), corner.col(2) - corner.col(0);
    else
      sides << corner.col(1) + corner.col(2) - corner.col(0) - corner.col(3),
          corner.col(2) + corner.col(3) - corner.col(0) - corner.col(1);
    const Vec2 at = sides.colPivHouseholderQr().solve(off);  // of a quadrilateral in halves of its width
    if (is_triangle) return std::min({at[0], at[1], -at.sum()}) >= -1.0 / 3 - 0.5;
    return 2 * at.cwiseAbs().maxCoeff() <= 1;
  }

  /// How far it is from a node to the first face whose normal has the given sign along a way.
  double first_face(const Seeker& from, const Vec3& way, int sign) const {
    double first = infinity;
    for (const Nodes& face : faces_) {
      if (std::ranges::count(face, from.node) > 0 || sign * area_vector(X_, face).dot(way) <= 0) continue;
      for (std::size_t j = 1; j + 1 < face.size(); ++j) {  // triangles: from + length way = a + r (b - a) + s (c - a)
        const Vec3 a = X_.col(face[0]);
        const Mat3 M = (Mat3() << X_.col(face[j]) - a, X_.col(face[j + 1]) - a, -way).finished();
        if (M.determinant() == 0) continue;
        const Vec3 at = M.partialPivLu().solve(from.x - a);
        if (std::min({at[0], at[1], 1 - at[0] - at[1]}) >= -at_end && at[2] > 0) first = std::min(first, at[2]);
      }
    }
    return first;
  }

  /// The direction in which nodes are numbered: across the voids, or else along the longest extent.
  Vec3 way_across(const std::vector<Seeker>& seekers) const {
    std::map<int, Vec3> areas;
    for (const Nodes& face : faces_)
      for (const int node : face)
        areas.try_emplace(node, Vec3::Zero()).first->second += area_vector(X_, face) / static_cast<double>(face.size());
    Vec3 mean = Vec3::Zero();
    double whole = 0;
    for (const Seeker& at : seekers) {
      mean += areas[at.node].norm() * at.x;
      whole += areas[at.node].norm();
    }
    mean /= whole;
    Mat3 voids = Mat3::Zero(), extent = Mat3::Zero();
    for (const Seeker& at : seekers) {
      const Vec3 n = areas[at.node].normalized(), off = at.x - mean;
      const double area = areas[at.node].norm(), length = first_face(at, n, -1);
      extent += area * off * off.transpose();
      if (length < infinity) voids += area / (length * length) * n * n.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(voids.isZero(0) ? extent : voids);
    Vec3 way = Vec3::Zero();
    for (int k = 0; k < 3; ++k)  // of equal axes one that is along none
      if (eigen.eigenvalues()[k] >= (1 - 1e-6) * eigen.eigenvalues()[2])
        way += eigen.eigenvectors().col(k).dot(Vec3(0.8, 0.53, 0.28)) * eigen.eigenvectors().col(k);
    double tail = 0, even = 0;
    for (const Seeker& at : seekers) {
      const double cube = areas[at.node].norm() * std::pow(way.dot(at.x - mean), 3);
      tail += cube;
      even += std::abs(cube);
    }
    return tail < -1e-6 * even ? Vec3(-way) : way;
  }

  Field X_;
  std::vector<Nodes> faces_;
  std::map<int, Wall> walls_;
};

}  // namespace stickslip::verify
