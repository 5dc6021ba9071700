/// Laws of materials, elements, bodies and loads, without tangents, which a check does not need (core/README.md,
/// Elements, Shares).
///
///   f_a = int P grad N_a dV,   of revolution + e_r int P_33 N_a / R dV,   H = sum u_a (x) grad N_a,  H_33 = u_r / R
///   mean dilatation: F -> (theta / J)^(1/3) F, theta the mean of J; small: H -> H + (theta - tr H) / 3 I  [H80, MOS90]
///   bar:  N = E A e,  e = (T.d + d.d / 2) / L^2 at finite strain, T.d / L^2 at small;  spring: f = K (u - u_anchor)
#pragma once

#include <fmt/format.h>

#include "studies/verify/scene.hpp"

namespace stickslip::verify {

/// What a point of a body remembers.
struct Particle {
  Mat3 strain = Mat3::Zero();  ///< plastic; at finite strain C_p^-1 - I
  double equivalent = 0;       ///< plastic strain
};

// --- laws of materials -----------------------------------------------------------------------------------------------
// From their formulas (core/README.md, Plasticity, Plane stress). H = F - I is the displacement gradient, 3 x 3;
// lame = E nu / ((1 + nu) (1 - 2 nu)), G = E / (2 (1 + nu)).
//
//   linear        sigma = lame tr(e) I + 2 G e,             e = sym H
//   neo-Hookean   P = (G (F F^T - I) + V U'(V) I) F^-T,     U = lame/2 (V - 1)^2 or lame/2 (ln V)^2, V = det F
//   J2 [SH98]     q = sqrt(3/2) |dev tau| <= bound(a),      e -= d n,  n = 3/2 dev tau / q,  a += d
//                 small: e = sym H - e_p;  finite [S92]: e = ln(F C_p^-1 F^T) / 2,  P = tau F^-T

/// The numbers of a material.
struct Material {
  double lame = 0, G = 0, E = 0;
  bool log_volume = false, plastic = false;
  std::vector<std::array<double, 2>> rows;  ///< (equivalent plastic strain, bound), from 0 to infinity

  explicit Material(const Body& body) {
    if (body.spring()) return;
    const auto law = body.given.at("material").begin();
    constexpr std::array known{"linear_elastic", "neo_hookean", "j2_plastic"};  // what respond() has
    if (std::ranges::find(known, law.key()) == known.end())
      throw BadFile(fmt::format("material {}: its law is not in studies/verify/solids.hpp", law.key()));
    const Json& given = law.value();
    const double nu = given.at("nu");
    E = given.at("E");
    lame = E * nu / ((1 + nu) * (1 - 2 * nu));
    G = E / (2 * (1 + nu));
    log_volume = given.value("volumetric", "quadratic") == "log";
    plastic = law.key() == "j2_plastic";
    if (!plastic) return;
    const Json& hardening = given.at("hardening");
    if (hardening.is_array()) rows = hardening.get<std::vector<std::array<double, 2>>>();
    if (rows.empty() || rows[0][0] > 0) rows.insert(rows.begin(), {0, given.at("yield").get<double>()});
    constexpr double far = 1e6;  // as good as infinity for a strain
    rows.push_back({far, rows.back()[1] + (hardening.is_number() ? hardening.get<double>() : 0) * far});
  }

  /// Growth d >= 0 of the equivalent plastic strain a where the trial q falls by `modulus` per growth:
  /// q - modulus d = bound(a + d).
  double growth(double q, double modulus, double a) const {
    for (std::size_t k = 1; k < rows.size(); ++k) {  // piece by piece, on each of which the bound is straight
      const auto [from, low] = rows[k - 1];
      const auto [to, high] = rows[k];
      const double slope = (high - low) / (to - from), d = (q - low - slope * (a - from)) / (modulus + slope);
      if (a < to && (d <= 0 || a + d <= to)) return std::max(d, 0.0);
    }
    return 0;
  }
};

/// A point at a motion.
struct Answer {
  Mat3 stress = Mat3::Zero();           ///< Cauchy at small strain, first Piola-Kirchhoff at finite strain
  double energy = 0, plastic_work = 0;  ///< per volume: stored; q d of the increment
  bool inverted = false;
};

/// det(I + H) - 1, without loss of digits where H is small.
inline double volume_change(const Mat3& H) {
  return H.trace() + (H.trace() * H.trace() - (H * H).trace()) / 2 + H.determinant();
}

/// A function of a symmetric tensor, by its principal values.
template <class F>
Mat3 of_principal(const Mat3& tensor, F&& f) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen((tensor + tensor.transpose()) / 2);
  return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(f).asDiagonal() * eigen.eigenvectors().transpose();
}

inline Answer respond(const Material& material, const Mat3& H, bool finite, Particle& particle) {
  Answer answer;
  const double change = volume_change(H), lame = material.lame, G = material.G;
  answer.inverted = finite && !(change > -1);
  if (answer.inverted) return answer;
  const Mat3 I = Mat3::Identity(), F = I + H, stretch = H + H.transpose() + H * H.transpose();
  const Mat3 inverse = finite ? Mat3(F.inverse()) : I;
  if (finite && !material.plastic) {
    const double log = std::log1p(change), grown = material.log_volume ? log : change;
    answer.energy = lame / 2 * grown * grown + G * (H.trace() + H.squaredNorm() / 2 - log);
    answer.stress = (G * stretch + lame * grown * (material.log_volume ? 1 : 1 + change) * I) * inverse.transpose();
    return answer;
  }
  const Mat3 small = (H + H.transpose()) / 2, trial = stretch + F * particle.strain * F.transpose();
  Mat3 e = finite ? of_principal(trial, [](double x) { return std::log1p(x) / 2; }) : Mat3(small - particle.strain);
  const Mat3 dev = 2 * G * (e - e.trace() / 3 * I);
  const double q = std::sqrt(1.5) * dev.norm(), d = material.growth(q, 3 * G, particle.equivalent);
  if (d > 0) {  // back to the bound
    e -= 1.5 * d / q * dev;
    const Mat3 elastic = of_principal(e, [](double x) { return std::expm1(2 * x); });
    particle.strain = finite ? Mat3(inverse * (elastic - stretch) * inverse.transpose()) : Mat3(small - e);
    particle.equivalent += d;
  }
  answer.plastic_work = (q - 3 * G * d) * d;
  answer.energy = lame / 2 * e.trace() * e.trace() + G * e.squaredNorm();
  answer.stress = (lame * e.trace() * I + 2 * G * e) * inverse.transpose();
  return answer;
}

/// The same without stress across the plane; H(2, 2) is what makes it so.
inline Answer respond_in_plane_stress(const Material& material, Mat3& H, bool finite, Particle& particle) {
  double low = -1e6, high = 1e6;
  for (int k = 0; k < 150; ++k) {  // to 1e-39
    H(2, 2) = (low + high) / 2;
    Particle tried = particle;
    const auto answer = respond(material, H, finite, tried);
    (answer.inverted || answer.stress(2, 2) < 0 ? low : high) = H(2, 2);  // the stress rises with it
  }
  return respond(material, H, finite, particle);
}

/// A bar along an axis: S = E (e - e_p), e of Green at finite strain.
inline Answer respond_along(const Material& material, const Vec3& axis, const Mat3& H, bool finite,
                            Particle& particle) {
  const Vec3 stretch = H * axis, now = axis + (finite ? 1.0 : 0.0) * stretch;
  const double trial = stretch.dot(axis + now) / 2 - particle.strain(0, 0), q = material.E * std::abs(trial);
  const double d = material.growth(q, material.E, particle.equivalent), e = trial - std::copysign(d, trial);
  particle.strain(0, 0) += trial - e;
  particle.equivalent += d;
  return {material.E * e * now * axis.transpose(), material.E * e * e / 2, (q - material.E * d) * d};
}

// --- elements --------------------------------------------------------------------------------------------------------

/// Shape functions N at a place: the polynomials that are 1 at their node and 0 at the others; their gradients by r, s,
/// t.
struct Shape {
  Vec3 at;
  Eigen::VectorXd value;
  Eigen::MatrixX3d gradient;
  double weight = 0;  ///< of a Gauss point
};

/// A Gauss point of a body.
struct Point : Particle {
  double volume;
  Eigen::VectorXd value;      ///< N
  Eigen::MatrixX3d gradient;  ///< of N, by coordinates of the start
  double hoop = 0;            ///< 1 / R of revolution
  Mat3 displacement_gradient(const Field& u) const {
    Mat3 H = u * gradient;
    H(2, 2) += hoop * u.row(0).dot(value);
    return H;
  }
  /// Of the nodes.
  Field forces(const Mat3& stress) const {
    Field forces = stress * gradient.transpose();
    forces.row(0) += stress(2, 2) * hoop * value.transpose();
    return volume * forces;
  }
};

/// The polynomials r^a s^b t^c of an element at a place, and their derivatives by r, s and t.
inline Eigen::Matrix4Xd polynomials(const Field& nodes, const Vec3& at) {
  const bool has_middles = (nodes.array() == 0.5).any();
  Eigen::Array3Xd p = nodes.array() * (has_middles ? 2 : 1);
  const bool is_serendipity = has_middles && (p.cols() == 8 || p.cols() == 20);
  for (Eigen::Index a = 0; a < p.cols() && is_serendipity; ++a)  // one square at most: r s in place of r^2 s^2
    if ((p.col(a) == 2).count() > 1) p.col(a) = (p.col(a) > 0).select(3 - p.col(a), 0);
  const Eigen::Array3Xd places = at.array().replicate(1, p.cols()), power = places.pow(p),
                        slope = p * places.pow((p - 1).max(0));
  Eigen::Matrix4Xd rows(4, p.cols());
  rows << power.colwise().prod(), slope.row(0) * power.row(1) * power.row(2),
      power.row(0) * slope.row(1) * power.row(2), power.row(0) * power.row(1) * slope.row(2);
  return rows;
}

inline Shape shape(const std::string& element, const Vec3& at) {
  const Field& nodes = reference(element).nodes;
  Eigen::MatrixXd at_nodes(nodes.cols(), nodes.cols());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) at_nodes.row(a) = polynomials(nodes, nodes.col(a)).row(0);
  const Eigen::Matrix4Xd N = polynomials(nodes, at) * at_nodes.inverse();
  return {at, N.row(0), N.bottomRows<3>().transpose()};
}

/// Of full rank; of revolution the linear elements need more than one.
inline const std::vector<Shape>& gauss_points(const std::string& element, bool of_revolution = false) {
  static std::map<std::pair<std::string, bool>, std::vector<Shape>> known;
  auto& points = known[{element, of_revolution}];
  if (!points.empty()) return points;
  const auto& [nodes, sides, drawn, weights] = reference(element);
  const Vec3 middle = nodes.rowwise().mean();
  const bool one = !of_revolution && (element == "T3" || element == "L2");  // gradients are constant
  for (Eigen::Index k = 0; k < (one ? 1 : weights.size()); ++k) {
    const bool is_middle = one || (k == nodes.cols() && element != "H20");
    const Field& from = element == "H20" ? reference("H27").nodes : nodes;
    points.push_back(shape(element, is_middle ? middle : Vec3(middle + drawn * (from.col(k) - middle))));
    points.back().weight = one ? weights.sum() : weights[k];
  }
  return points;
}

inline Point point_of(const Scene& scene, const Body& body, const Nodes& element, const Shape& at) {
  const Field X = scene.points(Eigen::all, element);
  Mat3 jacobian = X * at.gradient;
  if (!body.in_space()) jacobian(2, 2) = 1;
  const double radius = X.row(0).dot(at.value);
  return {{},
          jacobian.determinant() * at.weight * scene.depth(body, radius),
          at.value,
          at.gradient * jacobian.inverse(),
          scene.axisymmetric ? 1 / radius : 0};
}

inline std::vector<Point> points_of(const Scene& scene, const Body& body, const Nodes& element) {
  std::vector<Point> points;
  if (body.solid()) {
    for (const auto& at : gauss_points(body.element, scene.axisymmetric))
      points.push_back(point_of(scene, body, element, at));
    return points;
  }
  // along a bar; of a spring the first column of H is u - u_anchor
  const Vec2 difference(-1, 1);
  const Vec3 T = body.spring() ? Vec3(1, 0, 0) : Vec3(scene.points(Eigen::all, element) * difference);
  const double volume = body.spring() ? 1 : body.area() * T.norm();
  return {{{}, volume, Vec2(0.5, 0.5), difference * T.transpose() / T.squaredNorm()}};
}

// --- bodies ----------------------------------------------------------------------------------------------------------

/// What a point of a body answers to H, of which plane stress decides a part.
inline Answer answer_of(const Scene& scene, const Body& body, const Material& material, Mat3& H, Point& point) {
  if (body.spring()) return {body.stiffness() * H, (body.stiffness() * H).cwiseProduct(H).sum() / 2};
  const Vec3 axis = point.gradient.row(1).normalized();
  if (!body.solid()) return respond_along(material, axis, H, scene.finite, point);
  return scene.plane_stress ? respond_in_plane_stress(material, H, scene.finite, point)
                            : respond(material, H, scene.finite, point);
}

/// What bodies do at a motion.
struct Bodies {
  Field forces;                                         ///< f_int of each node
  double largest = 0;                                   ///< force of an element on a node, of all
  double energy = 0, plastic_work = 0;                  ///< stored; of this increment
  double stiffness = 0;                                 ///< force per length: largest modulus times a depth
  bool inverted = false;                                ///< whether an element is
  std::vector<std::vector<std::vector<Point>>> points;  ///< of each body and element

  explicit Bodies(const Scene& scene) {
    for (const auto& body : scene.bodies) {
      const double depth = body.solid() ? scene.depth(body, scene.points.row(0).maxCoeff()) : body.area();
      stiffness = std::max(stiffness, body.spring() ? body.stiffness().maxCoeff() : Material(body).E * depth);
      auto& of = points.emplace_back();
      for (const auto& element : body.elements) of.push_back(points_of(scene, body, element));
    }
  }

  /// To displacements u, from what they were at the end of the last increment.
  void deform(const Scene& scene, const Field& u) {
    forces = Field::Zero(3, u.cols());
    largest = energy = plastic_work = inverted = 0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const Body& body = scene.bodies[b];
      const Material material(body);
      for (std::size_t e = 0; e < body.elements.size(); ++e) {
        const Nodes& element = body.elements[e];
        const auto of = element_forces(scene, body, material, u(Eigen::all, element), points[b][e]);
        forces(Eigen::all, element) += of;
        largest = std::max(largest, of.colwise().norm().maxCoeff());
      }
    }
  }

 private:
  /// Forces of an element on its nodes.
  Field element_forces(const Scene& scene, const Body& body, const Material& material, const Field& u,
                       std::vector<Point>& points) {
    const bool finite = scene.finite, mean = body.averages();
    const Mat3 I = Mat3::Identity();
    const auto change = [&](const Mat3& H) { return finite ? volume_change(H) : H.trace(); };
    double whole = 0, theta = 0;  // volume, and mean of J - 1 or tr H
    for (const auto& point : points) {
      whole += point.volume;
      theta += point.volume * change(point.displacement_gradient(u));
    }
    theta /= whole;
    Field all = Field::Zero(3, u.cols()), varied = all;  // varied: d theta / du
    double pressure = 0;                                 // int tr tau / 3 dV
    for (auto& point : points) {
      const Mat3 H = point.displacement_gradient(u), F = finite ? Mat3(I + H) : I;
      Mat3 h = H;
      if (mean)
        h += (finite ? std::expm1((std::log1p(theta) - std::log1p(change(H))) / 3) : (theta - change(H)) / 3) * F;
      const auto answer = answer_of(scene, body, material, h, point);
      inverted |= answer.inverted;
      energy += answer.energy * point.volume;
      plastic_work += answer.plastic_work * point.volume;
      Mat3 stress = answer.stress;
      if (mean) {
        const Mat3 tau = finite ? Mat3(stress * (I + h).transpose()) : stress, back = F.inverse().transpose();
        stress = (tau - tau.trace() / 3 * I) * back;
        pressure += tau.trace() / 3 * point.volume;
        varied += point.forces((finite ? (1 + change(H)) / (1 + theta) : 1) / whole * back);
      }
      all += point.forces(stress);
    }
    return all + pressure * varied;
  }
};

// --- loads -----------------------------------------------------------------------------------------------------------

/// Points of a side of an element by its number of nodes, exact for what a face has.
inline const std::vector<Shape>& side_points(bool in_space, std::size_t nodes, bool of_revolution) {
  if (!in_space) return gauss_points(nodes == 3 ? "L3" : "L2", of_revolution);
  if (nodes != 6) return gauss_points(nodes == 3 ? "T3" : nodes == 4 ? "Q4" : nodes == 8 ? "Q8" : "Q9");
  static const std::vector<Shape> triangle = [] {  // those of a square, one of whose sides is drawn into a corner
    std::vector<Shape> points;
    for (const auto& of_square : gauss_points("Q8")) {
      const double r = of_square.at[0], s = of_square.at[1];
      points.push_back(shape("T6", Vec3(r, s * (1 - r), 0)));
      points.back().weight = of_square.weight * (1 - r);
    }
    return points;
  }();
  return triangle;
}

/// Integrates over a side, of edges or faces at `places`: adds up, at each of its nodes, a weight times N, and the
/// vector area out of the body that it stands for; of an edge, at a place of it.
template <class F>
void over_side(const Scene& scene, const Body& body, const Side& side, const Field& places, F&& add) {
  for (const auto& edge : side.edges) {
    const Field at = places(Eigen::all, edge);
    for (const auto& point : side_points(body.in_space(), edge.size(), scene.axisymmetric)) {
      const Vec3 tau = at * point.gradient.col(0), across = at * point.gradient.col(1);
      const Vec3 outward = body.in_space() ? tau.cross(across) : Vec3(tau[1], -tau[0], tau[2]);
      const double width = point.weight * scene.depth(body, at.row(0).dot(point.value));
      for (std::size_t a = 0; a < edge.size(); ++a)
        if (side.has(edge[a]))  // (of a bar the length alone has a meaning)
          add(edge[a], width * point.value[a], outward, edge, point.at[0]);
    }
  }
}

/// Present stretch of the thickness at a place of an edge, of rubber in plane stress: F_33 of the element behind.
inline double thickness_stretch(const Scene& scene, const Body& body, const Nodes& edge, double s, const Field& u) {
  const Nodes& element = *std::ranges::find_if(body.elements, [&](const Nodes& nodes) {
    return std::ranges::count(nodes, edge[0]) + std::ranges::count(nodes, edge[1]) == 2;
  });
  const auto corner = [&](int node) -> Vec3 {
    return reference(body.element).nodes.col(std::ranges::find(element, node) - element.begin());
  };
  Point point = point_of(scene, body, element, shape(body.element, (1 - s) * corner(edge[0]) + s * corner(edge[1])));
  Mat3 H = point.displacement_gradient(u(Eigen::all, element));
  answer_of(scene, body, Material(body), H, point);
  return 1 + H(2, 2);
}

/// The factor of a load: its history, which along a path by arc length goes on straight, in proportion to the time.
inline double factor_of(const Scene& scene, std::size_t index, const Json& load, double time) {
  const Json& when = scene.json.at("time");
  const double end = when.value("end", 0.0);
  const std::size_t driven = part(part(when, "control"), "arc_length").value("load", std::size_t{0});
  const bool along_path = when.contains("control") && index == driven;
  const double factor = load.contains("history") ? value_at(load["history"], along_path ? end : time) : 1;
  return along_path ? factor * time / end : factor;
}

/// Areas of the start that belong to the nodes of a side: int N dA; 1 of each where it has no edges.
inline std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side) {
  std::map<int, double> areas;
  over_side(scene, body, side, scene.points,
            [&](int node, double share, const Vec3& outward, auto&&...) { areas[node] += share * outward.norm(); });
  for (const int node : side.nodes)
    if (side.edges.empty()) areas[node] = 1;
  return areas;
}

/// Nodal forces of the loads at a time. A pressure follows its side at finite strain.
inline Field load_forces(const Scene& scene, const Field& u, double time) {
  Field forces = Field::Zero(3, u.cols());
  const Json& loads = part(scene.json, "loads");
  for (std::size_t k = 0; k < loads.size(); ++k) {
    const Json& load = loads[k];
    const double factor = factor_of(scene, k, load, time);
    const Body& body = scene.body(load.at("on"));
    const Side side = scene.side(load["on"]);
    if (load.contains("body_force")) {
      for (const auto& element : body.elements)
        for (const auto& point : points_of(scene, body, element))
          forces(Eigen::all, element) += point.volume * factor * vec3(load["body_force"]) * point.value.transpose();
    } else if (load.contains("pressure")) {  // int p N n da, n into the body: at finite strain of the present edges
      const double p = factor * load["pressure"].get<double>();
      const bool thins = scene.finite && scene.plane_stress;
      over_side(scene, body, side, scene.places(u),
                [&](int node, double share, const Vec3& outward, const Nodes& edge, double s) {
                  const double stretch = thins ? thickness_stretch(scene, body, edge, s, u) : 1;
                  forces.col(node) -= p * stretch * share * outward;
                });
    } else {  // a traction by the areas of the nodes, or a force in all that they share by these
      const auto areas = areas_of(scene, body, side);
      double all = 0;
      for (const auto& [node, area] : areas) all += area;
      const Vec3 f = factor * (load.contains("force") ? vec3(load["force"]) / all : vec3(load.at("traction")));
      for (const auto& [node, area] : areas) forces.col(node) += area * f;
    }
  }
  return forces;
}

}  // namespace stickslip::verify
