#pragma once

#include "byre/io/recording/motion_messages.h"

#include <vector>

namespace byre {

// Selects poses or velocities of wheel samples: poses if they change, else velocities. Drivers that fill in only the
// velocity leave the pose constant while the velocity reports motion.
class WheelStream {
 public:
  enum class Kind { open, poses, velocities };

  // Samples in order of time. Samples of a base that begins to move are held back for some centimetres, until the kind
  // is decided.
  void add(const WheelSample& sample);

  Kind kind() const { return kind_; }
  // Samples since the last call that are not held back, in order of time; none has both pose and velocity.
  std::vector<WheelSample> take();

 private:
  bool accumulate_motion(const WheelSample& sample);
  void emit(const WheelSample& sample);
  void decide(Kind kind);

  Kind kind_ = Kind::open;
  std::optional<Pose> first_;
  std::optional<BaseTwist> last_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();  // metres ahead and to the left, radians; integrated velocities
  std::vector<WheelSample> pending_;
  std::vector<WheelSample> output_;
};

}  // namespace byre
