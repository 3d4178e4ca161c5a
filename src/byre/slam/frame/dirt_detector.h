#pragma once

#include "byre/map/map_view.h"
#include "byre/session_event.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/image_mask.h"
#include "byre/slam/tracking/tracking.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace byre {

// A point seen in another cell shortly before, searched at its present prediction.
struct DirtTrial {
  Eigen::Vector2d pixel;
  bool is_found = false;
};

// Detects image cells behind dirt by points that other cells showed just before. Points that are occluded, dark or
// moved were not seen there either, so they are no evidence. Each cell has a sequential likelihood-ratio test (Page
// 1954) of two hypotheses: points are found nearly as often as in the rest of the image, or hardly ever. A cell is
// dirty once the second reaches a threshold, and clean again once the first has outweighed it.
class DirtMask {
 public:
  // Adds the trials of a frame. Too few trials to compare a cell with the rest are kept for the next frame.
  void note(std::span<const DirtTrial> trials, const Rig& rig);

  const ImageMask& hidden() const { return hidden_; }

 private:
  struct Count {
    int found = 0;
    int all = 0;
  };

  bool is_next_to_dirt(std::size_t cell) const;

  std::array<double, ImageMask::kCells> evidence_{};  // log-likelihood ratio of dirty to clean
  std::array<Count, ImageMask::kCells> counts_{};     // pending trials
  ImageMask hidden_;
};

// Detects dirt on the lenses while the robot moves. A few times a second, points seen in the last seconds are searched
// once they have moved to another image cell, behind dirt as well, so that cleaning is detected too. Does not affect
// the pose.
class DirtDetector {
 public:
  // A frame with a reliable pose. Precondition: frames are in order of time.
  void note(const Frame& frame, const TrackedFrame& tracked, const Rig& rig, const MapView& map);

  const ImageMask& hidden() const { return left_.hidden(); }         // in the left image
  const ImageMask& hidden_right() const { return right_.hidden(); }  // in the right image
  std::optional<SessionEvent> take_event();                          // event to report; each event once

 private:
  // A point seen shortly before.
  struct Sight {
    PointId point;
    Eigen::Vector2f pixel;     // position of the last search
    Timestamp seen{};          // time of the last sighting
    bool is_in_right = false;  // found in the right image at that time
  };

  static bool has_left_cell(const Eigen::Vector2f& pixel, const Sight& since, const Rig& rig);
  void try_sights(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map);
  void try_sight(const Frame& frame, bool was_in_right, const Sight* now, const Projection& projection, const Rig& rig,
                 const Descriptor& descriptor);

  std::optional<Timestamp> last_;
  std::vector<Sight> sights_;  // ascending by point
  DirtMask left_;
  DirtMask right_;
  double reported_share_ = 0.0;  // sum of the hidden shares of both images at the last report
  std::vector<Sight> now_;       // buffer
  std::vector<Sight> joined_;
  std::vector<DirtTrial> trials_;
  std::vector<DirtTrial> trials_right_;
};

}  // namespace byre
