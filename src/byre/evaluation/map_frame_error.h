#pragma once

#include "byre/trajectory_error.h"

#include <vector>

namespace byre {

// Where the frame of a map lies in that of the truth.
struct MapAlignment {
  Similarity truth_from_map;
  int poses = 0;  // poses that the alignment rests on; zero: the truth is taken for given in the map's frame
  std::vector<PosePair> path{};  // poses that the alignment rests on; estimated ones in the map's frame
};

// Aligns a map to the truth by its own poses: its keyframes (keyframe_path), or all frames of the run that made it, but
// never poses found or tracked in it. Least squares of positions (Umeyama 1991). The positions of a straight path leave
// the rotation about it open, so that rotation is taken from the orientations. Fewer than three poses with truth are
// not aligned. map_truth: true poses at their times.
MapAlignment align_to_truth(const Trajectory& world_from_body, Scale scale, const Trajectory& map_truth);

// How far an estimated pose is from the truth.
struct PoseError {
  Timestamp time{};
  Vector6 delta = Vector6::Zero();  // world_from_body * exp_pose(delta) is the true pose

  double position() const { return delta.head<3>().norm(); }  // metres, or the unit of the truth
  double rotation() const;                                    // degrees
};

// Errors of the poses that have truth, each as it is in the map's frame: nothing is aligned but the map.
std::vector<PoseError> errors_in_map(const Trajectory& world_from_body, const Trajectory& truth,
                                     const MapAlignment& alignment);

// Errors of the map's own poses, by which it was aligned: how exact the map is in itself.
std::vector<PoseError> errors_of_map(const MapAlignment& alignment);

// What is left of errors in the map when its own error at the nearest of its poses is taken off, for position: how well
// it is known where in the map the robot is, however exact that is. Only of poses within a metre of the map's, or so
// many of the truth's units.
std::vector<PoseError> errors_beside_map(const Trajectory& world_from_body, const Trajectory& truth,
                                         const MapAlignment& alignment);

// The error at that very time; nullptr when it has no truth. Precondition: errors are in order of time.
const PoseError* find_error(const std::vector<PoseError>& errors, Timestamp time);

ErrorStatistics position_statistics(const std::vector<PoseError>& errors);  // metres, or the unit of the truth
ErrorStatistics rotation_statistics(const std::vector<PoseError>& errors);  // degrees

}  // namespace byre
