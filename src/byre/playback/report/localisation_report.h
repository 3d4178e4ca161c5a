#pragma once

#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/playback/localise_run.h"
#include "byre/playback/report/report.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Errors in the map's frame. The map is aligned to the truth once, by its keyframes, never by localised poses.
struct LocalisationErrors {
  std::vector<PoseError> errors;  // errors of localised frames with truth
  int alignment_keyframes = 0;    // 0: the truth is assumed to be in the map's frame
};

// map_truth: truth at the times of the map's keyframes. With fewer than three of them nothing is aligned.
LocalisationErrors errors_in_map(const LocaliseRun& run, const StoredMap& stored, const Trajectory& map_truth,
                                 const Trajectory& truth);

struct LocaliseProtocol {
  std::string map;
  std::string input;  // recording, or number of images
  int frames = 0;
  std::optional<PlanRegistration> plan = {};  // registration of the map, for poses on the plan
};

// Figures include an object per frame.
Report localisation_report(const LocaliseRun& run, const LocaliseProtocol& protocol,
                           const std::optional<LocalisationErrors>& errors);

}  // namespace byre
