/// Acceleration of a fixed point iteration x <- f(x), and its contraction, both from the values that it has produced.
///
///   r = f(x) - x
///   Aitken     x <- x + w r,  w <- -w r_last . (r - r_last) / |r - r_last|^2, kept in [0.1, 10]
///   Anderson   x <- f(x) - sum gamma_i (f_i+1 - f_i),  gamma: least squares of r - sum gamma_i (r_i+1 - r_i)  over the
///              last m = 5 differences, by QR. The oldest difference is dropped while the condition number of the
///              scaled columns exceeds 1e8, or while the difference is rounding
///
/// The weights w and gamma are formed from values alone and not differentiated. The fixed point does not depend on
/// them.
///
/// An extrapolated x is on trial. It is refused unless its residual is below 0.9 of the last one, or below q of it if
/// the contraction q exceeds 0.9. After a refusal the iteration takes the plain step from the last x that was not
/// refused. A refusal costs one evaluation. Two refusals are free; each further one needs an earlier extrapolation that
/// was worth two plain steps. So the iteration is never much worse than the plain one. [IT69], [WN11]
#pragma once

#include <vector>

#include "core/algebra/scalar.hpp"
#include "core/engine/engine.hpp"
#include "methods/options.hpp"

namespace stickslip {

/// Differences of two arguments of one map, and of their images.
struct Secant {
  Vector<double> argument, image;
  double noise = 0;  ///< error of the image, over the norm of the argument
};

/// Contraction of a linear map A from some of its secants, oldest first: the spectral radius of A on the space of their
/// arguments (Arnoldi's method if they are successive). From each secant the part in the space of the earlier arguments
/// is subtracted. A secant is left out if the noise may exceed 2 % of what remains. If fewer than two remain, the
/// result is the norm of the last image over that of its argument. pre: no argument is zero.
double contraction(const std::vector<Secant>& secants);

/// Anderson's gamma: one weight per difference of successive residuals, oldest first; 0 for a difference that is left
/// out. `noise`: a difference of a norm up to this is rounding.
Vector<double> anderson_weights(const Matrix<double>& differences, const Vector<double>& residual, double noise);

/// Accelerated iteration: keeps the last evaluations of one map, and makes the next argument from them.
template <class T>
class Accelerator {
 public:
  explicit Accelerator(UzawaAL::Acceleration kind) : kind_(kind) {}

  /// The next x after f(x) = image.
  ///
  ///   same_map       f is that of the last call; false: earlier evaluations are forgotten
  ///   contraction    of the plain iteration; 0: not measured
  ///   admissible(x)  projects an extrapolated x onto the set of images
  template <class Admissible>
  Vector<T> next(const Vector<T>& x, const Vector<T>& image, bool same_map, double contraction,
                 Admissible&& admissible) {
    if (kind_ == UzawaAL::Acceleration::none) return image;
    const double residual = norm(values(image - x));
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
    const double noise = 1e2 * unit_roundoff * norm(values(x));  // bound of the rounding of a difference of residuals
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
