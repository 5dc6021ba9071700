/// What the solver takes for granted of a law of friction, of each law in the list, at the numbers of its description.
#include <gtest/gtest.h>

#include "core/contact/friction_law.hpp"

namespace stickslip::friction_laws_test {
namespace {

using D = Dual<1>;
constexpr double rounding = 1e-12;

FrictionLaw<D> in_duals(const FrictionLaw<double>& law) {
  return law.as<D>([](double x) { return D(x); });
}

/// Slope of the sloping piece.
double slope(const FrictionLaw<double>& law, double pressure) {
  return in_duals(law).bound(D::seed(pressure, 0), ContactState::slip).d[0];
}

void expect_sloping_piece(const FrictionLaw<double>& law) {
  const double first = value(law.slope_at_apex());
  const auto bound = [&](double pressure) { return law.bound(pressure, ContactState::slip); };
  EXPECT_EQ(bound(0), 0) << "the sloping piece begins at zero";
  EXPECT_TRUE(std::isfinite(first));
  EXPECT_NEAR(slope(law, 0), first, rounding * first);
  double last = first;
  for (double pressure = 1e-3; pressure < 1e6; pressure *= 2) {
    EXPECT_LE(slope(law, pressure), last * (1 + rounding)) << "concave, at " << pressure;
    EXPECT_GE(slope(law, pressure), 0) << pressure;
    const double line = law.is_piecewise_linear() ? first * pressure : bound(pressure);
    EXPECT_NEAR(bound(pressure), line, rounding * line) << "a multiple of the pressure, at " << pressure;
    last = slope(law, pressure);
  }
}

template <class L>
void expect_law() {
  L law;
  detail::for_each_number(law, [](const auto& number, double& x) { x = number.example; });
  std::vector<L> laws{law};  // with what may be left out, and without
  std::apply(
      [&](const auto&... number) {
        const auto give = [&](const auto& each) {
          if constexpr (!std::decay_t<decltype(each)>::is_required) law.*each.member = each.example;
        };
        (give(number), ...);
      },
      L::numbers());
  laws.push_back(law);
  for (const L& each : laws) {
    const FrictionLaw<double> of(each);
    EXPECT_GE(of.piece_count(), 1);
    EXPECT_TRUE(of.piece_count() == 1 || of.is_piecewise_linear()) << "its corner is where two lines meet";
    if (of.has(ContactState::slip)) expect_sloping_piece(of);
    if (of.has(ContactState::limited)) {
      EXPECT_EQ(of.bound(1, ContactState::limited), of.bound(1e6, ContactState::limited)) << "a constant";
    } else {
      EXPECT_NEAR(of.slope_at_infinity(), slope(of, 1e100), 1e-6 * value(of.slope_at_apex()));
    }
  }
}

template <class... L>
void expect_laws(const std::variant<L...>*) {
  (
      [] {
        SCOPED_TRACE(std::get<0>(L::numbers()).key);
        expect_law<L>();
      }(),
      ...);
}

TEST(FrictionLaws, AreWhatTheirDescriptionsSay) { expect_laws(static_cast<const FrictionLaws<double>*>(nullptr)); }

}  // namespace
}  // namespace stickslip::friction_laws_test
