/// Reverse derivative: the scalar that remembers how it was computed, so that one sweep back gives the derivative of
/// one result with respect to everything it was computed from. The templates of the core run in it as they stand.
#pragma once

#include <vector>

#include "core/algebra/scalar.hpp"

namespace stickslip {

/// What was computed, in order: the partial derivatives of each result with respect to its one or two arguments.
class Tape {
 public:
  int size() const { return static_cast<int>(entries_.size()); }
  /// Bytes that it has taken: for its longest state so far, with room to grow.
  long bytes() const { return static_cast<long>(entries_.capacity() * sizeof(Entry)); }

  /// A variable that nothing on the tape was computed into.
  int leaf() { return record(-1, 0, -1, 0); }
  /// A result with arguments a and b (-1: none).
  int record(int a, double by_a, int b, double by_b) {
    entries_.push_back({a, b, by_a, by_b});
    return size() - 1;
  }
  /// Forgets everything from entry `start` on.
  void rewind(int start) { entries_.resize(start); }

  /// Records the derivatives of `results` by the entries before `start` in place of all that was recorded since; gives
  /// where the results are now, -1 for one that depends on nothing.
  std::vector<int> fold(int start, const std::vector<int>& results);

  /// Moves derivatives from the results recorded since `start` to their arguments. `by`: the derivative of the final
  /// result by each entry. Leaves, and entries recorded before `start`, gather and keep theirs. All others are zero
  /// again, so that more may be seeded and moved.
  void pull_back(std::vector<double>& by, int start) const {
    for (int i = size() - 1; i >= start; --i) {
      const Entry& entry = entries_[i];
      const double derivative = by[i];
      if (derivative == 0 || entry.a < 0) continue;
      by[i] = 0;
      by[entry.a] += derivative * entry.by_a;
      if (entry.b >= 0) by[entry.b] += derivative * entry.by_b;
    }
  }

 private:
  struct Entry {
    int a, b;  ///< a < 0: a leaf
    double by_a, by_b;
  };
  std::vector<Entry> entries_;
};

/// A value and its entry on a tape; a constant has none.
struct Reverse {
  double v = 0;
  int entry = -1;
  Tape* tape = nullptr;

  Reverse() = default;
  Reverse(double primal) : v(primal) {}  // NOLINT: a constant
  Reverse(int primal) : v(primal) {}     // NOLINT
  Reverse(double primal, int number, Tape* on) : v(primal), entry(number), tape(on) {}

  static Reverse leaf(double primal, Tape& tape) { return {primal, tape.leaf(), &tape}; }

  Reverse operator-() const { return of(*this, -v, -1); }
  Reverse& operator+=(const Reverse& o) { return *this = *this + o; }
  Reverse& operator-=(const Reverse& o) { return *this = *this - o; }
  Reverse& operator*=(const Reverse& o) { return *this = *this * o; }
  Reverse& operator/=(const Reverse& o) { return *this = *this / o; }

  friend Reverse operator+(const Reverse& a, const Reverse& b) { return of(a, b, a.v + b.v, 1, 1); }
  friend Reverse operator-(const Reverse& a, const Reverse& b) { return of(a, b, a.v - b.v, 1, -1); }
  friend Reverse operator*(const Reverse& a, const Reverse& b) { return of(a, b, a.v * b.v, b.v, a.v); }
  friend Reverse operator/(const Reverse& a, const Reverse& b) {
    const double q = a.v / b.v;
    return of(a, b, q, 1 / b.v, -q / b.v);
  }

  friend Reverse sqrt(const Reverse& a) {
    const double root = std::sqrt(a.v);
    return of(a, root, 0.5 / root);
  }
  friend Reverse exp(const Reverse& a) { return of(a, std::exp(a.v), std::exp(a.v)); }
  friend Reverse log(const Reverse& a) { return of(a, std::log(a.v), 1 / a.v); }
  friend Reverse log1p(const Reverse& a) { return of(a, std::log1p(a.v), 1 / (1 + a.v)); }
  friend Reverse sin(const Reverse& a) { return of(a, std::sin(a.v), std::cos(a.v)); }
  friend Reverse cos(const Reverse& a) { return of(a, std::cos(a.v), -std::sin(a.v)); }
  friend Reverse pow(const Reverse& a, double exponent) {
    return of(a, std::pow(a.v, exponent), exponent * std::pow(a.v, exponent - 1));
  }

 private:
  static Reverse of(const Reverse& a, double primal, double by_a) {
    return a.tape ? Reverse(primal, a.tape->record(a.entry, by_a, -1, 0), a.tape) : Reverse(primal);
  }
  static Reverse of(const Reverse& a, const Reverse& b, double primal, double by_a, double by_b) {
    if (!b.tape) return of(a, primal, by_a);
    if (!a.tape) return of(b, primal, by_b);
    return {primal, a.tape->record(a.entry, by_a, b.entry, by_b), a.tape};
  }
};

inline double value(const Reverse& x) { return x.v; }
inline bool vanishes(const Reverse& x) { return x.v == 0 && !x.tape; }

}  // namespace stickslip

namespace Eigen {
template <>
struct NumTraits<stickslip::Reverse> : NumTraits<double> {
  using Real = stickslip::Reverse;
  using NonInteger = stickslip::Reverse;
  using Nested = stickslip::Reverse;
  using Literal = stickslip::Reverse;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 2,
    AddCost = 4,
    MulCost = 4
  };
};
template <class Op>
struct ScalarBinaryOpTraits<stickslip::Reverse, double, Op> {
  using ReturnType = stickslip::Reverse;
};
template <class Op>
struct ScalarBinaryOpTraits<double, stickslip::Reverse, Op> {
  using ReturnType = stickslip::Reverse;
};
}  // namespace Eigen

namespace stickslip {

/// Where a tape stands before a function of few arguments whose inside is not to stay on it. Of a scalar that has no
/// tape it does nothing.
template <class T>
struct TapeMark {
  template <class Arguments>
  explicit TapeMark(const Arguments& /*arguments*/) {}
  template <class Results>
  void fold(Results& /*results*/) const {}
};
template <>
struct TapeMark<Reverse> {
  Tape* tape = nullptr;  ///< of the arguments; none: they are constants
  int start = 0;

  template <class Arguments>
  explicit TapeMark(const Arguments& arguments) {
    for (const Reverse& argument : arguments.reshaped())
      if (argument.tape) tape = argument.tape;
    if (tape) start = tape->size();
  }
  /// Puts in place of all that was recorded since the derivatives of the results by what was there before. pre: nothing
  /// but the results is used any more.
  /// Preaccumulation: [GW08]
  template <class Results>
  void fold(Results& results) const {
    if (!tape) return;
    std::vector<int> entries;
    for (const Reverse& result : results) entries.push_back(result.entry);
    const auto folded = tape->fold(start, entries);
    for (std::size_t k = 0; k < results.size(); ++k) {
      results[k].entry = folded[k];
      if (folded[k] < 0) results[k].tape = nullptr;
    }
  }
};

/// Variables on a tape with the values of a vector.
inline Vector<Reverse> leaves(const Vector<double>& v, Tape& tape) {
  Vector<Reverse> out(v.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) out[i] = Reverse::leaf(v[i], tape);
  return out;
}

}  // namespace stickslip
