#pragma once

#include "byre/benchmark/measures.h"
#include "byre/benchmark/protocol.h"
#include "byre/slam/frame/health.h"
#include "byre/viewer/picture.h"

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace byre {

// State of an arm after a frame. Positions are x and y on the floor plan, metres.
struct DemoMoment {
  double time_s = 0.0;  // from the first frame
  bool has_pose = false;
  Verdict verdict = Verdict::untrusted;
  int offline_inliers = 0;
  int online_inliers = 0;
  double position_sigma = 0.0;  // metres, see Health
  Eigen::Vector2d truth = Eigen::Vector2d::Zero();
  // Published position. Without a map: after the best alignment of the whole path to the truth, which favours the arm.
  // Empty without a pose.
  std::optional<Eigen::Vector2d> position{};
  std::optional<double> error{};  // metres, of that position in space
};

// Run of the second visit by one arm. No arm is given a true pose.
struct DemoArm {
  Arm arm = Arm::hybrid;
  RunMeasures measures;  // without a map, errors are measured after alignment only
  std::vector<DemoMoment> moments;

  bool is_on_plan() const { return arm != Arm::no_map; }
};

// Figures of positions on the plan. All zero or empty without a map: poses then have no place on the plan.
struct PlanFigures {
  double placed_share = 0.0;  // share of all frames with a position
  double close_share = 0.0;   // share of all frames with a position within kCloseMetres of the truth
  double trusted_share = 0.0;
  int wrong = 0;                // trusted frames with an error above kFarMetres
  Figure found_s;               // time of the first trusted position, from the first frame
  Figure median_error;          // metres
  Figure aligned_median_error;  // metres; without a map only, see DemoMoment::position
};
PlanFigures plan_figures(const DemoArm& arm);

inline constexpr double kCloseMetres = 0.1;

struct TimeSpan {
  double begin_s = 0.0;
  double end_s = 0.0;
};

// Corners of a thing on the plan by day and in the second visit.
struct MovedThing {
  std::vector<Eigen::Vector2d> before;
  std::vector<Eigen::Vector2d> after;
};

struct DemoFindings {
  int map_frames = 0;  // frames of the first visit
  int map_keyframes = 0;
  int map_points = 0;
  double map_ate = 0.0;  // metres RMSE, final poses
  int picks = 0;
  std::vector<DemoArm> arms;
  std::vector<TimeSpan> off_the_map;  // spans in which the robot was outside the first visit's area
  Picture mission_picture;            // arms on the plan, see mission_picture.h
  std::string plan_picture;           // SVG
  std::string camera_picture;         // SVG
  std::optional<double> camera_s;     // time of the camera picture, from the first frame
  std::vector<Picture> animation;     // frames; empty unless requested
  double rendering_s = 0.0;           // wall time
  double total_s = 0.0;
};

}  // namespace byre
