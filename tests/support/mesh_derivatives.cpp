#include "tests/support/mesh_derivatives.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <limits>

#include "tests/support/largest.hpp"

namespace stickslip {

void expect_exact_derivatives(const MeshDescription& description, const std::string& element, int dimension,
                              const std::vector<double>& numbers) {
  constexpr int most = 9;
  ASSERT_LE(numbers.size(), static_cast<std::size_t>(most));
  const int count = static_cast<int>(numbers.size());
  Numbers<Dual<most>> seeded;
  for (int i = 0; i < count; ++i) seeded.at_slot.push_back(Dual<most>::seed(numbers[i], i));
  const Mesh mesh = make_mesh(description, element, dimension);
  const Points<Dual<most>> dual = make_points(description, mesh, seeded);
  for (int i = 0; i < count; ++i) {
    const double step = 1e-30;  // so small that its square is lost: the complex step has no truncation error
    Numbers<std::complex<double>> moved{{numbers.begin(), numbers.end()}};
    moved.at_slot[i] += std::complex<double>(0, step);
    const Points<std::complex<double>> oracle = make_points(description, mesh, moved);
    double largest = 0;
    for (Eigen::Index k = 0; k < dual.size(); ++k) {
      const double derivative = dual.data()[k].d[i], expected = oracle.data()[k].imag() / step;
      largest = larger(largest, std::abs(expected));
      // both evaluate the same formula of up to some hundred operations on numbers near 10
      EXPECT_NEAR(derivative, expected, 1000 * std::numeric_limits<double>::epsilon() * (1 + std::abs(expected)));
    }
    EXPECT_GT(largest, 1e-3) << "slot " << i << " moves nothing";
  }
}

}  // namespace stickslip
