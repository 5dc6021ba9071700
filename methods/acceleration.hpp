/// Acceleration of a fixed point iteration x <- f(x) from the values it has produced, and its contraction.
///
///   r = f(x) - x
///   Aitken     x <- x + w r,  w <- -w r_last . (r - r_last) / |r - r_last|^2, kept in [0.1, 10]
///   Anderson   x <- f(x) - sum gamma_i (f_i+1 - f_i),  gamma: least squares of r - sum gamma_i (r_i+1 - r_i)  over the
///              last m = 5 differences; QR, the oldest dropped while the condition of the scaled columns is above 1e8,
///              or while one is rounding
///
/// Weights are numbers of the iteration, not of the scene: they are formed from the primal parts and not
/// differentiated, and the fixed point does not depend on them. An extrapolated x is on trial. It is refused where its
/// residual is not below 0.9 of the last one; where the contraction q is slower than 0.9, not below q of it. Then the
/// plain step from the last x that was not refused takes its place. A refusal costs one evaluation. Two are free; each
/// further one must be earned, by an extrapolation worth two plain steps. So an iteration is never much worse than a
/// plain one. [IT69], [WN11]
#pragma once

#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/model/engine.hpp"
#include "methods/options.hpp"

namespace stickslip {

/// Differences of two arguments of one map, and of their images.
struct Secant {
  Vector<double> argument, image;
  double noise = 0;  ///< of the image, over the length of the argument
};

/// Contraction of a linear map A from some of its secants, in the order in which they were met: the spectral radius of
/// A on the space of their arguments (Arnoldi, where they are successive). Each secant counts by the part of its
/// argument that is new beside those before. It is left out where more than 2 % of the image of that part may be noise.
/// Where fewer than two are left, the result is the ratio of the lengths of the last secant. pre: no argument is zero.
double contraction(const std::vector<Secant>& secants);

/// Anderson's gamma: one weight a difference of successive residuals, the oldest first; zero for differences that are
/// left out. `noise`: a length up to this is rounding.
Vector<double> anderson_weights(const Matrix<double>& differences, const Vector<double>& residual, double noise);

/// What the next argument of an accelerated iteration is made from: the last evaluations of one map.
template <class T>
class Accelerator {
 public:
  explicit Accelerator(UzawaAL::Acceleration kind) : kind_(kind) {}

  /// The next x after f(x) = image. `same_map`: f is what it was at the last call (otherwise the past is forgotten).
  /// `contraction` of the plain iteration as known so far (0: unknown). `admissible(x)` puts an extrapolated x back
  /// into the set that images lie in.
  template <class Admissible>
  Vector<T> next(const Vector<T>& x, const Vector<T>& image, bool same_map, double contraction,
                 Admissible&& admissible) {
    if (kind_ == UzawaAL::Acceleration::none) return image;
    const double residual = values(image - x).norm();
    const double allowed = contraction < 1 ? std::max(0.9, contraction) : 0.9;
    if (on_trial_ && !(residual < allowed * last_residual_)) {
      on_trial_ = false;
      past_.clear();
      --credit_;
      return plain_;
    }
    if (on_trial_ && residual < contraction * contraction * last_residual_) ++credit_;
    if (!same_map) past_.clear();
    past_.push_back({x, image});
    if (past_.size() > kept + 1) past_.erase(past_.begin());
    last_residual_ = residual;
    plain_ = image;
    on_trial_ = past_.size() > 1 && credit_ > 0 && residual > 0;
    if (past_.size() == 1) weight_ = 1;
    if (!on_trial_) return image;
    return admissible(kind_ == UzawaAL::Acceleration::aitken ? aitken() : anderson());
  }

 private:
  static constexpr std::size_t kept = 5;
  struct Evaluation {
    Vector<T> x, image;
    Vector<double> residual() const { return values(image - x); }
  };

  Vector<T> aitken() {
    const auto &now = past_[past_.size() - 1], &last = past_[past_.size() - 2];
    const Vector<double> before = last.residual(), change = now.residual() - before;
    if (change.squaredNorm() > 0) weight_ *= -before.dot(change) / change.squaredNorm();
    weight_ = std::min(std::max(weight_, 0.1), 10.0);
    return now.x + T(weight_) * (now.image - now.x);
  }

  Vector<T> anderson() {
    const Vector<double> residual = past_.back().residual();
    Matrix<double> differences(residual.size(), past_.size() - 1);
    for (Eigen::Index i = 0; i < differences.cols(); ++i)
      differences.col(i) = past_[i + 1].residual() - past_[i].residual();
    Vector<T> x = past_.back().image;
    const double noise = 1e2 * unit_roundoff * values(x).norm();  // of a difference of residuals, and more
    const Vector<double> gamma = anderson_weights(differences, residual, noise);
    for (Eigen::Index i = 0; i < gamma.size(); ++i)
      if (gamma[i] != 0) x -= T(gamma[i]) * (past_[i + 1].image - past_[i].image);
    return x;
  }

  UzawaAL::Acceleration kind_;
  std::vector<Evaluation> past_;
  Vector<T> plain_;  ///< image of the last x that was not refused
  double last_residual_ = 0, weight_ = 1;
  bool on_trial_ = false;
  int credit_ = 2;
};

}  // namespace stickslip
