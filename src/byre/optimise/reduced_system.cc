#include "byre/optimise/reduced_system.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>

namespace byre {

// Blocks row by row. The pattern of the matrix is constant, so that CHOLMOD analyses it once.
struct ReducedSystem::Sparse {
  std::vector<std::vector<int>> columns;  // columns of the blocks of each row, ascending, its diagonal last
  std::vector<std::size_t> begin;         // index of each row's first block
  std::vector<Matrix6> blocks;  // emptied once in the matrix, because the factorisation needs as much memory again
  Eigen::SparseMatrix<double> lower;
  Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor;

  explicit Sparse(std::vector<std::vector<int>> neighbours) : columns(std::move(neighbours)) {
    for (std::size_t row = 0; row < columns.size(); ++row) {
      begin.push_back(begin.empty() ? 0 : begin.back() + columns[row - 1].size());
      columns[row].push_back(static_cast<int>(row));
    }
    set_zero();
    const auto size = static_cast<Eigen::Index>(6 * columns.size());
    lower.resize(size, size);
  }

  void set_zero() { blocks.assign(begin.empty() ? 0 : begin.back() + columns.back().size(), Matrix6::Zero()); }

  Matrix6& at(int row, int column) {
    const std::vector<int>& of_row = columns[static_cast<std::size_t>(row)];
    const auto place = std::ranges::lower_bound(of_row, column);
    assert(place != of_row.end() && *place == column);
    return blocks[begin[static_cast<std::size_t>(row)] + static_cast<std::size_t>(place - of_row.begin())];
  }

  // Writes the lower triangle, column by column. Clears the blocks.
  void fill_lower() {
    std::vector<std::vector<std::pair<int, const Matrix6*>>> rows_of_column(columns.size());
    for (std::size_t row = 0; row < columns.size(); ++row) {
      for (std::size_t i = 0; i < columns[row].size(); ++i) {
        rows_of_column[static_cast<std::size_t>(columns[row][i])].emplace_back(row, &blocks[begin[row] + i]);
      }
    }
    lower.setZero();
    lower.reserve(static_cast<Eigen::Index>(36 * blocks.size()));
    for (std::size_t column = 0; column < columns.size(); ++column) {
      for (int c = 0; c < 6; ++c) {
        lower.startVec(static_cast<Eigen::Index>(6 * column) + c);
        for (const auto& [row, block] : rows_of_column[column]) append(row, static_cast<int>(column), c, *block);
      }
    }
    lower.finalize();
    blocks = {};
  }

  void append(int row, int column, int c, const Matrix6& block) {
    for (int r = row == column ? c : 0; r < 6; ++r) {
      lower.insertBackByOuterInner(6 * column + c, 6 * row + r) = block(r, c);
    }
  }
};

namespace {

// At least a quarter of all pairs.
bool is_mostly_dense(int poses, const std::vector<std::vector<int>>& neighbours) {
  std::size_t pairs = 0;
  for (const std::vector<int>& columns : neighbours) pairs += columns.size();
  return 8 * pairs >= static_cast<std::size_t>(poses) * static_cast<std::size_t>(poses);
}

}  // namespace

ReducedSystem::ReducedSystem(int poses, std::vector<std::vector<int>> neighbours) : poses_(poses) {
  if (poses <= kMaxDensePoses || is_mostly_dense(poses, neighbours)) {
    dense_.resize(6 * poses, 6 * poses);
  } else {
    sparse_ = std::make_unique<Sparse>(std::move(neighbours));
  }
}
ReducedSystem::~ReducedSystem() = default;
ReducedSystem::ReducedSystem(ReducedSystem&&) noexcept = default;
ReducedSystem& ReducedSystem::operator=(ReducedSystem&&) noexcept = default;

void ReducedSystem::set_zero() {
  // The upper triangle is never written, so that nearly half of a large matrix takes no memory.
  for (Eigen::Index first = 0; first < dense_.cols(); first += 6) {
    dense_.block(first, first, dense_.rows() - first, 6).setZero();
  }
  if (sparse_) sparse_->set_zero();
}

ReducedSystem::Block ReducedSystem::at(int row, int column) {
  assert(column <= row);
  if (sparse_) return Block(sparse_->at(row, column).data(), Eigen::OuterStride<>(6));
  return Block(&dense_(6 * row, 6 * column), Eigen::OuterStride<>(dense_.outerStride()));
}

template <typename Sides>
std::optional<Sides> ReducedSystem::solution(const Sides& right_hand_sides) {
  if (poses_ == 0) return right_hand_sides;
  Sides solution;
  if (sparse_) {
    const bool is_first = sparse_->lower.nonZeros() == 0;
    sparse_->fill_lower();
    if (is_first) sparse_->factor.analyzePattern(sparse_->lower);
    sparse_->factor.factorize(sparse_->lower);
    if (sparse_->factor.info() != Eigen::Success) return std::nullopt;
    solution = sparse_->factor.solve(right_hand_sides);
  } else {
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(dense_);
    if (factor.info() != Eigen::Success) return std::nullopt;
    solution = factor.solve(right_hand_sides);
  }
  return solution.allFinite() ? std::optional(solution) : std::nullopt;
}

template std::optional<Eigen::VectorXd> ReducedSystem::solution(const Eigen::VectorXd&);
template std::optional<Eigen::MatrixXd> ReducedSystem::solution(const Eigen::MatrixXd&);

}  // namespace byre
