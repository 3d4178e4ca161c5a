#include "byre/optimise/reduced_system.h"

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace byre {
namespace {

// Each pose is a neighbour of the three before it and of the first.
std::vector<std::vector<int>> neighbours_of(int poses) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(poses));
  for (int row = 1; row < poses; ++row) {
    std::vector<int>& columns = neighbours[static_cast<std::size_t>(row)];
    if (row > 3) columns.push_back(0);
    for (int column = std::max(0, row - 3); column < row; ++column) columns.push_back(column);
  }
  return neighbours;
}

// Fills the system with random blocks and a dominant, hence positive definite, diagonal. Returns the full matrix.
Eigen::MatrixXd fill(ReducedSystem& system, int poses, double diagonal) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(6 * poses, 6 * poses);
  const std::vector<std::vector<int>> neighbours = neighbours_of(poses);
  system.set_zero();
  const auto add = [&](int row, int column, const Matrix6& block) {
    system.at(row, column) += block;
    whole.block<6, 6>(6 * row, 6 * column) = block;
    whole.block<6, 6>(6 * column, 6 * row) = block.transpose();
  };
  for (int row = 0; row < poses; ++row) {
    for (const int column : neighbours[static_cast<std::size_t>(row)]) {
      add(row, column, Matrix6::NullaryExpr([&] { return value(random); }));
    }
    const Matrix6 own = Matrix6::NullaryExpr([&] { return value(random); });
    add(row, row, own * own.transpose() + diagonal * Matrix6::Identity());
  }
  return whole;
}

class ReducedSystemOf : public testing::TestWithParam<int> {};  // number of poses

TEST_P(ReducedSystemOf, HasTheSolutionOfTheFullMatrix) {
  ReducedSystem system(GetParam(), neighbours_of(GetParam()));
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(6 * GetParam(), -1.0, 2.0);
  for (const double diagonal : {2000.0, 700.0}) {  // the second solution reuses the pattern of the first
    const Eigen::MatrixXd whole = fill(system, GetParam(), diagonal);
    const auto solution = system.solve(right);
    ASSERT_TRUE(solution);
    EXPECT_LT((whole * *solution - right).norm(), 1e-9 * right.norm());
  }
}

TEST_P(ReducedSystemOf, SolvesForSeveralRightHandSides) {
  ReducedSystem system(GetParam(), neighbours_of(GetParam()));
  Eigen::MatrixXd right(6 * GetParam(), 2);
  right << Eigen::VectorXd::LinSpaced(6 * GetParam(), -1.0, 2.0), Eigen::VectorXd::Ones(6 * GetParam());
  const Eigen::MatrixXd whole = fill(system, GetParam(), 900.0);
  const auto solutions = system.solve_several(right);
  ASSERT_TRUE(solutions);
  EXPECT_LT((whole * *solutions - right).norm(), 1e-9 * right.norm());
}

TEST_P(ReducedSystemOf, IsEmptyIfNotPositiveDefinite) {
  ReducedSystem system(GetParam(), neighbours_of(GetParam()));
  fill(system, GetParam(), 2000.0);
  system.at(0, 0) -= 1e6 * Matrix6::Identity();
  EXPECT_FALSE(system.solve(Eigen::VectorXd::Ones(6 * GetParam())));
}

INSTANTIATE_TEST_SUITE_P(DenseAndSparse, ReducedSystemOf, testing::Values(1, 20, ReducedSystem::kMaxDensePoses + 10));

TEST(ReducedSystem, HasTheSameSolutionForBandedPoses) {
  constexpr int kPoses = ReducedSystem::kMaxDensePoses + 4;
  std::vector<std::vector<int>> neighbours(kPoses);
  for (int row = 0; row < kPoses; ++row) {
    for (int column = 0; column < row; ++column) neighbours[static_cast<std::size_t>(row)].push_back(column);
  }
  ReducedSystem filled(kPoses, neighbours), sparse(kPoses, neighbours_of(kPoses));
  fill(filled, kPoses, 1500.0);
  fill(sparse, kPoses, 1500.0);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(6 * kPoses, 1.0, -2.0);
  const auto solution = filled.solve(right);
  const auto expected = sparse.solve(right);
  ASSERT_TRUE(solution && expected);
  EXPECT_LT((*solution - *expected).norm(), 1e-9 * expected->norm());
}

TEST(ReducedSystem, IsEmptyWithoutPoses) {
  const auto solution = ReducedSystem(0, {}).solve(Eigen::VectorXd());
  ASSERT_TRUE(solution);
  EXPECT_EQ(solution->size(), 0);
}

}  // namespace
}  // namespace byre
