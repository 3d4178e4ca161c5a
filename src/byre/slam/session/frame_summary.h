#pragma once

#include "byre/frame_report.h"
#include "byre/slam/frame/dirt_detector.h"
#include "byre/slam/frame/health.h"
#include "byre/slam/localisation/offline_tracker.h"
#include "byre/slam/localisation/pose_filter.h"
#include "byre/slam/mapping/mapper.h"

namespace byre {

// A frame to track, with evidence against its images.
struct InputFrame {
  Frame frame;
  ImageFault fault = ImageFault::none;
  InputEvidence evidence;
  FrameCuts cuts{};  // skipped work
};

// The state after a frame, from which its report is made.
struct FrameSummary {
  const InputFrame& input;
  const HybridTrack* track = nullptr;  // nullptr: not tracked
  const Rig& rig;
  const PoseFilter& pose_filter;
  const Mapper& mapper;
  const OfflineTracker* mission = nullptr;  // nullptr without an offline map
  const DirtDetector& dirt;
  Timestamp first_frame{};
  DistrustReason refused_place = DistrustReason::none;  // see FrameReport

  bool is_registered() const { return mapper.submaps().is_registered(); }
  // The pose is dead-reckoned from a pose in the map's frame.
  bool is_bridged_in_map() const {
    if (!pose_filter.bridge()) return false;
    const AnchoredTrajectory& trajectory = pose_filter.trajectory();
    return trajectory.empty() || mapper.submaps().frame(trajectory.back().submap) == Submaps::kMapFrame;
  }
};

// Adds the frame's poses, their covariances and the counts of points to a report.
FrameReport fill_poses(FrameReport report, const FrameSummary& summary);

// Evidence of this frame alone, without lasting doubts.
HealthEvidence evidence_of(const FrameSummary& summary);
// Resets non-finite numbers of a report. A non-finite pose is removed, and the verdict is untrusted.
void withhold_non_finite(FrameReport& report);

// Health and verdict of the pose. covariance: of the pose in the map.
Health health_of(const FrameSummary& summary, const Matrix6& covariance, const HealthEvidence& evidence,
                 const HealthOptions& options);

}  // namespace byre
