#pragma once

#include "byre/pose.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// The same motion as wheels tell it and as it was seen, both earlier_from_later.
struct MotionPair {
  Pose base;  // metres
  Pose body;  // in the lengths that the map has
};

// What wheels tell wrongly of turns, always alike: their distance is taken to be another, or one is larger than the
// other (Borenstein and Feng, "Measurement and Correction of Systematic Odometry Errors in Mobile Robots", 1996).
struct TurnErrors {
  double scale = 1.0;      // true turn in a radian that is told
  double per_metre = 0.0;  // radians to the left that a metre ahead, as it is told, adds
};

// The motion of a base without them, earlier_from_later as it is told; of a second at most.
Pose without_turn_errors(const TurnErrors& errors, const Pose& base);

// How the body is mounted on the base whose wheels tell its motion, and how long the map's unit is by them. The base
// drives in its plane, so how high the body lies above it cannot be known, and is taken to be nothing.
struct WheelMounting {
  Pose base_from_body;           // metres
  double metres_per_unit = 1.0;  // metres by the wheels in a unit of the map's lengths
  double scale_sigma = 0.0;      // standard deviation of metres_per_unit as a share of it
  double way_error = 0.0;        // median distance between motions by wheels and by sight, as a share of the way
  // Median of the same among motions to the side, as a share of the way across. Wheels that roll to all sides slide
  // more that way, and tell it wrongly; it is presumed until they went there. Those that drive ahead never go across.
  double side_error = 0.2;
  double turn_error = 0.0;  // median difference of turns, as a share of the turn, without turn_errors
  TurnErrors turn_errors;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // covariance of unknowns_about
};

// What motions tell of a mounting about an axis, upwards, as the body has it: metres_per_unit times the cosine and the
// sine of the angle from the body levelled by that axis to the base, and the lever arm in metres.
Eigen::Vector4d unknowns_about(const WheelMounting& mounting, const Eigen::Vector3d& up_in_body);

// By how much they are another day: tyres wear and are pumped up, and a bracket gives way a little.
Eigen::Matrix4d usual_change(const WheelMounting& mounting);

// The mounting by motions in which the base turned both ways or far, and drove: first the axis about which both turn
// and what is told wrongly of that, then, linear in all that is left, the direction ahead, the lever arm and the scale
// (Heng, Li and Pollefeys, "CamOdoCal", IROS 2013, sections III.A and III.B). Motions that disagree with most, as where
// a wheel slips, count for nothing. Empty while the motions leave it open. known: what was known before; then motions
// that tell little are enough, and it changes by what they tell.
std::optional<WheelMounting> find_wheel_mounting(const std::vector<MotionPair>& motions,
                                                 const std::optional<WheelMounting>& known = {});

// From where it is known which axis points up: an accelerometer has told, or a camera is upright as a rule.
enum class UpSource : std::uint8_t { presumed, measured };

// A guess while the motions leave it open, by little more than a metre of way: the body is upright as far as they do
// not say otherwise, its lever arm is short, and it looks to where they say that is ahead. up_in_body: about, the axis
// that points up. Empty where they do not tell what is ahead.
std::optional<WheelMounting> presume_wheel_mounting(const std::vector<MotionPair>& motions,
                                                    const Eigen::Vector3d& up_in_body,
                                                    UpSource source = UpSource::presumed);

// Metres that a base goes to its left, beside the arc that it drives along: nothing, where its wheels roll ahead alone.
double way_across(const Pose& base);

// A guess before anything is seen: the body is upright, looks to where the base drives, and stands above its middle;
// lengths are metres. Axes in the body, about. Empty where it looks up or down. Its errors say that the body may look
// elsewhere, so that no more than the length of the way is told.
std::optional<WheelMounting> presume_looking_ahead(const Eigen::Vector3d& up_in_body,
                                                   const Eigen::Vector3d& ahead_in_body);

// The body's motion, in the map's lengths, by that of the base as it was.
Pose body_motion(const WheelMounting& mounting, const Pose& base);

}  // namespace byre
