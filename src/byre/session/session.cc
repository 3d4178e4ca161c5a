#include "byre/session/session.h"

#include <cassert>
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

Session::Session(const Rig& rig, const SessionOptions& options, Lanes lanes, std::optional<Vocabulary> vocabulary,
                 std::shared_ptr<const OfflineMap> offline)
    : rig_(rig),
      options_(options),
      offline_(std::move(offline)),
      executor_(std::move(lanes.local)),
      global_(std::move(lanes.global), options.global) {
  if (vocabulary) places_.emplace(std::move(*vocabulary));
}

void Session::continue_map(Map online) {
  assert(places_ && anchored_.empty() && online.keyframe_count() > 0);
  online_ = std::move(online);
  for (const KeyframeId id : online_.keyframe_ids()) places_->add(id, online_.find_keyframe(id)->words);
  last_keyframe_ = online_.keyframe_ids().back();
  state_ = State::lost;
}

FrameReport Session::process(const Frame& frame) {
  const Stopwatch mapping_before;
  const auto finished = executor_->collect();
  if (finished) take_over(*finished);
  global_.collect();
  const bool map_corrected = take_over_correction();
  start_job();
  const double seconds_before = mapping_before.seconds();

  const Stopwatch tracking;
  const bool was_lost = state_ == State::lost;
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
  bool loop_found = false;
  if (tracked) {
    remember(frame, *tracked, was_lost);
    if (needs_keyframe(*tracked, keyframe_evidence(*tracked), options_.keyframes)) {
      add_keyframe(frame, *tracked);
      keyframe_added = true;
    }
    loop_found = look_for_loop(frame, keyframe_added);
  }
  FrameReport report = report_of(frame, tracked);
  report.keyframe_added = keyframe_added;
  if (map_corrected) report.events.push_back(SessionEvent::map_corrected);
  if (was_lost && tracked) report.events.push_back(SessionEvent::relocalised);
  if (loop_found) report.events.push_back(SessionEvent::loop_found);
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
  index_place(*last_keyframe_);
  anchored_.push_back({frame.time, *last_keyframe_, Pose{}});
  frames_since_keyframe_ = 0;
  reference_.reset();
  return true;
}

void Session::take_over(const FinishedJob& job) {
  apply(job.delta, online_);
  forget_places(job.delta);
}

bool Session::take_over_correction() {
  if (!global_.is_waiting() || !executor_->idle()) return false;
  forget_places(global_.apply(online_));
  return true;
}

void Session::index_place(KeyframeId id) {
  if (!places_) return;
  online_.set_words(id, places_->vocabulary().words_of(*online_.find_keyframe(id)->frame.features));
  places_->add(id, online_.find_keyframe(id)->words);
}

void Session::forget_places(const MapDelta& delta) {
  if (!places_) return;
  for (const OnlineKeyframeId id : delta.removed_keyframes) places_->remove(id);
}

// A waiting correction goes first: what a job would work on is about to move.
void Session::start_job() {
  if (pending_.empty() || !executor_->idle() || global_.is_waiting()) return;
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
  if (state_ == State::lost && places_) return relocalise(frame);
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

std::optional<TrackedFrame> Session::relocalise(const Frame& frame) const {
  return localise(frame, rig_, map(), *places_, options_.relocalise).tracked;
}

// New keyframes are looked for in older parts of the map; where one seems to be found, the frames after it must be
// found there too.
bool Session::look_for_loop(const Frame& frame, bool keyframe_added) {
  if (!places_ || !global_.idle() || ++frames_since_loop_ < options_.loops.min_frames_between) return false;
  if (!loop_) {
    if (keyframe_added) loop_ = find_loop(online_, *places_, *last_keyframe_, options_.loops);
    return false;
  }
  loop_ = check_loop(*loop_, frame, last_camera_from_world(), rig_, online_, options_.loops);
  if (is_refuted(*loop_, options_.loops)) loop_.reset();
  if (!loop_ || !is_confirmed(*loop_, options_.loops)) return false;
  settle_loop(*loop_);
  loop_.reset();
  frames_since_loop_ = 0;
  return true;
}

void Session::settle_loop(const LoopHypothesis& loop) {
  const std::optional<LoopEdge> edge = edge_of(loop, online_);
  if (!edge) return;  // found redundant meanwhile
  loops_.push_back(*edge);
  if (apparent_drift(loop, online_) > options_.max_drift_to_fuse) {
    global_.close_loops(online_, loops_);
  } else {
    pending_.insert(pending_.begin(), {loop.place, loop.keyframe});
  }
}

Vector6 Session::velocity_to(Timestamp time, const Pose& camera_from_world) const {
  const double elapsed = to_seconds(time - anchored_.back().time);
  if (elapsed <= 0.0) return Vector6::Zero();
  return log_pose(camera_from_world * inverse(last_camera_from_world())) / elapsed;
}

void Session::remember(const Frame& frame, const TrackedFrame& tracked, bool was_lost) {
  velocity_ = was_lost ? Vector6::Zero() : velocity_to(frame.time, tracked.camera_from_world);
  last_inliers_ = static_cast<int>(tracked.features.size());
  if (reference_ != tracked.reference) fresh_inliers_ = last_inliers_;
  reference_ = tracked.reference;
  anchored_.push_back({frame.time, tracked.reference,
                       tracked.camera_from_world * inverse(online_.camera_from_world(tracked.reference))});
}

KeyframeEvidence Session::keyframe_evidence(const TrackedFrame& tracked) const {
  KeyframeEvidence evidence;
  evidence.fresh_inliers = fresh_inliers_;
  evidence.frames_since_last = frames_since_keyframe_;
  evidence.pending = static_cast<int>(pending_.size());
  const Pose motion = tracked.camera_from_world * inverse(online_.camera_from_world(tracked.reference));
  evidence.turn = rotation_log(motion.rotation).norm();
  evidence.shift_share = motion.translation.norm() / std::max(1e-3, median_depth(tracked, map()));
  return evidence;
}

void Session::add_keyframe(const Frame& frame, const TrackedFrame& tracked) {
  Keyframe keyframe = make_keyframe(frame, tracked, online_.add_rig(rig_));
  keyframe.recording = options_.recording;
  const KeyframeId id = online_.add_keyframe(std::move(keyframe));
  add_stereo_points(online_, id);
  index_place(id);
  last_keyframe_ = id;
  frames_since_keyframe_ = 0;
  reference_.reset();
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
    report.map_from_body = inverse(rig_.body_from_camera * last_camera_from_world());
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
    global_.finish();
    take_over_correction();
    if (pending_.empty()) return;
    start_job();
  }
}

FinishReport Session::finish_map(const FinishOptions& options, const FinishHooks& hooks) {
  assert(places_);
  return byre::finish_map(online_, *places_, options, hooks);
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
