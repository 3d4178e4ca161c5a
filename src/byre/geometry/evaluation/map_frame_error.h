#pragma once

#include "byre/trajectory_error.h"

#include <vector>

namespace byre {

struct MapAlignment {
  Similarity truth_from_map;
  int poses = 0;                 // number of poses aligned; 0: the truth is assumed to be in the map's frame
  std::vector<PosePair> path{};  // aligned poses; estimated ones in the map's frame
};

// Aligns a map to the truth by its own poses: its keyframes (keyframe_path), or all frames of the mapping run, never
// poses localised or tracked in it. Least squares of positions (Umeyama 1991). Positions on a straight path leave the
// rotation about it undetermined; that rotation is then taken from the orientations. Needs three poses with truth.
// map_truth: true poses at their times.
MapAlignment align_to_truth(const Trajectory& world_from_body, Scale scale, const Trajectory& map_truth);

// Error of an estimated pose.
struct PoseError {
  Timestamp time{};
  Vector6 delta = Vector6::Zero();  // world_from_body * exp_pose(delta) is the true pose

  double position() const { return delta.head<3>().norm(); }  // metres, or the truth's unit
  double rotation() const;                                    // degrees
};

// Errors of the poses with truth in the map's frame. Only the map is aligned.
std::vector<PoseError> errors_in_map(const Trajectory& world_from_body, const Trajectory& truth,
                                     const MapAlignment& alignment);

// Errors of the map's own poses after alignment: the accuracy of the map.
std::vector<PoseError> errors_of_map(const MapAlignment& alignment);

// Errors with the map's position error at its nearest pose subtracted: localisation accuracy relative to the map. Only
// for poses within one metre (or unit of the truth) of a map pose.
std::vector<PoseError> errors_relative_to_map(const Trajectory& world_from_body, const Trajectory& truth,
                                              const MapAlignment& alignment);

// Error at exactly this time; nullptr without truth. Precondition: errors are in order of time.
const PoseError* find_error(const std::vector<PoseError>& errors, Timestamp time);

ErrorStatistics position_statistics(const std::vector<PoseError>& errors);  // metres, or the truth's unit
ErrorStatistics rotation_statistics(const std::vector<PoseError>& errors);  // degrees

}  // namespace byre
