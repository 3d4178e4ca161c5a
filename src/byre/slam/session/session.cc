#include "byre/slam/session/session.h"

#include "byre/base/stopwatch.h"
#include "byre/geometry/finite.h"
#include "byre/slam/tracking/body_pose.h"

#include <cassert>

namespace byre {
namespace {

// True without an offline map.
bool is_registered(const Mapper& mapper) {
  return mapper.submaps().is_registered();
}

}  // namespace

Session::Session(const Rig& rig, const SessionOptions& options, SessionExecutors executors,
                 std::optional<Vocabulary> vocabulary, std::shared_ptr<const OfflineMap> offline)
    : options_(options),
      rig_(rig),
      mapper_(rig, mapper_options(options),
              {std::move(executors.local), offline ? make_inline_executor() : std::move(executors.global),
               std::move(executors.reading)},
              {std::move(vocabulary), offline}),
      tracker_(options),
      pose_filter_(options.mission.registration, options.deferred_refinement, options.trajectory, offline != nullptr),
      image_monitor_(options.image),
      rolling_shutter_(rig.readout_time),
      trusted_place_(options.mission.registration.max_speed) {
  if (offline) {
    mission_.emplace(std::move(offline),
                     OfflineTrackerOptions{options.mission, options.track, options.relocalise, options.local_keyframes,
                                           options.is_planar},
                     OfflineTracker::Executors{std::move(executors.global), std::move(executors.calibration)});
  } else {
    options_.map_online = true;  // no other map to track on
  }
}

void Session::continue_map(Map online) {
  assert(pose_filter_.trajectory().empty());
  mapper_.continue_map(std::move(online));
  state_ = State::lost;
}

void Session::refine_calibration(const Calibration& given, const SelfCalibrationOptions& options) {
  mission_ ? mission_->refine_calibration(given, options.prior_sigmas) : mapper_.refine_calibration(given, options);
  refine_readout(RefinedCalibration{given});
}

void Session::refine_readout(const RefinedCalibration& known) {
  assert(pose_filter_.trajectory().empty());
  rolling_shutter_.refine(known);
}

std::optional<RefinedCalibration> Session::self_calibration() const {
  if (mapper_.calibrator()) return rolling_shutter_.refined(mapper_.calibrator()->result());
  if (mission_ && mission_->calibrator()) return rolling_shutter_.refined(mission_->calibrator()->result());
  return rolling_shutter_.refined({});
}

FrameReport Session::process(const Frame& rectified, const std::optional<BodyMotion>& motion, FrameBudget* budget) {
  FrameReport report;
  report.time = rectified.time;
  if (!first_frame_) first_frame_ = rectified.time;
  pose_filter_.add_odometry(motion);
  hint_.expire(rectified.time);
  const Stopwatch mapping_before;
  apply_finished_jobs(report);
  InputFrame input = input_of(rectified, motion);
  mapper_.start_job();
  const double seconds_before = mapping_before.seconds();

  if (budget != nullptr) input.cuts = budget->begin_tracking();
  const Stopwatch tracking;
  const Located located = locate(input);
  report.track_seconds = tracking.seconds();
  const TrackedFrame* const tracked = located.track ? &located.track->tracked : nullptr;
  input.evidence.out_of_sync = image_monitor_.out_of_sync(input.frame, rig_, tracked, map());
  if (budget != nullptr && located.track) budget->note_tracked();

  const Stopwatch mapping_after;
  keyframe_policy_.note_frame(input.frame, rig_);
  report.start_failure = located.start_failure;
  if (located.refused != DistrustReason::none) report.refused_place = located.refused;
  report.keyframe_added = located.begins_submap;
  if (located.track) {
    remember(input, located, report);
    update_dirt_mask(input, located, report);
    extend_map(input, *located.track, report);
  } else if (located.begins_submap) {
    const bool is_first = mapper_.submaps().size() == 1;
    report.events.push_back(is_first ? SessionEvent::initialised : SessionEvent::restarted);
  } else {
    lose_pose(input.fault, report);
    pose_filter_.propagate(rectified.time, rig_, map(),
                           mission_ ? mission_->ground_under(pose_filter_, mapper_) : nullptr);
  }

  if (budget != nullptr && (!located.track || keyframe_policy_.is_short())) budget->keep_next_whole();

  const double seconds_without = to_seconds(rectified.time - pose_filter_.last_confirmed().value_or(*first_frame_));
  const bool is_confirmed = pose_filter_.place().is_confirmed();
  const FrameSummary summary{input,
                             located.track ? &*located.track : nullptr,
                             rig_,
                             pose_filter_,
                             mapper_,
                             mission_ ? &*mission_ : nullptr,
                             dirt_detector_,
                             *first_frame_,
                             report.refused_place};
  state_ = next_state(state_, {pose_filter_.has_pose(), is_confirmed, seconds_without}, options_.state);
  report = fill_poses(std::move(report), summary);
  report.state = state_;
  const HealthEvidence evidence = fault_latches_.latch(rectified.time, evidence_of(summary));
  report.health = health_of(summary, report.covariance, evidence, options_.health);
  withhold_non_finite(report);
  note_quality(report);
  if (trusted_place_.is_new_refusal(report.refused_place, report.health.verdict)) {
    report.events.push_back(SessionEvent::place_refused);
  }
  const bool is_error = mission_ ? seconds_without >= options_.state.lost_after : state_ == State::lost;
  if (!std::exchange(is_error_reported_, is_error) && is_error) report.events.push_back(SessionEvent::navigation_error);

  pose_filter_.refine_overdue(map(), options_.track);
  seen_.clear();
  if (located.track) append_seen_points(located.track->tracked, seen_);
  mapper_.start_reading();
  report.map_seconds = seconds_before + mapping_after.seconds();
  return report;
}

// Stored only for a confirmed pose, and used for poses predicted from it.
void Session::note_quality(const FrameReport& report) {
  if (!pose_filter_.has_pose() || !report.map_from_body || !pose_filter_.place().is_confirmed()) return;
  pose_filter_.note_quality({report.covariance, report.odometry_covariance, report.health.verdict});
  if (mission_ && report.health.verdict == Verdict::trusted) trusted_place_.note({report.time, *report.map_from_body});
}

void Session::apply_finished_jobs(FrameReport& report) {
  constexpr double kLeastCorrection = 1e-6;  // metres and radians; smaller values are rounding
  mapper_.collect_reading();
  if (mapper_.is_being_read()) return;
  const bool was_registered = is_registered(mapper_);
  report.job_seconds = mapper_.collect();
  const bool is_shutter_better = mapper_.apply_readout_change(rolling_shutter_, rig_);
  if (apply_camera_change() || is_shutter_better) report.events.push_back(SessionEvent::recalibrated);
  if (const auto changes = mapper_.apply_map_optimisation()) {
    pose_filter_.apply_length_changes(*changes);
    pose_filter_.forget_carried();
    report.events.push_back(SessionEvent::map_corrected);
  }
  if (mission_) apply_place_search(report);
  if (const auto offline_from_online = mapper_.correct_online()) {
    pose_filter_.note_online_correction();
    if (!was_registered && is_registered(mapper_)) {
      pose_filter_.note_registration(*offline_from_online, hint_.get().has_value());
    }
    report.events.push_back(SessionEvent::online_corrected);
  }
  const auto correction = pose_filter_.apply_map_correction(rig_, map());
  if (!correction || !was_registered || !is_registered(mapper_)) return;
  if (log_pose(*correction).norm() > kLeastCorrection) report.correction = correction;
}

void Session::apply_place_search(FrameReport& report) {
  const std::optional<PlaceSearch> search = mission_->collect_place();
  if (search) report.refused_place = search->refused;
  const OfflineTracker::MissionUpdate update = mission_->process_search(search, pose_filter_, mapper_);
  if (update.correction) mapper_.correct_later(*update.correction);
  if (update.agrees_with_hint) pose_filter_.note_agreement();
  if (update.refutes_pose) {
    if (pose_filter_.is_by_hint()) hint_.clear();
    mapper_.leave_map_frame();
    lose_pose(ImageFault::none, report);
  }
  if (update.refutes_earlier_poses) {
    pose_filter_.reset();
    trusted_place_.forget();
    report.events.push_back(SessionEvent::place_refuted);
  }
}

// A correction of the online map's own calibration turns its keyframes as well. In a mission frames have a new rig from
// here on, and keyframes keep theirs.
bool Session::apply_camera_change() {
  if (const auto turn = mapper_.apply_calibration(rig_)) {
    apply_rig_rotation(*turn);
    return true;
  }
  const auto change = mission_ ? mission_->collect_camera() : std::nullopt;
  if (!change) return false;
  rig_ = change->rig;
  pose_filter_.rotate_camera(change->after_from_before);
  mapper_.forget_loop();
  return true;
}

void Session::apply_rig_rotation(const RigRotation& turn) {
  rig_ = turn.after;
  pose_filter_.rotate_rig(turn, mapper_.online());
}

InputFrame Session::input_of(const Frame& rectified, const std::optional<BodyMotion>& motion) {
  Frame frame = mapper_.corrected(rectified);
  if (mission_) frame = mission_->corrected(frame);
  const InputEvidence evidence = image_monitor_.check(frame, rig_, {motion, pose_filter_.camera_motion()});
  frame = rolling_shutter_.corrected(frame, rig_, pose_filter_.camera_motion());
  const ImageFault fault = frame.condition ? fault_of(*frame.condition, options_.image) : ImageFault::none;
  mapper_.note_images(evidence.cameras_disagree);
  return {std::move(frame), fault, evidence};
}

// Puts the place with the highest log-odds first, by this frame and, at a place that continues a test, by those before.
void Session::sort_by_log_odds(std::vector<HybridTrack>& places, const Frame& frame) {
  if (places.size() < 2) return;
  std::vector<double> log_odds;
  for (const HybridTrack& found : places) {
    const Pose body = body_pose(rig_, found.tracked.camera_from_world);
    PlaceHypothesis place = pose_filter_.hypothesis_of_relocalisation(
        frame.time, body, mission_->find_place_test(frame.time, found.tracked.camera_from_world), rig_, map());
    place.observe(mission_->view_of(frame, found, rig_, dirt_detector_.hidden(), false), true);
    log_odds.push_back(place.log_odds());
  }
  std::swap(places.front(), places[static_cast<std::size_t>(std::ranges::max_element(log_odds) - log_odds.begin())]);
}

Session::Located Session::locate(const InputFrame& input) {
  const Frame& frame = input.frame;
  const AnchoredTrajectory& trajectory = pose_filter_.trajectory();
  const Tracker::Scene scene{rig_,
                             mapper_,
                             mission_ ? &mission_->mission() : nullptr,
                             mission_ && mission_->is_focal_check_due(),
                             hint_.get(),
                             pose_filter_.place().is_accepted(),
                             trusted_place_.reach_from_there(),
                             mission_ ? mission_->ground_under(pose_filter_, mapper_) : nullptr,
                             input.cuts.online_points,
                             dirt_detector_.hidden()};
  const bool can_search = mission_ || mapper_.places();
  const bool returns_by_odometry = can_search && pose_filter_.can_return_by_odometry();
  Located located;
  if (!trajectory.empty() && (pose_filter_.has_pose() || !can_search || returns_by_odometry)) {
    const AnchoredPose& last = trajectory.back();
    located.track =
        tracker_.track(frame, scene, {last.time, camera_from_world(map(), last), last.keyframe}, pose_filter_.motion());
  }
  const auto drop_non_finite = [&] {
    if (located.track && !is_finite(located.track->tracked.camera_from_world)) located.track.reset();
  };
  drop_non_finite();
  if (located.track && located.track->focal) mission_->note_focal_length(*located.track->focal);
  // Measured motion contradicts the pose, and the offline points in view do not outweigh it. The motion is then
  // followed.
  const auto contradicts_motion = [&] {
    const HybridTrack& track = *located.track;
    if (!pose_filter_.is_unreachable(frame, track, rig_, map())) return false;
    if (!mission_ || track.offline_inliers == 0) return true;
    return mission_->log_odds_of(frame, track, rig_, dirt_detector_.hidden()) + kLogOddsOfKidnapping < 0.0;
  };
  const bool is_sure = pose_filter_.place().is_confirmed();
  if (located.track && (contradicts_motion() || (!is_sure && tracker_.is_doubtful(*located.track, scene)))) {
    located.track.reset();
  }
  located.is_relocalised = located.track && returns_by_odometry;
  if (!located.track && can_search) {
    Tracker::Find find;
    if (auto found = mission_ ? mission_->find_at_rival(frame, rig_, dirt_detector_.hidden()) : std::nullopt) {
      find.places.push_back(found_in(Origin::offline, *std::move(found)));
    }
    if (find.places.empty()) find = tracker_.find(frame, scene);
    sort_by_log_odds(find.places, frame);
    if (!find.places.empty()) {
      located.track = std::move(find.places.front());
      located.elsewhere.assign(std::make_move_iterator(find.places.begin() + 1),
                               std::make_move_iterator(find.places.end()));
    }
    drop_non_finite();
    if (located.track && !hint_.get() && contradicts_motion()) located.track.reset();
    located.refused = find.refused;
    located.is_relocalised = located.track.has_value();
    located.is_by_hint = located.is_relocalised && hint_.get();
    if (located.track) mapper_.begin_at_relocalisation(*located.track);
  }
  mapper_.allow_monocular_submap(rig_, !located.track && pose_filter_.bridge());
  if (!located.track && may_begin_submap(input)) return begin_submap(frame);
  return located;
}

bool Session::may_begin_submap(const InputFrame& input) const {
  if (!options_.map_online || is_mapping_paused_ || mapper_.is_being_read() || !mapper_.can_begin(rig_)) return false;
  const AnchoredTrajectory& trajectory = pose_filter_.trajectory();
  if (trajectory.empty()) return mapper_.online().keyframe_count() == 0 || (mission_ && rig_.is_stereo());
  if (input.fault != ImageFault::none || (!mission_ && !pose_filter_.bridge())) return false;
  const Timestamp last_seen = pose_filter_.last_seen().value_or(trajectory.back().time);
  return to_seconds(input.frame.time - last_seen) >= options_.mission.restart_after;
}

Session::Located Session::begin_submap(const Frame& frame) {
  const AnchoredTrajectory& trajectory = pose_filter_.trajectory();
  std::optional<Pose> predicted;  // camera_from_world
  if (!trajectory.empty()) {
    predicted = pose_filter_.motion().predict(camera_from_world(map(), trajectory.back()), rig_, 0.0);
  } else if (const auto measured = pose_filter_.start_by_odometry()) {
    predicted = camera_pose(rig_, *measured);
  }
  const Mapper::Beginning begun = mapper_.begin(frame, rig_, predicted, trajectory);
  if (begun.keyframes.empty()) return {.track = {}, .elsewhere = {}, .start_failure = begun.failure};
  pose_filter_.begin(begun.keyframes, mapper_.submaps().present(), rig_, mapper_.online());
  tracker_.restart_from(begun.keyframes.back());
  keyframe_policy_.restart();
  if (mission_) mission_->begin_submap();
  return {.track = {}, .elsewhere = {}, .begins_submap = true, .start_failure = begun.failure};
}

void Session::remember(const InputFrame& input, const Located& located, FrameReport& report) {
  const HybridTrack& track = *located.track;
  if (located.is_relocalised && !mission_ && pose_filter_.motion().measured()) keyframe_policy_.require_keyframe();
  const bool is_on_map = mission_ && is_registered(mapper_);
  std::optional<PlaceHypothesis> known_place;
  if (is_on_map) {
    if (located.is_relocalised) {
      known_place = mission_->begin_place(input.frame.time, track.tracked.camera_from_world);
    }
    mission_->test_rivals({input.frame, track, rig_, 0.0, false, {}, dirt_detector_.hidden()}, located.elsewhere,
                          pose_filter_, mapper_);
  }
  const std::optional<PlaceView> view =
      is_on_map && (located.is_relocalised || mission_->is_view_due(pose_filter_))
          ? std::optional(mission_->view_of(input.frame, track, rig_, dirt_detector_.hidden(),
                                            located.is_relocalised || !pose_filter_.place().is_accepted()))
          : std::nullopt;
  const PoseFilter::Progress progress =
      pose_filter_.note({input.frame, track, located.is_relocalised, is_registered(mapper_),
                         mapper_.submaps().present(), located.is_by_hint, view ? &*view : nullptr,
                         known_place ? &*known_place : nullptr, is_on_map ? mission_->log_odds_of_rivals() : kNoRivals},
                        rig_, map());
  tracker_.note(track);
  if (!input.cuts.online_points) {
    keyframe_policy_.note_track(anchor_of(track), static_cast<int>(track.tracked.features.size()));
  }
  if (progress.was_accepted && !located.is_relocalised) {
    rolling_shutter_.note(input.frame, rig_, track.tracked, map(), pose_filter_.motion().velocity());
  }
  if (is_on_map) {
    const OfflineTracker::MissionUpdate update =
        mission_->note({input.frame, track, rig_, progress.step, input.fault != ImageFault::none,
                        tracker_.offline_points(), dirt_detector_.hidden()},
                       pose_filter_, mapper_);
    report.events.insert(report.events.end(), update.events.begin(), update.events.end());
    if (update.correction) mapper_.correct_later(*update.correction);
  }
  if (!pose_filter_.place().is_confirmed() || !is_registered(mapper_)) return;
  if (mission_ && !progress.was_ever_confirmed) {
    report.events.push_back(SessionEvent::localised);
  } else if (needs_relocalisation(state_)) {
    report.events.push_back(SessionEvent::relocalised);
  }
}

// Only for tracked, confirmed poses on a faultless image.
void Session::update_dirt_mask(const InputFrame& input, const Located& located, FrameReport& report) {
  const bool is_known = pose_filter_.place().is_confirmed();
  if (located.is_relocalised || !is_known || input.fault != ImageFault::none || located.track->maps_disagree) return;
  dirt_detector_.note(input.frame, located.track->tracked, rig_, map());
  mapper_.note_hidden(dirt_detector_.hidden());
  if (const auto event = dirt_detector_.take_event()) report.events.push_back(*event);
}

// Adds a keyframe if needed; searches loops and places with every tracked frame.
void Session::extend_map(const InputFrame& input, const HybridTrack& track, FrameReport& report) {
  if (may_add_keyframe(input, track)) {
    const KeyframeId id = mapper_.add_keyframe(input.frame, track, rig_);
    rolling_shutter_.note_keyframe(id);
    tracker_.restart_from(id);
    keyframe_policy_.restart();
    pose_filter_.anchor_to(id);
    report.keyframe_added = true;
  }
  if (search_loop(input.frame, report.keyframe_added)) report.events.push_back(SessionEvent::loop_found);
  if (mission_)
    mission_->search_in_background(
        {input.frame, rig_, hint_.get(), trusted_place_.reach_from_there(), dirt_detector_.hidden()}, pose_filter_,
        mapper_);
}

bool Session::may_add_keyframe(const InputFrame& input, const HybridTrack& track) {
  if (!options_.map_online || is_mapping_paused_ || mapper_.is_being_read()) return false;
  if (!pose_filter_.place().is_confirmed() || input.fault != ImageFault::none) return false;
  const KeyframeEvidence evidence = keyframe_policy_.evidence(track, map(), mapper_.pending());
  return keyframe_policy_.should_add_keyframe(track, evidence, input.cuts, options_.keyframes);
}

// Offline points that constrain the pose leave no drift for a loop to correct.
bool Session::search_loop(const Frame& frame, bool keyframe_added) {
  const auto newest = mapper_.newest_keyframe();
  if (!newest || (mission_ && is_registered(mapper_) && mission_->mission().view() == OfflineView::held)) return false;
  const Pose camera_from_map = camera_from_world(map(), pose_filter_.trajectory().back());
  return mapper_.search_loop({frame, camera_from_map, rig_, *newest, keyframe_added});
}

void Session::lose_pose(ImageFault fault, FrameReport& report) {
  if (pose_filter_.has_pose() && state_ == State::tracking) {
    report.events.push_back(SessionEvent::pose_lost);
    if (fault != ImageFault::none) report.events.push_back(SessionEvent::blinded);
  }
  pose_filter_.mark_lost();
  if (mission_) mission_->mark_lost();
}

void Session::finish() {
  if (mission_) mission_->finish();
  pose_filter_.apply_length_changes(mapper_.finish());
}

FinishReport Session::finish_map(const FinishHooks& hooks) {
  if (const auto turn = mapper_.calibrate_finally(rig_, hooks.should_stop)) apply_rig_rotation(*turn);
  FinishReport report = mapper_.finish_map(hooks);
  pose_filter_.apply_length_changes(report.length_changes);
  return report;
}

void Session::finish_mission(const FinishHooks& hooks) {
  if (mapper_.online().keyframe_count() == 0) return;
  pose_filter_.apply_length_changes(mapper_.adjust_around_offline(hooks));
  pose_filter_.refine_all_deferred(map(), options_.track);
}

Trajectory Session::final_trajectory() const {
  return pose_filter_.trajectory().in_map_frame(map(), mapper_.submaps(), rig_);
}

}  // namespace byre
