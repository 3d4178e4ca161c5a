#include "byre/geometry/essential.h"

#include "byre/geometry/decompositions.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace byre {
namespace {

// Polynomials in x, y, z up to degree three, as coefficients of kMonomials. Polynomials up to degree two have zeros
// before kSquares, those up to degree one before kLinear.
constexpr int kTerms = 20;
constexpr int kSquares = 10;
constexpr int kLinear = 16;
using Polynomial = Eigen::Matrix<double, kTerms, 1>;

struct Monomial {
  int x = 0, y = 0, z = 0;  // exponents
  bool operator==(const Monomial&) const = default;
};

constexpr std::array<Monomial, kTerms> kMonomials = {
    {{3, 0, 0}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {1, 1, 1}, {1, 0, 2}, {0, 3, 0}, {0, 2, 1}, {0, 1, 2}, {0, 0, 3},
     {2, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 2, 0}, {0, 1, 1}, {0, 0, 2}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};

constexpr int index_of(const Monomial& monomial) {
  for (int i = 0; i < kTerms; ++i) {
    if (kMonomials[static_cast<std::size_t>(i)] == monomial) return i;
  }
  return -1;
}

// Index of the product of two monomials; -1 beyond degree three.
constexpr auto kProducts = [] {
  std::array<std::array<int, kTerms>, kTerms> products{};
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t j = 0; j < kTerms; ++j) {
      const Monomial &a = kMonomials[i], &b = kMonomials[j];
      products[i][j] = index_of({a.x + b.x, a.y + b.y, a.z + b.z});
    }
  }
  return products;
}();

// first_begin: index of the first non-zero term of `first`. Precondition: second is linear.
[[gnu::noinline]] Polynomial times_linear(const Polynomial& first, int first_begin, const Polynomial& second) {
  Polynomial product = Polynomial::Zero();
  for (int i = first_begin; i < kTerms; ++i) {
    for (int j = kLinear; j < kTerms; ++j) {
      product[kProducts[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]] += first[i] * second[j];
    }
  }
  return product;
}

// The essential matrix as x * basis[0] + y * basis[1] + z * basis[2] + basis[3].
using Basis = std::array<Eigen::Matrix3d, 4>;

struct PolynomialMatrix {
  std::array<std::array<Polynomial, 3>, 3> entries;
  const Polynomial& operator()(int row, int column) const {
    return entries[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  }
  Polynomial& operator()(int row, int column) {
    return entries[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  }
};

// Basis of the matrices that satisfy the five epipolar equations.
Basis basis_of(const std::array<TwoViewMatch, 5>& matches) {
  Eigen::Matrix<double, 9, 5> equations;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const Eigen::Matrix3d products = matches[i].ray_in_second * matches[i].ray_in_first.transpose();
    equations.col(static_cast<Eigen::Index>(i)) = products.reshaped();
  }
  const Eigen::HouseholderQR<Eigen::Matrix<double, 9, 5>> decomposition(equations);
  const Eigen::Matrix<double, 9, 9> orthogonal = decomposition.householderQ();
  Basis basis;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    basis[i] = orthogonal.col(static_cast<Eigen::Index>(5 + i)).reshaped(3, 3);
  }
  return basis;
}

PolynomialMatrix combination(const Basis& basis) {
  PolynomialMatrix matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      Polynomial& entry = matrix(row, column) = Polynomial::Zero();
      for (int i = 0; i < 4; ++i) entry[kLinear + i] = basis[static_cast<std::size_t>(i)](row, column);
    }
  }
  return matrix;
}

Polynomial determinant(const PolynomialMatrix& matrix) {
  const auto minor = [&](int a, int b) -> Polynomial {
    return times_linear(matrix(1, a), kLinear, matrix(2, b)) - times_linear(matrix(1, b), kLinear, matrix(2, a));
  };
  return times_linear(minor(1, 2), kSquares, matrix(0, 0)) + times_linear(minor(2, 0), kSquares, matrix(0, 1)) +
         times_linear(minor(0, 1), kSquares, matrix(0, 2));
}

// E * E^T - trace(E * E^T) / 2.
PolynomialMatrix reduced_square(const PolynomialMatrix& matrix) {
  PolynomialMatrix square;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      Polynomial& entry = square(row, column) = Polynomial::Zero();
      for (int i = 0; i < 3; ++i) entry += times_linear(matrix(row, i), kLinear, matrix(column, i));
    }
  }
  const Polynomial half_trace = 0.5 * (square(0, 0) + square(1, 1) + square(2, 2));
  for (int i = 0; i < 3; ++i) square(i, i) -= half_trace;
  return square;
}

// The ten cubics that vanish for an essential matrix (two equal singular values, the third zero), one per row.
Eigen::Matrix<double, 10, kTerms> constraints(const PolynomialMatrix& matrix) {
  Eigen::Matrix<double, 10, kTerms> rows;
  const PolynomialMatrix square = reduced_square(matrix);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      Polynomial cubic = Polynomial::Zero();
      for (int i = 0; i < 3; ++i) cubic += times_linear(square(row, i), kSquares, matrix(i, column));
      rows.row(3 * row + column) = cubic.transpose();
    }
  }
  rows.row(9) = determinant(matrix).transpose();
  return rows;
}

// Multiplication by x on the monomials up to degree two, modulo the constraints. Solutions are its eigenvectors.
Eigen::Matrix<double, 10, 10> multiplication_by_x(const Eigen::Matrix<double, 10, kTerms>& rows) {
  const Eigen::Matrix<double, 10, 10> cubics =
      -rows.leftCols<kSquares>().partialPivLu().solve(rows.rightCols<kSquares>());
  Eigen::Matrix<double, 10, 10> action = Eigen::Matrix<double, 10, 10>::Zero();
  for (int i = 0; i < kTerms - kSquares; ++i) {
    const Monomial& monomial = kMonomials[static_cast<std::size_t>(kSquares + i)];
    const int product = index_of({monomial.x + 1, monomial.y, monomial.z});
    if (product < kSquares) {
      action.row(i) = cubics.row(product);
    } else {
      action(i, product - kSquares) = 1.0;
    }
  }
  return action;
}

}  // namespace

std::vector<Eigen::Matrix3d> five_point_essentials(const std::array<TwoViewMatch, 5>& matches) {
  const Basis basis = basis_of(matches);
  const Eigen::Matrix<double, 10, 10> action = multiplication_by_x(constraints(combination(basis)));
  if (!action.allFinite()) return {};
  const Eigen::EigenSolver<Eigen::Matrix<double, 10, 10>> eigen(action);
  if (eigen.info() != Eigen::Success) return {};
  std::vector<Eigen::Matrix3d> essentials;
  for (int i = 0; i < 10; ++i) {
    if (eigen.eigenvalues()[i].imag() != 0.0) continue;
    const Eigen::Vector4d weights = eigen.eigenvectors().col(i).real().tail<4>();  // x, y, z, 1 up to scale
    Eigen::Matrix3d essential = Eigen::Matrix3d::Zero();
    for (int j = 0; j < 4; ++j) essential += weights[j] * basis[static_cast<std::size_t>(j)];
    if (essential.norm() > 0.0) essentials.push_back(essential.normalized());
  }
  return essentials;
}

Eigen::Matrix3d essential_of(const Pose& second_from_first) {
  return skew(second_from_first.translation) * second_from_first.rotation.toRotationMatrix();
}

std::array<Pose, 4> motions_from_essential(const Eigen::Matrix3d& essential) {
  auto [left, values, right] = singular_values(essential);
  if (left.determinant() < 0.0) left = -left;
  if (right.determinant() < 0.0) right = -right;
  Eigen::Matrix3d quarter_turn;
  quarter_turn << 0.0, -1.0, 0.0,  //
      1.0, 0.0, 0.0,               //
      0.0, 0.0, 1.0;
  const Eigen::Quaterniond one(Eigen::Matrix3d(left * quarter_turn * right.transpose()));
  const Eigen::Quaterniond other(Eigen::Matrix3d(left * quarter_turn.transpose() * right.transpose()));
  const Eigen::Vector3d translation = left.col(2);
  return {{{one, translation}, {one, -translation}, {other, translation}, {other, -translation}}};
}

}  // namespace byre
