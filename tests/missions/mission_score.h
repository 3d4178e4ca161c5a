#pragma once

#include "byre/alignment.h"
#include "byre/session/session.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

// What a session said of one frame, and where the robot was.
struct MissionFrame {
  FrameReport report;
  std::optional<Pose> true_world_from_body;  // empty where the truth does not reach
};

// What the verdicts of a mission were worth. An error is the distance of the reported position from the true one, in
// the frame of the offline map, which was aligned to the truth when it was made; metres.
struct MissionScore {
  int frames = 0;
  double coverage = 0.0;             // share of frames with a pose, whatever their verdict
  double trusted = 0.0;              // share of frames that are trusted
  int wrongly_trusted = 0;           // frames that are trusted and off by more than kMaxTrustedError
  double worst_trusted_error = 0.0;  // infinite for a trusted pose on the wrong map
  double longest_wrong_trust = 0.0;  // seconds in a row in which poses off by more than kMaxTrustedError were trusted
  std::optional<double> recovery;    // seconds from when nothing disturbs any more to the first trusted pose
  double rmse = 0.0;                 // metres, over all poses whose truth is known
  std::optional<double> time_to_doubt;  // seconds until the doubt asked for is told, see time_to_doubt
  double within_bound = 0.0;  // share of errors inside the 95 % bound of the covariance; untrusted poses apart
};

inline constexpr double kMaxTrustedError = 0.2;  // metres

// truth_from_map: empty when the map is of another place, where no pose can be right. undisturbed_from: see
// MissionPlan.
MissionScore score(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map,
                   const std::optional<Timestamp>& undisturbed_from);

// Seconds until the first frame with this doubt, from then, or from the first pose if that comes later: without a pose
// nobody steers by one. Empty where none has it.
std::optional<double> time_to_doubt(std::span<const MissionFrame> frames, Doubt doubt, Timestamp from);

// Metres that the pose of a report is off: empty without pose or truth, infinite on a map of another place.
std::optional<double> position_error(const MissionFrame& frame, const std::optional<Similarity>& truth_from_map);

}  // namespace byre
