#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/rig.h"

#include <array>
#include <cstddef>

namespace byre {

// Cost of a pose and its second-order expansion in delta of exp_pose(delta) * camera_from_world.
struct PoseExpansion {
  double cost = 0.0;  // squared sigmas
  Matrix6 normal_matrix = Matrix6::Zero();
  Vector6 descent = Vector6::Zero();  // minus half the gradient

  PoseExpansion& operator+=(const PoseExpansion& other);
};

// A point observed by a frame, as a term of the pose's cost.
struct WeightedPoint {
  Eigen::Vector3d point_in_world;
  StereoPixel measured;
  Eigen::Matrix3d information;  // inverse covariance, 1 / pixels^2; third row and column zero without a disparity
  double weight = 1.0;          // factor on its cost
};

// Points observed by a frame, in blocks of four for vector instructions.
class WeightedPoints {
 public:
  void clear();  // keeps the memory
  void reserve(std::size_t points) { blocks_.reserve((points + kLanes - 1) / kLanes); }
  void add(const WeightedPoint& point);
  void square_weights();

  // Sum of the points' Huber losses, bit-identical on every processor. A point at or behind the camera has a constant
  // cost.
  PoseExpansion expand(const Rig& rig, const Pose& camera_from_world, double huber_width) const;

  static constexpr std::size_t kLanes = 4;
  using Lanes = std::array<double, kLanes>;
  // Unused lanes are zero.
  struct Block {
    Lanes x{}, y{}, z{};                       // metres, in the world
    Lanes u{}, v{}, disparity{};               // pixels
    Lanes uu{}, uv{}, ud{}, vv{}, vd{}, dd{};  // upper triangle of the information
    Lanes weight{};
  };

 private:
  ScratchVector<Block> blocks_;
  std::size_t size_ = 0;  // points
};

}  // namespace byre
