#pragma once

#include "byre/evaluation/map_frame_error.h"
#include "byre/playback/localise_run.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Errors in the map's frame: the map is aligned to the truth once, by its own keyframes, not by what was localised.
struct LocalisationErrors {
  std::vector<PoseError> errors;  // errors of the frames that were found and have truth
  int alignment_keyframes = 0;    // zero: the truth is taken for given in the map's frame
};

// map_truth holds the truth at the times of the map's keyframes, where it does: with less than three of them aligned
// nothing is.
LocalisationErrors errors_in_map(const LocaliseRun& run, const StoredMap& stored, const Trajectory& map_truth,
                                 const Trajectory& truth);

// How the run was made.
struct LocaliseProtocol {
  std::string map;
  std::string input;                          // recording, or number of images
  int frames = 0;                             // number of frames asked for
  std::optional<PlanRegistration> plan = {};  // place of the map on its plan, when poses are wanted on it too
};

std::string to_text(const LocaliseRun& run, const LocaliseProtocol& protocol,
                    const std::optional<LocalisationErrors>& errors);
// With an object for each frame.
std::string to_json(const LocaliseRun& run, const LocaliseProtocol& protocol,
                    const std::optional<LocalisationErrors>& errors);

}  // namespace byre
