#pragma once

#include "byre/pose.h"

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// The normal equations over poses, six unknowns each, once the points are eliminated; symmetric, of which the lower
// triangle is kept. By the pairs of poses that see a common point where these are few: their number grows with the map,
// that of all pairs with its square. Dense where poses are few, or most of them see the same room: then CHOLMOD, which
// fills in nearly all pairs anyway, takes twice the memory for its copies of the matrix.
class ReducedSystem {
 public:
  using Block = Eigen::Map<Matrix6, Eigen::Unaligned, Eigen::OuterStride<>>;

  static constexpr int kMaxDensePoses = 60;

  // neighbours: for each pose those before it that it shares points with, ascending. Used only where poses are many.
  ReducedSystem(int poses, std::vector<std::vector<int>> neighbours);
  ~ReducedSystem();
  ReducedSystem(ReducedSystem&&) noexcept;
  ReducedSystem& operator=(ReducedSystem&&) noexcept;

  void set_zero();
  // Preconditions: column <= row, and both are neighbours or the same.
  Block at(int row, int column);
  // Empty where the matrix is not positive definite. Once after each filling: the matrix is used up.
  std::optional<Eigen::VectorXd> solve(const Eigen::VectorXd& right_hand_side) { return solution(right_hand_side); }
  std::optional<Eigen::MatrixXd> solve_several(const Eigen::MatrixXd& right_hand_sides) {
    return solution(right_hand_sides);
  }

 private:
  template <typename Sides>
  std::optional<Sides> solution(const Sides& right_hand_sides);

  struct Sparse;

  int poses_ = 0;
  Eigen::MatrixXd dense_;           // empty where it is sparse
  std::unique_ptr<Sparse> sparse_;  // empty where it is dense
};

}  // namespace byre
