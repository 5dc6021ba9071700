#include "studies/verify/materials.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace stickslip::verify {
namespace {

/// A function of a symmetric tensor, by its principal values.
template <class F>
Mat3 of_principal(const Mat3& tensor, F&& f) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen((tensor + tensor.transpose()) / 2);
  return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(f).asDiagonal() * eigen.eigenvectors().transpose();
}

/// Kirchhoff stress, and energy, of an elastic strain e; of metal it is taken back to the bound first.
Mat3 hooke(const Material& material, Mat3& e, Memory& memory, Answer& answer) {
  const Mat3 I = Mat3::Identity(), dev = 2 * material.G * (e - e.trace() / 3 * I);
  const double q = std::sqrt(1.5) * dev.norm();
  const double d = material.plastic ? material.growth(q, 3 * material.G, memory.equivalent) : 0;
  if (d > 0) e -= 1.5 * d / q * dev;
  memory.equivalent += d;
  answer.plastic_work = (q - 3 * material.G * d) * d;
  answer.energy = material.lame / 2 * e.trace() * e.trace() + material.G * e.squaredNorm();
  return material.lame * e.trace() * I + 2 * material.G * e;
}

/// `stretch`: F F^T - I.
Mat3 neo_hooke(const Material& material, const Mat3& H, const Mat3& stretch, Answer& answer) {
  const double change = volume_change(H), log = std::log1p(change), lame = material.lame;
  const double volume = material.log_volume ? log * log : change * change;
  answer.energy = lame / 2 * volume + material.G * (H.trace() + H.squaredNorm() / 2 - log);
  return material.G * stretch + lame * (material.log_volume ? log : change * (1 + change)) * Mat3::Identity();
}

}  // namespace

Material::Material(const Json& json) {
  const Json& given = json.begin().value();
  E = given.at("E");
  const double nu = given.at("nu");
  lame = E * nu / ((1 + nu) * (1 - 2 * nu));
  G = E / (2 * (1 + nu));
  log_volume = given.value("volumetric", "quadratic") == "log";
  plastic = json.begin().key() == "j2_plastic";
  if (!plastic) return;
  const Json& hardening = given.at("hardening");
  if (hardening.is_array()) rows = hardening.get<std::vector<std::array<double, 2>>>();
  if (rows.empty() || rows[0][0] > 0) rows.insert(rows.begin(), {0, given.at("yield").get<double>()});
  constexpr double far = 1e6;  // as good as infinity for a strain
  rows.push_back({far, rows.back()[1] + (hardening.is_number() ? hardening.get<double>() : 0) * far});
}

double Material::growth(double q, double modulus, double a) const {
  for (std::size_t k = 1; k < rows.size(); ++k) {  // piece by piece, on each of which the bound is straight
    const auto [from, low] = rows[k - 1];
    const auto [to, high] = rows[k];
    const double slope = (high - low) / (to - from), d = (q - low - slope * (a - from)) / (modulus + slope);
    if (a < to && (d <= 0 || a + d <= to)) return std::max(d, 0.0);
  }
  return 0;
}

double volume_change(const Mat3& H) {
  return H.trace() + (H.trace() * H.trace() - (H * H).trace()) / 2 + H.determinant();
}

Answer respond(const Material& material, const Mat3& H, bool finite, Memory& memory) {
  Answer answer;
  if (!finite) {
    const Mat3 trial = (H + H.transpose()) / 2 - memory.strain;
    Mat3 e = trial;
    answer.stress = hooke(material, e, memory, answer);
    memory.strain += trial - e;
    return answer;
  }
  answer.inverted = !(volume_change(H) > -1);
  if (answer.inverted) return answer;
  const Mat3 F = Mat3::Identity() + H, inverse = F.inverse(), stretch = H + H.transpose() + H * H.transpose();
  if (!material.plastic) {
    answer.stress = neo_hooke(material, H, stretch, answer) * inverse.transpose();
    return answer;
  }
  const Mat3 trial = stretch + F * memory.strain * F.transpose();  // F C_p^-1 F^T - I
  Mat3 e = of_principal(trial, [](double x) { return std::log1p(x) / 2; });
  answer.stress = hooke(material, e, memory, answer) * inverse.transpose();
  if (answer.plastic_work > 0)
    memory.strain =
        inverse * (of_principal(e, [](double x) { return std::expm1(2 * x); }) - stretch) * inverse.transpose();
  return answer;
}

Answer respond_in_plane_stress(const Material& material, Mat3& H, bool finite, Memory& memory) {
  const auto across = [&](double h) {  // rises with h
    Memory tried = memory;
    H(2, 2) = h;
    const auto answer = respond(material, H, finite, tried);
    return answer.inverted ? -infinity : answer.stress(2, 2);
  };
  const double guess = -material.lame / (material.lame + 2 * material.G) * (H(0, 0) + H(1, 1));
  double span = std::max({H.topLeftCorner<2, 2>().norm(), memory.equivalent, 1e-12}) / 2;
  double low = guess - span, high = guess + span, below = across(low), above = across(high);
  for (; below > 0 && span < 1e9; below = across(low)) low -= span *= 2;
  for (; above < 0 && span < 1e9; above = across(high)) high += span *= 2;
  for (int k = 0; k < 200 && below != 0 && above != 0; ++k) {  // false position, each third time bisection
    double h = low - (high - low) * (k % 3 < 2 && below > -infinity ? below / (above - below) : -0.5);
    if (!(h > low && h < high)) h = low + (high - low) / 2;
    if (!(h > low && h < high)) break;
    const double value = across(h);
    (value < 0 ? low : high) = h;
    (value < 0 ? below : above) = value;
  }
  H(2, 2) = std::abs(below) < std::abs(above) ? low : high;
  return respond(material, H, finite, memory);
}

}  // namespace stickslip::verify
