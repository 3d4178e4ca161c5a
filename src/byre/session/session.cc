#include "byre/session/session.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace byre {
namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Session::Session(const Rig& rig, const SessionOptions& options, std::unique_ptr<Executor> executor)
    : rig_(rig), options_(options), executor_(std::move(executor)) {}

FrameReport Session::process(const Frame& frame) {
  const Stopwatch mapping_before;
  const auto finished = executor_->collect();
  if (finished) take_over(*finished);
  start_job();
  const double seconds_before = mapping_before.seconds();

  const Stopwatch tracking;
  std::optional<TrackedFrame> tracked;
  bool keyframe_added = false;
  if (state_ == State::initialising) {
    keyframe_added = initialise(frame);
  } else {
    tracked = find_pose(frame);
  }
  const double tracking_seconds = tracking.seconds();

  const Stopwatch mapping_after;
  ++frames_since_keyframe_;
  state_ = next_state(state_, {last_keyframe_.has_value(), tracked.has_value() || keyframe_added});
  if (tracked) {
    remember(frame, *tracked);
    if (fresh_inliers_ == 0) fresh_inliers_ = static_cast<int>(tracked->features.size());
    if (needs_keyframe(*tracked, keyframe_evidence(*tracked), options_.keyframes)) {
      add_keyframe(frame, *tracked);
      keyframe_added = true;
    }
  }
  FrameReport report = report_of(frame, tracked);
  report.keyframe_added = keyframe_added;
  report.map_seconds = seconds_before + mapping_after.seconds();
  report.track_seconds = tracking_seconds;
  if (finished) report.job_seconds = finished->seconds;
  return report;
}

bool Session::initialise(const Frame& frame) {
  auto first = initialise_stereo(frame, rig_, options_.min_initial_points);
  if (!first) return false;
  online_ = std::move(*first);
  last_keyframe_ = online_.keyframe_ids().front();
  anchored_.push_back({frame.time, *last_keyframe_, Pose{}});
  frames_since_keyframe_ = 0;
  fresh_inliers_ = 0;
  return true;
}

void Session::take_over(const FinishedJob& job) {
  apply(job.delta, online_);
}

void Session::start_job() {
  if (pending_.empty() || !executor_->idle()) return;
  MapWindow window = cut_window(online_, pending_, options_.mapping.window);
  pending_.clear();
  if (window.keyframes.empty()) return;
  executor_->submit([window = std::move(window), options = options_.mapping] { return extend_map(window, options); });
}

Pose Session::last_camera_from_world() const {
  const AnchoredPose& last = anchored_.back();
  return last.camera_from_keyframe * online_.camera_from_world(last.keyframe);
}

Pose Session::predict(Timestamp time) const {
  const double elapsed = to_seconds(time - anchored_.back().time);
  return exp_pose(velocity_ * elapsed) * last_camera_from_world();
}

std::optional<TrackedFrame> Session::find_pose(const Frame& frame) const {
  // Mapping may have removed the last frame's keyframe since, but never the newest.
  const KeyframeId last_reference = anchored_.back().keyframe;
  const KeyframeId reference = online_.find_keyframe(last_reference) != nullptr ? last_reference : *last_keyframe_;
  const std::vector<PointId> candidates = local_points(map(), reference, options_.local_keyframes);
  const Pose predicted = state_ == State::tracking ? predict(frame.time) : last_camera_from_world();
  auto best = track(frame, predicted, rig_, map(), candidates, options_.track);
  const auto inliers = [](const std::optional<TrackedFrame>& tracked) {
    return tracked ? tracked->features.size() : 0;
  };
  // A sudden loss of matches may mean that the prediction led astray: look again without it.
  if (static_cast<double>(inliers(best)) >= options_.min_kept_share * last_inliers_) return best;
  for (const KeyframeId keyframe : {reference, *last_keyframe_}) {
    const auto pose = pose_from_keyframe(frame, rig_, map(), keyframe);
    if (!pose) continue;
    auto tracked = track(frame, *pose, rig_, map(), candidates, options_.track);
    if (inliers(tracked) > inliers(best)) best = std::move(tracked);
  }
  return best;
}

void Session::remember(const Frame& frame, const TrackedFrame& tracked) {
  const double elapsed = to_seconds(frame.time - anchored_.back().time);
  const Pose motion = tracked.camera_from_world * inverse(last_camera_from_world());
  velocity_ = elapsed > 0.0 ? Vector6(log_pose(motion) / elapsed) : Vector6::Zero();
  last_inliers_ = static_cast<int>(tracked.features.size());
  anchored_.push_back({frame.time, tracked.reference,
                       tracked.camera_from_world * inverse(online_.camera_from_world(tracked.reference))});
}

KeyframeEvidence Session::keyframe_evidence(const TrackedFrame& tracked) const {
  KeyframeEvidence evidence;
  evidence.fresh_inliers = fresh_inliers_;
  evidence.frames_since_last = frames_since_keyframe_;
  evidence.pending = static_cast<int>(pending_.size());
  const Pose motion = tracked.camera_from_world * inverse(online_.camera_from_world(*last_keyframe_));
  evidence.turn = rotation_log(motion.rotation).norm();
  evidence.shift_share = motion.translation.norm() / std::max(1e-3, median_depth(tracked, map()));
  return evidence;
}

void Session::add_keyframe(const Frame& frame, const TrackedFrame& tracked) {
  const KeyframeId id = online_.add_keyframe(make_keyframe(frame, tracked, online_.add_rig(rig_)));
  add_stereo_points(online_, id);
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  fresh_inliers_ = 0;
  pending_.push_back(id);
  anchored_.back().keyframe = id;
  anchored_.back().camera_from_keyframe = Pose{};
  start_job();
}

FrameReport Session::report_of(const Frame& frame, const std::optional<TrackedFrame>& tracked) const {
  FrameReport report;
  report.time = frame.time;
  report.state = state_;
  report.features = frame.features->size();
  if (state_ == State::tracking) {
    report.world_from_body = inverse(rig_.body_from_camera * last_camera_from_world());
  }
  if (!tracked) return report;
  report.expected_points = tracked->expected;
  report.matches = tracked->matches;
  report.inliers = static_cast<int>(tracked->features.size());
  // Points and keyframes share errors that their single covariances know nothing of; found on simulated missions.
  constexpr double kNeglectedCorrelation = 1.1;
  report.covariance = kNeglectedCorrelation * move_covariance(tracked->covariance, rig_.body_from_camera);
  return report;
}

void Session::finish() {
  while (true) {
    if (const auto finished = executor_->finish()) take_over(*finished);
    if (pending_.empty()) return;
    start_job();
  }
}

Trajectory Session::final_trajectory() const {
  Trajectory trajectory;
  trajectory.reserve(anchored_.size());
  for (const AnchoredPose& pose : anchored_) {
    const Pose camera_from_world = pose.camera_from_keyframe * online_.camera_from_world(pose.keyframe);
    trajectory.push_back({pose.time, inverse(rig_.body_from_camera * camera_from_world)});
  }
  return trajectory;
}

}  // namespace byre
