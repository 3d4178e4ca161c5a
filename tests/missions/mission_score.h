#pragma once

#include "byre/alignment.h"
#include "byre/slam/session/session.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

struct MissionFrame {
  FrameReport report;
  std::optional<Pose> true_world_from_body;  // empty outside the truth
};

// Quality of a mission's verdicts. Errors are distances of reported from true positions, metres, in the frame of the
// offline map, which was aligned to the truth when it was made.
struct MissionScore {
  int frames = 0;
  double coverage = 0.0;  // share of frames with a pose, of any verdict
  double trusted = 0.0;
  int wrongly_trusted = 0;              // trusted frames with an error above kMaxTrustedError
  double worst_trusted_error = 0.0;     // infinite for a trusted pose on the wrong map
  double longest_wrong_trust = 0.0;     // longest span of consecutive wrongly trusted poses, seconds
  std::optional<double> recovery;       // seconds from the end of all disturbances to the first trusted pose
  double rmse = 0.0;                    // metres, over all poses with truth
  std::optional<double> time_to_doubt;  // seconds until the expected doubt, see time_to_doubt
  double within_bound = 0.0;            // share of trusted and degraded poses with errors inside the 95 % bound
};

inline constexpr double kMaxTrustedError = 0.2;  // metres

// truth_from_map: empty when the map is of another place, so that every pose is wrong. undisturbed_from: see
// MissionPlan.
MissionScore score(std::span<const MissionFrame> frames, const std::optional<Similarity>& truth_from_map,
                   const std::optional<Timestamp>& undisturbed_from);

// Seconds from a time, or from the first pose after it, to the first frame with this doubt: before a pose there is
// nothing to doubt. Empty if no frame has the doubt.
std::optional<double> time_to_doubt(std::span<const MissionFrame> frames, DistrustReason doubt, Timestamp from);

// Position error, metres: empty without pose or truth, infinite on a map of another place.
std::optional<double> position_error(const MissionFrame& frame, const std::optional<Similarity>& truth_from_map);

}  // namespace byre
