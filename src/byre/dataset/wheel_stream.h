#pragma once

#include "byre/dataset/motion_messages.h"

#include <vector>

namespace byre {

// What wheels tell, of which one of both is to be used: poses where they are filled in, else velocities. Drivers that
// fill in the velocity alone leave the pose as it is for ever, while the base moves by what they say.
class WheelStream {
 public:
  enum class Kind { open, poses, velocities };

  // In order of time. A base that begins to move is held back for some centimetres, until its kind is known.
  void add(const WheelSample& sample);

  Kind kind() const { return kind_; }
  // What came and is not held back, since it was taken last, in order of time; no sample has both.
  std::vector<WheelSample> take();

 private:
  bool has_moved_away(const WheelSample& sample);
  void tell(const WheelSample& sample);
  void decide(Kind kind);

  Kind kind_ = Kind::open;
  std::optional<Pose> first_;
  std::optional<BaseVelocity> last_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();  // metres ahead and to the left, radians; by velocities alone
  std::vector<WheelSample> held_;
  std::vector<WheelSample> told_;
};

}  // namespace byre
