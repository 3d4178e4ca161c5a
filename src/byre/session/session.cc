#include "byre/session/session.h"

#include "byre/session/stopwatch.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace byre {
namespace {

constexpr double kLeastCorrection = 1e-6;  // metres and radians: less is rounding

bool has_disparities(const Frame& frame) {
  return std::ranges::any_of(frame.features->keypoints(), &Keypoint::has_disparity);
}

}  // namespace

Session::Session(const Rig& rig, const SessionOptions& options, Lanes lanes, std::optional<Vocabulary> vocabulary,
                 std::shared_ptr<const OfflineMap> offline)
    : options_(options),
      rig_(rig),
      executor_(std::move(lanes.local)),
      global_(offline ? make_inline_executor() : std::move(lanes.global), {mapping_options(options)}),
      hindsight_(options.hindsight),
      input_watch_(options.image),
      shutter_(rig.readout_time) {
  if (!offline) options_.map_online = true;  // there is nothing else to track
  if (vocabulary) places_.emplace(std::move(*vocabulary));
  if (!rig.is_stereo() && !offline) initialiser_.emplace(rig, options.monocular_start, mapping_options(options));
  if (!offline) return;
  mission_.emplace(offline, options.mission, options.local_keyframes);
  calibration_executor_ = std::move(lanes.calibration);
  search_.emplace(std::move(lanes.global), offline, options.relocalise);
}

void Session::continue_map(Map online) {
  assert(places_ && !mission_ && anchored_.empty() && online.keyframe_count() > 0);
  online_ = std::move(online);
  initialiser_.reset();
  for (const KeyframeId id : online_.keyframe_ids()) places_->add(id, online_.find_keyframe(id)->words);
  last_keyframe_ = online_.keyframe_ids().back();
  segments_.begin_in_map_frame(0);
  state_ = State::lost;
}

void Session::refine_calibration(const Calibration& given, const SelfCalibrationOptions& options) {
  assert(anchored_.empty());
  if (mission_) {
    mission_calibrator_.emplace(given, options.prior_sigmas, std::move(calibration_executor_));
  } else {
    calibrator_.emplace(given, options);
  }
  refine_readout(RefinedCalibration{given});
}

void Session::refine_readout(const RefinedCalibration& known) {
  assert(anchored_.empty());
  rolling_calibration_ = known;
  shutter_.refine();
}

std::optional<RefinedCalibration> Session::self_calibration() const {
  std::optional<RefinedCalibration> refined;
  if (calibrator_) refined = calibrator_->result();
  if (mission_calibrator_) refined = mission_calibrator_->result();
  if (!rolling_calibration_ || shutter_.readout_time() == rolling_calibration_->calibration.readout_time)
    return refined;
  if (!refined) refined = rolling_calibration_;
  refined->calibration.readout_time = shutter_.readout_time();
  return refined;
}

Frame Session::corrected(const Frame& rectified) const {
  if (calibrator_) return calibrator_->corrected(rectified);
  return mission_calibrator_ ? mission_calibrator_->corrected(rectified) : rectified;
}

// Until the next pose is known the camera is taken to move as it did.
CameraMotion Session::motion() const {
  return {has_pose_ ? velocity_ : Vector6(Vector6::Zero()), scene_depth_};
}

FrameReport Session::process(const Frame& rectified, const std::optional<Pose>& last_from_body) {
  FrameReport report;
  report.time = rectified.time;
  told_motion_ = told_motion_ && last_from_body ? std::optional(*told_motion_ * *last_from_body) : std::nullopt;
  if (!first_frame_) first_frame_ = rectified.time;
  const Stopwatch mapping_before;
  const auto finished = executor_->collect();
  take_over_results(finished, report);
  const Frame frame = shutter_.corrected(corrected(rectified), rig_, motion());
  input_ = input_watch_.look_at(frame);
  start_job();
  const double seconds_before = mapping_before.seconds();

  const Stopwatch tracking;
  const Located located = locate(frame);
  report.track_seconds = tracking.seconds();

  const Stopwatch mapping_after;
  ++frames_since_keyframe_;
  frames_without_depth_ = rig_.is_stereo() && !has_disparities(frame) ? frames_without_depth_ + 1 : 0;
  report.keyframe_added = located.is_new_segment;
  report.start_failure = located.start_failure;
  if (located.is_new_segment) {
    report.events.push_back(segments_.size() == 1 ? SessionEvent::initialised : SessionEvent::restarted);
  }
  if (located.track) {
    remember(frame, *located.track, located.without_prediction, report);
    if (may_map(frame, *located.track)) {
      add_keyframe(frame, *located.track);
      report.keyframe_added = true;
    }
    if (look_for_loop(frame, report.keyframe_added)) report.events.push_back(SessionEvent::loop_found);
    search_beside(frame);
  } else if (!located.is_new_segment) {
    lose_pose(image_fault(frame), report);
  }
  conclude(frame, located, report);
  if (has_pose_) told_motion_ = Pose{};
  if (const auto overdue = hindsight_.take_overdue()) settle(*overdue);
  seen_ = located.track ? byre::seen_points(located.track->tracked) : std::vector<SeenPoint>{};
  report.map_seconds = seconds_before + mapping_after.seconds();
  if (finished) report.job_seconds = finished->seconds;
  return report;
}

void Session::take_over_results(const std::optional<FinishedJob>& finished, FrameReport& report) {
  const bool was_registered = is_registered();
  if (finished) take_over(*finished);
  global_.collect();
  const bool is_shutter_better = take_over_readout();
  if (take_over_calibration() || switch_camera() || is_shutter_better)
    report.events.push_back(SessionEvent::recalibrated);
  if (take_over_correction()) report.events.push_back(SessionEvent::map_corrected);
  if (search_) {
    if (const auto found = search_->collect()) consider_place(*found, report);
  }
  if (correct_online()) report.events.push_back(SessionEvent::online_corrected);
  if (!has_pose_) return;
  const Pose body_now = body_pose(last_camera_from_world());
  odometry_.absorb(last_body_, body_now);
  const Pose correction = body_now * inverse(last_body_);
  if (was_registered && is_registered() && log_pose(correction).norm() > kLeastCorrection)
    report.correction = correction;
  last_body_ = body_now;
}

void Session::take_over(const FinishedJob& job) {
  apply(job.delta, online_);
  local_points_of_.reset();
  forget_places(job.delta);
}

bool Session::take_over_correction() {
  if (!global_.is_waiting() || !executor_->idle()) return false;
  const AppliedCorrection applied = global_.apply(online_);
  forget_places(applied.delta);
  follow(applied.length_changes);
  local_points_of_.reset();
  return true;
}

// What was measured relative to keyframes, in lengths that have changed since.
void Session::follow(const LengthChanges& changes) {
  for (AnchoredPose& pose : anchored_) {
    const auto change = changes.find(pose.keyframe);
    if (change == changes.end()) continue;
    pose.camera_from_keyframe = scale_lengths(pose.camera_from_keyframe, change->second);
    if (&pose == &anchored_.back()) velocity_.head<3>() *= change->second;
  }
  for (LoopEdge& loop : loops_) loop = in_new_lengths(loop, changes);
}

// What is in flight was measured by the calibration before, so that it must be over.
bool Session::take_over_calibration() {
  if (!calibrator_ || !executor_->idle()) return false;
  if (const auto refined = global_.take_calibration()) {
    constexpr double kToAdjust = 0.5;  // sigmas of the parameters: less changes the map by less than its noise
    const bool is_large = (refined->change - calibrator_->state().change).norm() > kToAdjust;
    recalibrate(*refined);
    if (is_large && global_.idle()) global_.close_loops(online_, loops_);
    return true;
  }
  if (!global_.idle() || !calibrator_->is_due(online_.keyframe_count())) return false;
  calibrator_->note_attempt(online_.keyframe_count());
  global_.calibrate(map(), calibrator_->state(), online_.add_rig(rig_), calibrator_->options());
  return false;
}

// Keyframes lie otherwise by it, which a mission's are told by the offline map, and plain SLAM's by each other.
bool Session::take_over_readout() {
  if (!shutter_.has_change() || !executor_->idle() || !global_.idle()) return false;
  shutter_.take_over(rig_, online_);
  local_points_of_.reset();
  loop_.reset();
  if (!mission_ && online_.keyframe_count() > 1) global_.close_loops(online_, loops_);
  return true;
}

// The rectified camera turns, as it is made of the real ones in another way.
void Session::recalibrate(const RefinedCalibration& refined) {
  const int rig = online_.add_rig(rig_);
  const RectifiedChange change = calibrator_->take_over(refined);
  const Pose& turn = change.after_from_before();
  const auto turn_of = [&](KeyframeId id) {
    return id.origin == Origin::online && online_.rig_of(id) == rig ? turn : Pose{};
  };
  online_.recalibrate(rig, change);
  rig_ = change.rig();
  for (AnchoredPose& pose : anchored_) {
    pose.camera_from_keyframe = turn * pose.camera_from_keyframe * inverse(turn_of(pose.keyframe));
  }
  for (LoopEdge& loop : loops_) {
    loop.keyframe_from_place = turn_of(loop.keyframe) * loop.keyframe_from_place * inverse(turn_of(loop.place));
  }
  velocity_ = adjoint(turn) * velocity_;
  loop_.reset();
  local_points_of_.reset();
}

// From here on frames are of another rig; keyframes stay as they were seen.
bool Session::switch_camera() {
  const auto change = mission_calibrator_ ? mission_calibrator_->collect() : std::nullopt;
  if (!change) return false;
  rig_ = change->rig;
  hindsight_.turn_rig(change->after_from_before);
  for (AnchoredPose& pose : anchored_)
    pose.camera_from_keyframe = change->after_from_before * pose.camera_from_keyframe;
  velocity_ = adjoint(change->after_from_before) * velocity_;
  loop_.reset();
  return true;
}

bool Session::correct_online() {
  if (!waiting_correction_ || !executor_->idle()) return false;
  const WaitingCorrection correction = *std::exchange(waiting_correction_, std::nullopt);
  std::vector<KeyframeId> path = online_.keyframe_ids();
  std::erase_if(path, [&](KeyframeId id) {
    return id.number < correction.first_keyframe || segments_.frame(id) != correction.frame;
  });
  apply(correction_of(online_, path, correction.offline_from_online, correction.shape), online_);
  segments_.join_map_frame(correction.frame);
  local_points_of_.reset();
  offset_from_online_.reset();
  if (last_keyframe_ && pending_.empty()) pending_.push_back(*last_keyframe_);
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
  if (pending_.empty() || !executor_->idle() || global_.is_waiting() || waiting_correction_) return;
  MapWindow window = cut_window(map(), pending_, options_.window);
  pending_.clear();
  if (window.keyframes.empty()) return;
  executor_->submit(
      [window = std::move(window), options = mapping_options(options_)] { return extend_map(window, options); });
}

// New keyframes are looked for in older parts of the map; where one seems to be found, the frames after it must be
// found there too. While offline points hold the pose there is no drift that a loop could tell of.
bool Session::look_for_loop(const Frame& frame, bool keyframe_added) {
  if (mission_ && is_registered() && mission_->view() == OfflineView::held) return false;
  if (!places_ || !last_keyframe_ || !global_.idle() || ++frames_since_loop_ < kMinFramesBetweenLoops) {
    return false;
  }
  if (!loop_) {
    if (keyframe_added) loop_ = find_loop(online_, *places_, *last_keyframe_, options_.loops);
    return false;
  }
  loop_ = check_loop(*loop_, frame, last_camera_from_world(), rig_, online_);
  if (is_refuted(*loop_)) loop_.reset();
  if (!loop_ || !is_confirmed(*loop_)) return false;
  settle_loop(*loop_);
  loop_.reset();
  frames_since_loop_ = 0;
  return true;
}

// In a mission it is the offline map that large drift is corrected by.
void Session::settle_loop(const LoopHypothesis& loop) {
  const std::optional<LoopEdge> edge = edge_of(loop, online_);
  if (!edge) return;  // found redundant meanwhile
  const bool fusing_will_do = apparent_drift(loop, online_) <= options_.max_drift_to_fuse;
  if (!fusing_will_do && mission_) return;
  loops_.push_back(*edge);
  if (fusing_will_do) {
    pending_.insert(pending_.begin(), {loop.place, loop.keyframe});
  } else {
    global_.close_loops(online_, loops_);
  }
}

KeyframeEvidence Session::keyframe_evidence(const HybridTrack& track) const {
  KeyframeEvidence evidence;
  evidence.fresh_inliers = fresh_inliers_;
  evidence.frames_since_last = frames_since_keyframe_;
  evidence.without_depth = frames_without_depth_;
  evidence.pending = static_cast<int>(pending_.size());
  evidence.offline_inliers = track.offline_inliers;
  const Pose motion = track.tracked.camera_from_world * inverse(camera_from_world(track.tracked.reference));
  evidence.turn = rotation_log(motion.rotation).norm();
  evidence.shift_share = motion.translation.norm() / std::max(1e-3, median_depth(track.tracked, map()));
  return evidence;
}

void Session::add_keyframe(const Frame& frame, const HybridTrack& track) {
  Keyframe keyframe = make_keyframe(frame, track.tracked, online_.add_rig(rig_));
  keyframe.recording = options_.recording;
  keyframe.parent = track.online_reference;
  const KeyframeId id = online_.add_keyframe(std::move(keyframe));
  add_stereo_points(online_, id, contradicting_features(track.tracked, *frame.features));
  index_place(id);
  shutter_.note_keyframe(id);
  last_keyframe_ = id;
  online_reference_ = id;
  local_points_of_.reset();
  frames_since_keyframe_ = 0;
  reference_.reset();
  pending_.push_back(id);
  anchored_.back().keyframe = id;
  anchored_.back().camera_from_keyframe = Pose{};
  hindsight_.forget_from(anchored_.size() - 1);
  start_job();
}

void Session::finish() {
  if (search_) search_->finish();
  if (mission_calibrator_) mission_calibrator_->finish();
  while (true) {
    if (const auto finished = executor_->finish()) take_over(*finished);
    global_.finish();
    take_over_correction();
    correct_online();
    if (pending_.empty()) return;
    start_job();
  }
}

FinishReport Session::finish_map(const FinishHooks& hooks) {
  assert(places_);
  if (calibrator_ && calibrator_->is_worth_a_last_look(online_.keyframe_count())) {
    const MapWindow whole = whole_map(map());
    const auto refined =
        self_calibrate(whole, calibrator_->state(), online_.add_rig(rig_), calibrator_->options(), hooks.should_stop);
    if (refined) recalibrate(*refined);
  }
  FinishReport report = byre::finish_map(online_, *places_, finish_options(options_), hooks);
  follow(report.length_changes);
  return report;
}

void Session::finish_mission(const FinishHooks& hooks) {
  assert(mission_);
  if (online_.keyframe_count() == 0) return;
  const MapWindow whole = whole_map(map());
  follow(apply_correction(adjust_map(whole, {}, {mapping_options(options_)}, hooks.should_stop), whole, online_));
  while (const auto seen = hindsight_.take_oldest()) settle(*seen);
}

Trajectory Session::final_trajectory() const {
  Trajectory trajectory;
  trajectory.reserve(anchored_.size());
  for (const AnchoredPose& pose : anchored_) {
    if (segments_.frame(pose.segment) != Segments::kMapFrame) continue;
    trajectory.push_back({pose.time, body_pose(pose.camera_from_keyframe * camera_from_world(pose.keyframe))});
  }
  return trajectory;
}

}  // namespace byre
