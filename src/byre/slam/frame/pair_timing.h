#pragma once

#include "byre/map/map_view.h"
#include "byre/slam/frame/fault_latch.h"
#include "byre/slam/tracking/tracking.h"

#include <optional>
#include <vector>

namespace byre {

// Least squares of value = slope * motion + coefficients * others, with weights that decay from frame to frame.
class SlopeSum {
 public:
  static constexpr int kOthers = 4;
  using Others = Eigen::Matrix<double, kOthers, 1>;

  void begin_frame();
  void add(double motion, const Others& others, double value);

  struct Slope {
    double value = 0.0;
    double sigma = 0.0;
  };
  // Empty if the others explain too much of the motion. least_motion: minimum root mean square of the remaining motion.
  std::optional<Slope> slope(double least_motion) const;

 private:
  static constexpr int kSize = kOthers + 1;
  Eigen::Matrix<double, kSize, kSize> information_ = Eigen::Matrix<double, kSize, kSize>::Zero();
  Eigen::Matrix<double, kSize, 1> right_side_ = Eigen::Matrix<double, kSize, 1>::Zero();
  double squares_ = 0.0;
  double count_ = 0.0;
};

// Estimates the delay of the right image against the left one, in frames. A late image shows each point at an earlier
// position, so row and disparity errors are proportional to the image motion of the points. Calibration errors that are
// linear in the image, and a constant one of rows, are estimated as well.
class PairTiming {
 public:
  // Adds a tracked frame with a right image. present: the images are out of step; absent: they are in step; unclear:
  // the image hardly moves.
  Sign note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map);
  // The frame has no pose, or no right image.
  void skip() { last_.clear(); }

  // Delay in frames by row and by disparity errors; empty while the image hardly moves.
  std::optional<SlopeSum::Slope> by_rows() const { return rows_.slope(kLeastRowMotion); }
  std::optional<SlopeSum::Slope> by_disparities() const { return disparities_.slope(kLeastColumnMotion); }

 private:
  // Minimum motion, pixels per frame. Constant errors of disparities look like a turn of the camera, and are smaller.
  static constexpr double kLeastRowMotion = 0.3;
  static constexpr double kLeastColumnMotion = 1.5;

  struct Sight {
    PointId point;
    Eigen::Vector2f pixel;
    int feature = 0;
  };

  SlopeSum rows_;
  SlopeSum disparities_;
  std::vector<Sight> last_;  // sights of the frame before, ascending by point
  std::vector<Sight> now_;   // buffer
};

}  // namespace byre
