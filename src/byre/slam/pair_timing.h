#pragma once

#include "byre/map/map_view.h"
#include "byre/slam/lasting_doubt.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <vector>

namespace byre {

// Least squares of value = slope * motion + others, older frames counting less.
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
  // Empty where motion differs too little from the others. least_motion: root mean square of what is left of it.
  std::optional<Slope> slope(double least_motion) const;

 private:
  static constexpr int kSize = kOthers + 1;
  Eigen::Matrix<double, kSize, kSize> information_ = Eigen::Matrix<double, kSize, kSize>::Zero();
  Eigen::Matrix<double, kSize, 1> right_side_ = Eigen::Matrix<double, kSize, 1>::Zero();
  double squares_ = 0.0;
  double count_ = 0.0;
};

// Estimates by how many frames the right image is later than the left one. A late image shows each point where it was:
// rows and disparities are off in proportion to the motion of points in the image. Errors of the calibration that are
// linear in the image, and constant ones of rows, are estimated beside that.
class PairTiming {
 public:
  // A frame with a right image that has a pose: present where the images are out of step, absent where they are in
  // step, unclear where the image hardly moves.
  Sign note(const Frame& frame, const Rig& rig, const TrackedFrame& tracked, const MapView& map);
  // The frame has no pose, or no right image.
  void skip() { last_.clear(); }

  // The delay in frames; empty while the image hardly moves.
  std::optional<SlopeSum::Slope> by_rows() const { return rows_.slope(kLeastRowMotion); }
  std::optional<SlopeSum::Slope> by_disparities() const { return disparities_.slope(kLeastColumnMotion); }

 private:
  // Pixels per frame. Constant errors of disparities look like a turn of the camera, and are small beside that.
  static constexpr double kLeastRowMotion = 0.3;
  static constexpr double kLeastColumnMotion = 1.5;

  struct Sight {
    PointId point;
    Eigen::Vector2f pixel;
    int feature = 0;
  };

  SlopeSum rows_;
  SlopeSum disparities_;
  std::vector<Sight> last_;  // in the frame before, ascending by point
  std::vector<Sight> now_;   // memory
};

}  // namespace byre
