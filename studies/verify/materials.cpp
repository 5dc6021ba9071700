#include "studies/verify/materials.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace stickslip::verify {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A function of a symmetric tensor, by its principal values.
template <class F>
Mat3 of_principal(const Mat3& tensor, F&& f) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen((tensor + tensor.transpose()) / 2);
  return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(f).asDiagonal() * eigen.eigenvectors().transpose();
}

/// Takes a trial elastic strain back to the bound; returns the plastic work. The same in logarithms.
double return_to_bound(const Material& material, Mat3& e, Memory& memory) {
  const Mat3 dev = 2 * material.G * (e - e.trace() / 3 * Mat3::Identity());
  const double q = std::sqrt(1.5) * dev.norm(), d = material.growth(q, 3 * material.G, memory.equivalent);
  if (d == 0) return 0;
  e -= 1.5 * d / q * dev;
  memory.equivalent += d;
  return (q - 3 * material.G * d) * d;
}

/// Hooke's law; adds the energy.
Mat3 hooke(const Material& material, const Mat3& e, Answer& answer) {
  answer.energy = material.lame / 2 * e.trace() * e.trace() + material.G * e.squaredNorm();
  return material.lame * e.trace() * Mat3::Identity() + 2 * material.G * e;
}

/// `stretch`: F F^T - I.
Mat3 neo_hookean(const Material& material, const Mat3& H, const Mat3& stretch, Answer& answer) {
  const double change = volume_change(H), log = std::log1p(change), lame = material.lame;
  answer.energy = lame / 2 * (material.log_volume ? log * log : change * change) +
                  material.G * (H.trace() + H.squaredNorm() / 2 - log);
  const double pressure = lame * (material.log_volume ? log : change * (1 + change));
  return material.G * stretch + pressure * Mat3::Identity();
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
  if (hardening.is_number())
    slope_ = hardening;
  else
    rows_ = hardening.get<std::vector<std::array<double, 2>>>();
  if (rows_.empty() || rows_[0][0] > 0) rows_.insert(rows_.begin(), {0, given.at("yield").get<double>()});
}

double Material::bound(double a) const {
  for (std::size_t k = 1; k < rows_.size(); ++k) {
    const auto& [from, low] = rows_[k - 1];
    const auto& [to, high] = rows_[k];
    if (a < to) return low + (a - from) / (to - from) * (high - low);
  }
  return rows_.back()[1] + slope_ * (a - rows_.back()[0]);
}

double Material::growth(double q, double modulus, double a) const {
  if (!(q > bound(a))) return 0;
  double from = a, to = infinity;  // the piece of the table on which the excess, straight on each, ends
  for (const auto& [at, limit] : rows_)
    if (at > from && q - modulus * (at - a) > limit) from = at;
  for (const auto& [at, limit] : rows_)
    if (at > from) to = std::min(to, at);
  const double rise = to < infinity ? (bound(to) - bound(from)) / (to - from) : slope_;
  return from - a + (q - modulus * (from - a) - bound(from)) / (modulus + rise);
}

double volume_change(const Mat3& H) {
  return H.trace() + (H.trace() * H.trace() - (H * H).trace()) / 2 + H.determinant();
}

Answer respond(const Material& material, const Mat3& H, bool finite, Memory& memory) {
  Answer answer;
  if (!finite) {
    const Mat3 trial = (H + H.transpose()) / 2 - memory.strain;
    Mat3 e = trial;
    if (material.plastic) answer.plastic_work = return_to_bound(material, e, memory);
    memory.strain += trial - e;
    answer.stress = hooke(material, e, answer);
    return answer;
  }
  answer.inverted = !(volume_change(H) > -1);
  if (answer.inverted) return answer;
  const Mat3 F = Mat3::Identity() + H, inverse = F.inverse(), stretch = H + H.transpose() + H * H.transpose();
  if (!material.plastic) {
    answer.stress = neo_hookean(material, H, stretch, answer) * inverse.transpose();
    return answer;
  }
  const Mat3 trial = stretch + F * memory.strain * F.transpose();  // F C_p^-1 F^T - I
  Mat3 e = of_principal(trial, [](double x) { return std::log1p(x) / 2; });
  answer.plastic_work = return_to_bound(material, e, memory);
  if (answer.plastic_work > 0) {
    const Mat3 left = of_principal(e, [](double x) { return std::expm1(2 * x); });
    memory.strain = inverse * (left - stretch) * inverse.transpose();
  }
  answer.stress = hooke(material, e, answer) * inverse.transpose();
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
