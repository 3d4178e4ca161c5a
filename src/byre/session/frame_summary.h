#pragma once

#include "byre/frame_report.h"
#include "byre/localisation/offline_tracker.h"
#include "byre/localisation/whereabouts.h"
#include "byre/mapping/mapper.h"
#include "byre/slam/health.h"
#include "byre/slam/lens_watch.h"

namespace byre {

// A frame as it is tracked, and what speaks against its images.
struct InputFrame {
  Frame frame;
  ImageFault fault = ImageFault::none;
  InputEvidence evidence;
  FrameCuts cuts{};  // what is left out of it
};

// All that is told of a frame, once the session has taken it in.
struct FrameSummary {
  const InputFrame& input;
  const HybridTrack* track = nullptr;  // where it was tracked
  const Rig& rig;
  const Whereabouts& whereabouts;
  const Mapper& mapper;
  const OfflineTracker* mission = nullptr;  // on an offline map
  const LensWatch& lens;
  Timestamp first_frame{};
  Doubt refused_place = Doubt::none;  // see FrameReport

  bool is_registered() const { return mapper.submaps().is_registered(); }
  // The pose goes on by what is told, from one in the map.
  bool is_bridged_in_map() const {
    if (!whereabouts.bridge()) return false;
    const AnchoredTrajectory& trajectory = whereabouts.trajectory();
    return trajectory.empty() || mapper.submaps().frame(trajectory.back().submap) == Submaps::kMapFrame;
  }
};

// A report with the frame's poses, their covariances and the counts of points in it.
FrameReport described(FrameReport report, const FrameSummary& summary);

// Evidence of a frame by itself, without lasting doubts.
HealthEvidence evidence_of(const FrameSummary& summary);
// Removes numbers that are not finite from a report. A pose with such numbers is withheld, with the verdict untrusted.
void withhold_non_finite(FrameReport& report);

// How far the pose may be relied on. covariance: of the pose in the map.
Health health_of(const FrameSummary& summary, const Matrix6& covariance, const HealthEvidence& evidence,
                 const HealthOptions& options);

}  // namespace byre
