#pragma once

#include "byre/base/job_slot.h"
#include "byre/slam/frame/dirt_detector.h"
#include "byre/slam/frame/health.h"
#include "byre/slam/frame/image_monitor.h"
#include "byre/slam/frame/state.h"
#include "byre/slam/localisation/offline_tracker.h"
#include "byre/slam/localisation/place_bounds.h"
#include "byre/slam/localisation/pose_filter.h"
#include "byre/slam/mapping/keyframe_policy.h"
#include "byre/slam/mapping/mapper.h"
#include "byre/slam/mapping/rolling_shutter_corrector.h"
#include "byre/slam/session/session_options.h"
#include "byre/slam/session/tracker.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace byre {

// Jobs of the method. local: mapping around new keyframes. index: words of new keyframes, and loop searches. whole_map:
// corrections and calibrations of the whole map. place_search and calibration: missions only.
enum class JobKind : std::uint8_t { local, index, whole_map, place_search, calibration };
inline constexpr std::array kJobKinds{JobKind::local, JobKind::index, JobKind::whole_map, JobKind::place_search,
                                      JobKind::calibration};

// State of the method between two frames. A value without threads and files: a copy continues independently.
struct RobotState {
  // A vocabulary enables place recognition: loop closing and relocalisation. An offline map makes the run a mission: it
  // localises in that map, and its poses are in the map's frame.
  RobotState(const Rig& rig, const SessionOptions& options, std::optional<Vocabulary> vocabulary = {},
             std::shared_ptr<const OfflineMap> offline = nullptr);

  MapView map() const { return mapper.map(); }
  bool is_registered() const { return mapper.submaps().is_registered(); }  // without an offline map: see Mapper::begin
  JobState* job(JobKind kind);                                             // nullptr: the state has no such job

  Rig rig;  // rig of the present frame
  Mapper mapper;
  Tracker tracker;
  std::optional<OfflineTracker> mission;  // empty without an offline map
  ActiveHint hint;
  PoseFilter pose_filter;
  KeyframePolicy keyframe_policy;
  ImageMonitor image_monitor;
  FaultLatches fault_latches;
  DirtDetector dirt_detector;
  RollingShutterCorrector rolling_shutter;
  State status = State::initialising;
  std::optional<Timestamp> first_frame;
  TrustedPlace trusted_place;
  bool is_error_reported = false;  // a navigation error was reported
  bool is_mapping_paused = false;
  std::vector<SeenPoint> seen{};  // points of the last frame
};

}  // namespace byre
