#pragma once

#include "byre/pose.h"

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Normal equations over poses, six unknowns each, after elimination of the points; symmetric, lower triangle stored.
// Sparse if few pairs of poses have common points: their number is linear in the map's size, that of all pairs
// quadratic. Dense for few poses or many pairs: CHOLMOD then fills in nearly all pairs and takes twice the memory for
// its copies.
class ReducedSystem {
 public:
  using Block = Eigen::Map<Matrix6, Eigen::Unaligned, Eigen::OuterStride<>>;

  static constexpr int kMaxDensePoses = 60;

  // neighbours: for each pose the earlier poses with common points, ascending. Used only in the sparse form.
  ReducedSystem(int poses, std::vector<std::vector<int>> neighbours);
  ~ReducedSystem();
  ReducedSystem(ReducedSystem&&) noexcept;
  ReducedSystem& operator=(ReducedSystem&&) noexcept;

  void set_zero();
  // Preconditions: column <= row, and both are neighbours or equal.
  Block at(int row, int column);
  // Empty if the matrix is not positive definite. To be called once per filling: it overwrites the matrix.
  std::optional<Eigen::VectorXd> solve(const Eigen::VectorXd& right_hand_side) { return solution(right_hand_side); }
  std::optional<Eigen::MatrixXd> solve_several(const Eigen::MatrixXd& right_hand_sides) {
    return solution(right_hand_sides);
  }

 private:
  template <typename Sides>
  std::optional<Sides> solution(const Sides& right_hand_sides);

  struct Sparse;

  int poses_ = 0;
  Eigen::MatrixXd dense_;           // empty in the sparse form
  std::unique_ptr<Sparse> sparse_;  // null in the dense form
};

}  // namespace byre
