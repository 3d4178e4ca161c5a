#pragma once

#include "byre/rig.h"
#include "byre/workers/reused_memory.h"

#include <array>
#include <cstddef>
#include <vector>

namespace byre {

// The cost of a pose, and its expansion to second order in delta, which moves it to exp_pose(delta) *
// camera_from_world.
struct PoseExpansion {
  double cost = 0.0;  // squared sigmas
  Matrix6 normal_matrix = Matrix6::Zero();
  Vector6 descent = Vector6::Zero();  // minus half the gradient

  PoseExpansion& operator+=(const PoseExpansion& other);
};

// A point that a frame sees, as its share of a pose's cost reads it.
struct WeighedPoint {
  Eigen::Vector3d point_in_world;
  StereoPixel measured;
  Eigen::Matrix3d information;  // inverse covariance in pixels; zero in its third row and column: no disparity
  double weight = 1.0;          // multiplies its cost
};

// Points that a frame sees, four side by side in memory, so that the processor works on several of them at once.
class WeighedPoints {
 public:
  void clear();  // the memory stays
  void reserve(std::size_t points) { make_room(blocks_, (points + kLanes - 1) / kLanes); }
  void add(const WeighedPoint& point);
  void square_weights();

  // The sum of the points' costs, each its squared error under Huber's loss. A point at or behind the camera pays for
  // it and pulls nowhere. The same to the last bit on every processor.
  PoseExpansion expand(const Rig& rig, const Pose& camera_from_world, double huber_width) const;

  static constexpr std::size_t kLanes = 4;
  using Lanes = std::array<double, kLanes>;
  // All zero where there is no point.
  struct Block {
    Lanes x{}, y{}, z{};                       // metres in the world
    Lanes u{}, v{}, disparity{};               // pixels
    Lanes uu{}, uv{}, ud{}, vv{}, vd{}, dd{};  // information
    Lanes weight{};
  };

 private:
  std::vector<Block> blocks_;
  std::size_t size_ = 0;  // points
};

}  // namespace byre
