#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "studies/verify/state.hpp"

namespace stickslip::verify {
namespace {

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
double volume_change(const Mat3& H) {
  return H.trace() + (H.trace() * H.trace() - (H * H).trace()) / 2 + H.determinant();
}

/// A function of a symmetric tensor, by its principal values.
template <class F>
Mat3 of_principal(const Mat3& tensor, F&& f) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen((tensor + tensor.transpose()) / 2);
  return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(f).asDiagonal() * eigen.eigenvectors().transpose();
}

Answer respond(const Material& material, const Mat3& H, bool finite, Particle& particle) {
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
Answer respond_in_plane_stress(const Material& material, Mat3& H, bool finite, Particle& particle) {
  const auto across = [&](double h) {  // rises with h
    Particle tried = particle;
    H(2, 2) = h;
    const auto answer = respond(material, H, finite, tried);
    return answer.inverted ? -infinity : answer.stress(2, 2);
  };
  double low = -1e6, high = 1e6;
  for (int k = 0; k < 150; ++k) {  // to 1e-39
    const double middle = (low + high) / 2;
    (across(middle) < 0 ? low : high) = middle;
  }
  return respond(material, H, finite, particle);
}

/// A bar along an axis: S = E (e - e_p), e of Green at finite strain.
Answer respond_along(const Material& material, const Vec3& axis, const Mat3& H, bool finite, Particle& particle) {
  const Vec3 stretch = H * axis, now = axis + (finite ? 1.0 : 0.0) * stretch;
  const double trial = stretch.dot(axis + now) / 2 - particle.strain(0, 0), q = material.E * std::abs(trial);
  const double d = material.growth(q, material.E, particle.equivalent), e = trial - std::copysign(d, trial);
  particle.strain(0, 0) += trial - e;
  particle.equivalent += d;
  return {material.E * e * now * axis.transpose(), material.E * e * e / 2, (q - material.E * d) * d};
}

// --- elements --------------------------------------------------------------------------------------------------------

/// The polynomials r^a s^b t^c of an element at a place, and their derivatives by r, s and t.
Eigen::Matrix4Xd polynomials(const Body& body, const Vec3& at) {
  static const Field triangle{{0, 1, 0, 2, 1, 0}, {0, 0, 1, 0, 1, 2}, {0, 0, 0, 0, 0, 0}},
      square{{0, 1, 0, 1, 2, 0, 2, 1}, {0, 0, 1, 1, 0, 2, 1, 2}, {0, 0, 0, 0, 0, 0, 0, 0}},
      tetrahedron{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
      cube{{0, 1, 0, 1, 0, 1, 0, 1}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}};
  const Field& all =
      body.in_space() ? (body.element == "T4" ? tetrahedron : cube) : (body.corners() == 3 ? triangle : square);
  const Eigen::Array3Xd p = all.leftCols(natural_nodes(body).cols());
  const Eigen::Array3Xd power = at.array().replicate(1, p.cols()).pow(p),
                        slope = p * at.array().replicate(1, p.cols()).pow((p - 1).max(0));
  Eigen::Matrix4Xd rows(4, p.cols());
  rows << power.row(0) * power.row(1) * power.row(2), slope.row(0) * power.row(1) * power.row(2),
      power.row(0) * slope.row(1) * power.row(2), power.row(0) * power.row(1) * slope.row(2);
  return rows;
}

/// r, s, t, and a weight.
using Gauss = std::pair<Vec3, double>;

/// Rules of full rank: three points of Q8 each way, three of T3 of revolution.
std::vector<Gauss> rule(const Body& body, bool of_revolution) {
  if (body.element == "T3" && !of_revolution) return {{{1.0 / 3, 1.0 / 3, 0}, 0.5}};
  if (body.element == "T4") return {{{0.25, 0.25, 0.25}, 1.0 / 6}};
  if (body.corners() == 3) {
    const double sixth = 1.0 / 6;
    return {{{sixth, sixth, 0}, sixth}, {{4 * sixth, sixth, 0}, sixth}, {{sixth, 4 * sixth, 0}, sixth}};
  }
  std::vector<Gauss> points{{Vec3::Zero(), 1}};
  for (int axis = 0; axis < (body.in_space() ? 3 : 2); ++axis) {
    std::vector<Gauss> longer;
    for (const auto& [place, weight] : points)
      for (const auto& along : edge_points(body.quadratic() ? 3 : 2, true))
        longer.emplace_back(place + (2 * along.s - 1) * Vec3::Unit(axis), weight * 2 * along.weight);
    points = std::move(longer);
  }
  return points;
}

/// A Gauss point of an element, with gradients by coordinates of the start, and N / R of revolution.
struct Point {
  double volume;
  Eigen::VectorXd value, hoop = {};
  Eigen::MatrixX3d gradient = {};

  Mat3 displacement_gradient(const Field& u) const {
    return u * gradient + u.row(0).dot(hoop) * Vec3::UnitZ() * Vec3::UnitZ().transpose();
  }
  Field forces(const Mat3& stress) const {
    return volume * (stress * gradient.transpose() + stress(2, 2) * Vec3::UnitX() * hoop.transpose());
  }
};

Point point_of(const Scene& scene, const Body& body, const Nodes& element, const Shape& at, double weight = 0) {
  const Field X = scene.points(Eigen::all, element);
  Mat3 jacobian = X * at.gradient;
  if (!body.in_space()) jacobian(2, 2) = 1;
  const double radius = X.row(0).dot(at.value);
  Point point{jacobian.determinant() * weight * scene.depth(body, radius), at.value};
  point.hoop = (scene.axisymmetric ? 1 / radius : 0) * at.value;
  point.gradient = at.gradient * jacobian.inverse();
  return point;
}

std::vector<Point> points_of(const Scene& scene, const Body& body, const Nodes& element) {
  if (!body.solid()) {  // along a bar; of a spring the first column of H is u - u_anchor
    const Vec2 difference(-1, 1);
    const Vec3 T = body.spring() ? Vec3(1, 0, 0) : Vec3(scene.points(Eigen::all, element) * difference);
    const double volume = body.spring() ? 1 : body.area() * T.norm();
    return {{volume, Vec2(0.5, 0.5), Vec2(0, 0), difference * T.transpose() / T.squaredNorm()}};
  }
  static std::map<std::pair<std::string, bool>, std::vector<std::pair<Shape, double>>> known;
  auto& shapes = known[{body.element, scene.axisymmetric}];
  if (shapes.empty())
    for (const auto& at : rule(body, scene.axisymmetric)) shapes.emplace_back(shape(body, at.first), at.second);
  std::vector<Point> points;
  for (const auto& [at, weight] : shapes) points.push_back(point_of(scene, body, element, at, weight));
  return points;
}

// --- bodies ----------------------------------------------------------------------------------------------------------

/// What a point of a body answers to H, of which plane stress decides a part.
Answer answer_of(const Scene& scene, const Body& body, const Material& material, const Point& point, Mat3& H,
                 Particle& particle) {
  if (body.spring()) return {body.stiffness() * H, (body.stiffness() * H).cwiseProduct(H).sum() / 2};
  const Vec3 axis = point.gradient.row(1).normalized();
  if (!body.solid()) return respond_along(material, axis, H, scene.finite, particle);
  return scene.plane_stress ? respond_in_plane_stress(material, H, scene.finite, particle)
                            : respond(material, H, scene.finite, particle);
}

/// Forces of an element on its nodes.
Field element_forces(const Scene& scene, const Body& body, const Material& material, const std::vector<Point>& points,
                     const Field& u, std::vector<Particle>& particles, Bodies& bodies) {
  const bool finite = scene.finite, mean = body.averages();
  const Mat3 I = Mat3::Identity();
  const auto change = [&](const Mat3& H) { return finite ? volume_change(H) : H.trace(); };
  double whole = 0, theta = 0;  // volume, and mean of J - 1 or tr H
  for (const auto& point : points) {
    whole += point.volume;
    theta += point.volume * change(point.displacement_gradient(u));
  }
  theta /= whole;
  Field forces = Field::Zero(3, u.cols()), varied = forces;  // varied: d theta / du
  double pressure = 0;                                       // int tr tau / 3 dV
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Mat3 H = points[q].displacement_gradient(u), F = finite ? Mat3(I + H) : I;
    Mat3 h = H;
    if (mean) h += (finite ? std::expm1((std::log1p(theta) - std::log1p(change(H))) / 3) : (theta - change(H)) / 3) * F;
    const auto answer = answer_of(scene, body, material, points[q], h, particles[q]);
    const double volume = particles[q].volume = points[q].volume;
    bodies.inverted |= answer.inverted;
    bodies.energy += answer.energy * volume;
    bodies.plastic_work += answer.plastic_work * volume;
    Mat3 stress = answer.stress;
    if (mean) {
      const Mat3 tau = finite ? Mat3(stress * (I + h).transpose()) : stress, back = F.inverse().transpose();
      stress = (tau - tau.trace() / 3 * I) * back;
      pressure += tau.trace() / 3 * volume;
      varied += points[q].forces((finite ? (1 + change(H)) / (1 + theta) : 1) / whole * back);
    }
    forces += points[q].forces(stress);
  }
  return forces + pressure * varied;
}

// --- loads -----------------------------------------------------------------------------------------------------------

/// Integrates over a face of three or four nodes at `places`: as over_side().
template <class F>
void over_face(const Side& side, const Nodes& face, const Field& places, F&& add) {
  const Body as{"", face.size() == 3 ? "T3" : "Q4", {}, {}, {}};  // a face is an element of a surface
  const Field at = places(Eigen::all, face);
  for (const auto& [place, weight] : rule(as, false)) {
    const Shape N = shape(as, place);
    const Vec3 outward = (at * N.gradient.col(0)).cross(at * N.gradient.col(1));
    for (std::size_t a = 0; a < face.size(); ++a)
      if (side.has(face[a])) add(face[a], weight * N.value[a], outward, face, 0.0);
  }
}

/// Integrates over a side, of edges or faces at `places`: adds up, at each of its nodes, a weight times N, and the vector
/// area out of the body that it stands for; of an edge, at a place of it.
template <class F>
void over_side(const Scene& scene, const Body& body, const Side& side, const Field& places, F&& add) {
  if (body.in_space()) {
    for (const auto& face : side.edges) over_face(side, face, places, add);
    return;
  }
  for (const auto& edge : side.edges)
    for (const auto& point : edge_points(edge.size(), scene.axisymmetric)) {
      const Field at = places(Eigen::all, edge);
      const Vec3 tau = at * point.slope;
      const double width = point.weight * scene.depth(body, at.row(0).dot(point.value));
      for (std::size_t a = 0; a < edge.size(); ++a)
        if (side.has(edge[a]))  // (of a bar the length alone has a meaning)
          add(edge[a], width * point.value[a], Vec3(tau[1], -tau[0], tau[2]), edge, point.s);
    }
}

/// Present stretch of the thickness at a place of an edge, of rubber in plane stress: F_33 of the element behind.
double thickness_stretch(const Scene& scene, const Body& body, const Nodes& edge, double s, const Field& u) {
  const Nodes& element = *std::ranges::find_if(body.elements, [&](const Nodes& nodes) {
    return std::ranges::count(nodes, edge[0]) + std::ranges::count(nodes, edge[1]) == 2;
  });
  const auto corner = [&](int node) -> Vec3 {
    return natural_nodes(body).col(std::ranges::find(element, node) - element.begin());
  };
  const Shape at = shape(body, (1 - s) * corner(edge[0]) + s * corner(edge[1]));
  const Point point = point_of(scene, body, element, at);
  Mat3 H = point.displacement_gradient(u(Eigen::all, element));
  Particle none;
  answer_of(scene, body, Material(body), point, H, none);
  return 1 + H(2, 2);
}

/// The factor of a load: its history, which along a path by arc length goes on straight, in proportion to the time.
double factor_of(const Scene& scene, std::size_t index, const Json& load, double time) {
  const Json& when = scene.json.at("time");
  const double end = when.value("end", 0.0);
  const std::size_t driven = part(part(when, "control"), "arc_length").value("load", std::size_t{0});
  const bool along_path = when.contains("control") && index == driven;
  const double factor = load.contains("history") ? value_at(load["history"], along_path ? end : time) : 1;
  return along_path ? factor * time / end : factor;
}

}  // namespace

Field natural_nodes(const Body& body) {
  static const Field triangle{{0, 1, 0, 0.5, 0.5, 0}, {0, 0, 1, 0, 0.5, 0.5}, {0, 0, 0, 0, 0, 0}},
      square{{-1, 1, 1, -1, 0, 1, 0, -1}, {-1, -1, 1, 1, -1, 0, 1, 0}, {0, 0, 0, 0, 0, 0, 0, 0}},
      tetrahedron{{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}},
      cube{{-1, 1, 1, -1, -1, 1, 1, -1}, {-1, -1, 1, 1, -1, -1, 1, 1}, {-1, -1, -1, -1, 1, 1, 1, 1}};
  if (body.in_space()) return body.element == "T4" ? tetrahedron : cube;
  const auto nodes = static_cast<Eigen::Index>(body.corners() * (body.quadratic() ? 2 : 1));
  return (body.corners() == 3 ? triangle : square).leftCols(nodes);
}

Shape shape(const Body& body, const Vec3& at) {
  const Field nodes = natural_nodes(body);
  Eigen::MatrixXd at_nodes(nodes.cols(), nodes.cols());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) at_nodes.row(a) = polynomials(body, nodes.col(a)).row(0);
  const Eigen::Matrix4Xd N = polynomials(body, at) * at_nodes.inverse();
  return {N.row(0), N.bottomRows<3>().transpose()};
}

std::vector<EdgePoint> edge_points(std::size_t nodes, bool of_revolution) {
  const auto at = [&](double s, double weight) -> EdgePoint {
    if (nodes == 2) return {weight, s, Vec2(1 - s, s), Vec2(-1, 1)};
    return {weight, s, Vec3((1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)),
            Vec3(4 * s - 3, 4 * s - 1, 4 - 8 * s)};
  };
  const double two = std::sqrt(3.0) / 6, three = std::sqrt(0.6) / 2;
  if (nodes == 3) return {at(0.5 - three, 5.0 / 18), at(0.5, 8.0 / 18), at(0.5 + three, 5.0 / 18)};
  if (of_revolution) return {at(0.5 - two, 0.5), at(0.5 + two, 0.5)};
  return {at(0.5, 1)};
}

std::map<int, double> areas_of(const Scene& scene, const Body& body, const Side& side) {
  std::map<int, double> areas;
  over_side(scene, body, side, scene.points,
            [&](int node, double share, const Vec3& outward, auto&&...) { areas[node] += share * outward.norm(); });
  for (const int node : side.nodes)
    if (side.edges.empty()) areas[node] = 1;
  return areas;
}

Bodies deform(const Scene& scene, const Field& u, const Bodies& before) {
  Bodies bodies;
  bodies.forces = Field::Zero(3, u.cols());
  bodies.particles = before.particles;
  bodies.particles.resize(scene.bodies.size());
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    const Material material(body);
    const double depth = body.solid() ? scene.depth(body, scene.points.row(0).maxCoeff()) : body.area();
    const double stiffness = body.spring() ? body.stiffness().maxCoeff() : material.E * depth;
    bodies.stiffness = std::max(bodies.stiffness, stiffness);
    bodies.particles[b].resize(body.elements.size());
    for (std::size_t e = 0; e < body.elements.size(); ++e) {
      const Nodes& element = body.elements[e];
      const auto points = points_of(scene, body, element);
      bodies.particles[b][e].resize(points.size());
      const auto forces =
          element_forces(scene, body, material, points, u(Eigen::all, element), bodies.particles[b][e], bodies);
      bodies.forces(Eigen::all, element) += forces;
      bodies.largest = std::max(bodies.largest, forces.colwise().norm().maxCoeff());
    }
  }
  return bodies;
}

Field load_forces(const Scene& scene, const Field& u, double time) {
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
