#include "byre/session/session.h"

#include "byre/geometry/finite.h"
#include "byre/slam/body_pose.h"
#include "byre/workers/stopwatch.h"

#include <cassert>
#include <utility>

namespace byre {
namespace {

// True without an offline map.
bool is_registered(const Mapper& mapper) {
  return mapper.submaps().is_registered();
}

}  // namespace

Session::Session(const Rig& rig, const SessionOptions& options, Lanes lanes, std::optional<Vocabulary> vocabulary,
                 std::shared_ptr<const OfflineMap> offline)
    : options_(options),
      rig_(rig),
      mapper_(rig, mapper_options(options),
              {std::move(lanes.local), offline ? make_inline_executor() : std::move(lanes.global),
               std::move(lanes.reading)},
              {std::move(vocabulary), offline}),
      tracker_(options),
      whereabouts_(options.mission.registration, options.hindsight, options.trajectory, offline != nullptr),
      input_watch_(options.image),
      shutter_(rig.readout_time),
      trusted_place_(options.mission.registration.max_speed) {
  if (offline) {
    mission_.emplace(std::move(offline),
                     OfflineTrackerOptions{options.mission, options.track, options.relocalise, options.local_keyframes,
                                           options.is_planar},
                     OfflineTracker::Lanes{std::move(lanes.global), std::move(lanes.calibration)});
  } else {
    options_.map_online = true;  // no other map to track on
  }
}

void Session::continue_map(Map online) {
  assert(whereabouts_.trajectory().empty());
  mapper_.continue_map(std::move(online));
  state_ = State::lost;
}

void Session::refine_calibration(const Calibration& given, const SelfCalibrationOptions& options) {
  mission_ ? mission_->refine_calibration(given, options.prior_sigmas) : mapper_.refine_calibration(given, options);
  refine_readout(RefinedCalibration{given});
}

void Session::refine_readout(const RefinedCalibration& known) {
  assert(whereabouts_.trajectory().empty());
  shutter_.refine(known);
}

std::optional<RefinedCalibration> Session::self_calibration() const {
  if (mapper_.calibrator()) return shutter_.refined(mapper_.calibrator()->result());
  if (mission_ && mission_->calibrator()) return shutter_.refined(mission_->calibrator()->result());
  return shutter_.refined({});
}

FrameReport Session::process(const Frame& rectified, const std::optional<BodyMotion>& motion, FrameBudget* budget) {
  FrameReport report;
  report.time = rectified.time;
  if (!first_frame_) first_frame_ = rectified.time;
  whereabouts_.tell(motion);
  hint_.pass(rectified.time);
  const Stopwatch mapping_before;
  take_over_results(report);
  InputFrame input = input_of(rectified, motion);
  mapper_.start_job();
  const double seconds_before = mapping_before.seconds();

  if (budget != nullptr) input.cuts = budget->begin_tracking();
  const Stopwatch tracking;
  const Located located = locate(input);
  report.track_seconds = tracking.seconds();
  const TrackedFrame* const tracked = located.track ? &located.track->tracked : nullptr;
  input.evidence.out_of_step = input_watch_.out_of_step(input.frame, rig_, tracked, map());
  if (budget != nullptr && located.track) budget->note_tracked();

  const Stopwatch mapping_after;
  keyframe_watch_.note_frame(input.frame, rig_);
  report.start_failure = located.start_failure;
  if (located.refused != Doubt::none) report.refused_place = located.refused;
  report.keyframe_added = located.begins_submap;
  if (located.track) {
    remember(input, located, report);
    look_for_dirt(input, located, report);
    extend_map(input, *located.track, report);
  } else if (located.begins_submap) {
    const bool is_first = mapper_.submaps().size() == 1;
    report.events.push_back(is_first ? SessionEvent::initialised : SessionEvent::restarted);
  } else {
    lose_pose(input.fault, report);
    whereabouts_.go_on(rectified.time, rig_, map(), mission_ ? mission_->ground_under(whereabouts_, mapper_) : nullptr);
  }

  if (budget != nullptr && (!located.track || keyframe_watch_.is_short())) budget->keep_next_whole();

  const double seconds_without = to_seconds(rectified.time - whereabouts_.last_believed().value_or(*first_frame_));
  const bool is_believed = whereabouts_.place().is_believed();
  const FrameSummary summary{input,
                             located.track ? &*located.track : nullptr,
                             rig_,
                             whereabouts_,
                             mapper_,
                             mission_ ? &*mission_ : nullptr,
                             lens_watch_,
                             *first_frame_,
                             report.refused_place};
  state_ = next_state(state_, {whereabouts_.has_pose(), is_believed, seconds_without}, options_.state);
  report = described(std::move(report), summary);
  report.state = state_;
  const HealthEvidence evidence = doubts_.held(rectified.time, evidence_of(summary));
  report.health = health_of(summary, report.covariance, evidence, options_.health);
  withhold_non_finite(report);
  note_quality(report);
  if (trusted_place_.is_news(report.refused_place, report.health.verdict)) {
    report.events.push_back(SessionEvent::place_refused);
  }
  const bool is_error = mission_ ? seconds_without >= options_.state.lost_after : state_ == State::lost;
  if (!std::exchange(is_error_told_, is_error) && is_error) report.events.push_back(SessionEvent::navigation_error);

  whereabouts_.settle_overdue(map(), options_.track);
  seen_.clear();
  if (located.track) append_seen_points(located.track->tracked, seen_);
  mapper_.start_reading();
  report.map_seconds = seconds_before + mapping_after.seconds();
  return report;
}

// Stored only for a believed pose, and used for poses predicted from it.
void Session::note_quality(const FrameReport& report) {
  if (!whereabouts_.has_pose() || !report.map_from_body || !whereabouts_.place().is_believed()) return;
  whereabouts_.note_quality({report.covariance, report.odometry_covariance, report.health.verdict});
  if (mission_ && report.health.verdict == Verdict::trusted) trusted_place_.note({report.time, *report.map_from_body});
}

void Session::take_over_results(FrameReport& report) {
  constexpr double kLeastCorrection = 1e-6;  // metres and radians; smaller values are rounding
  mapper_.collect_reading();
  if (mapper_.is_read()) return;
  const bool was_registered = is_registered(mapper_);
  report.job_seconds = mapper_.collect();
  const bool is_shutter_better = mapper_.take_over_readout(shutter_, rig_);
  if (take_over_camera() || is_shutter_better) report.events.push_back(SessionEvent::recalibrated);
  if (const auto changes = mapper_.take_over_correction()) {
    whereabouts_.follow(*changes);
    whereabouts_.forget_carried();
    report.events.push_back(SessionEvent::map_corrected);
  }
  if (mission_) take_over_place(report);
  if (const auto offline_from_online = mapper_.correct_online()) {
    whereabouts_.note_online_correction();
    if (!was_registered && is_registered(mapper_)) {
      whereabouts_.note_registration(*offline_from_online, hint_.get().has_value());
    }
    report.events.push_back(SessionEvent::online_corrected);
  }
  const auto correction = whereabouts_.follow_map(rig_, map());
  if (!correction || !was_registered || !is_registered(mapper_)) return;
  if (log_pose(*correction).norm() > kLeastCorrection) report.correction = correction;
}

void Session::take_over_place(FrameReport& report) {
  const std::optional<PlaceSearch> search = mission_->collect_place();
  if (search) report.refused_place = search->refused;
  const OfflineTracker::Consequence consequence = mission_->consider(search, whereabouts_, mapper_);
  if (consequence.correction) mapper_.correct_later(*consequence.correction);
  if (consequence.agrees_with_hint) whereabouts_.note_agreement();
  if (consequence.refutes_pose) {
    if (whereabouts_.is_by_hint()) hint_.withdraw();
    mapper_.leave_map_frame();
    lose_pose(ImageFault::none, report);
  }
  if (consequence.refutes_way) {
    whereabouts_.give_up();
    trusted_place_.forget();
    report.events.push_back(SessionEvent::place_refuted);
  }
}

// A correction of the online map's own calibration turns its keyframes as well. In a mission frames have a new rig from
// here on, and keyframes keep theirs.
bool Session::take_over_camera() {
  if (const auto turn = mapper_.take_over_calibration(rig_)) {
    take_turn(*turn);
    return true;
  }
  const auto change = mission_ ? mission_->collect_camera() : std::nullopt;
  if (!change) return false;
  rig_ = change->rig;
  whereabouts_.turn_camera(change->after_from_before);
  mapper_.forget_loop();
  return true;
}

void Session::take_turn(const RigTurn& turn) {
  rig_ = turn.after;
  whereabouts_.turn(turn, mapper_.online());
}

InputFrame Session::input_of(const Frame& rectified, const std::optional<BodyMotion>& motion) {
  Frame frame = mapper_.corrected(rectified);
  if (mission_) frame = mission_->corrected(frame);
  const InputEvidence evidence = input_watch_.look_at(frame, rig_, {motion, whereabouts_.camera_motion()});
  frame = shutter_.corrected(frame, rig_, whereabouts_.camera_motion());
  const ImageFault fault = frame.condition ? fault_of(*frame.condition, options_.image) : ImageFault::none;
  mapper_.note_images(evidence.cameras_disagree);
  return {std::move(frame), fault, evidence};
}

// Puts the place with the highest log-odds first, by this frame and, at a place that continues a test, by those before.
void Session::put_most_likely_first(std::vector<HybridTrack>& places, const Frame& frame) {
  if (places.size() < 2) return;
  std::vector<double> log_odds;
  for (const HybridTrack& found : places) {
    const Pose body = body_pose(rig_, found.tracked.camera_from_world);
    PlaceHypothesis place = whereabouts_.hypothesis_of_find(
        frame.time, body, mission_->known_place_at(frame.time, found.tracked.camera_from_world), rig_, map());
    place.observe(mission_->view_of(frame, found, rig_, lens_watch_.hidden(), false), true);
    log_odds.push_back(place.log_odds());
  }
  std::swap(places.front(), places[static_cast<std::size_t>(std::ranges::max_element(log_odds) - log_odds.begin())]);
}

Session::Located Session::locate(const InputFrame& input) {
  const Frame& frame = input.frame;
  const AnchoredTrajectory& trajectory = whereabouts_.trajectory();
  const Tracker::Scene scene{rig_,
                             mapper_,
                             mission_ ? &mission_->mission() : nullptr,
                             mission_ && mission_->ask_for_focal_length(),
                             hint_.get(),
                             whereabouts_.place().is_accepted(),
                             trusted_place_.way_from_there(),
                             mission_ ? mission_->ground_under(whereabouts_, mapper_) : nullptr,
                             input.cuts.online_points,
                             lens_watch_.hidden()};
  const bool can_search = mission_ || mapper_.places();
  const bool is_led_back = can_search && whereabouts_.may_be_led_back();
  Located located;
  if (!trajectory.empty() && (whereabouts_.has_pose() || !can_search || is_led_back)) {
    const AnchoredPose& last = trajectory.back();
    located.track =
        tracker_.track(frame, scene, {last.time, camera_from_world(map(), last), last.keyframe}, whereabouts_.motion());
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
    if (!whereabouts_.is_out_of_reach(frame, track, rig_, map())) return false;
    if (!mission_ || track.offline_inliers == 0) return true;
    return mission_->log_odds_of(frame, track, rig_, lens_watch_.hidden()) + kLogOddsOfCarried < 0.0;
  };
  const bool is_sure = whereabouts_.place().is_believed();
  if (located.track && (contradicts_motion() || (!is_sure && tracker_.is_doubtful(*located.track, scene)))) {
    located.track.reset();
  }
  located.from_nothing = located.track && is_led_back;
  if (!located.track && can_search) {
    Tracker::Find find;
    if (auto found = mission_ ? mission_->find_at_rival(frame, rig_, lens_watch_.hidden()) : std::nullopt) {
      find.places.push_back(found_in(Origin::offline, *std::move(found)));
    }
    if (find.places.empty()) find = tracker_.find(frame, scene);
    put_most_likely_first(find.places, frame);
    if (!find.places.empty()) {
      located.track = std::move(find.places.front());
      located.elsewhere.assign(std::make_move_iterator(find.places.begin() + 1),
                               std::make_move_iterator(find.places.end()));
    }
    drop_non_finite();
    if (located.track && !hint_.get() && contradicts_motion()) located.track.reset();
    located.refused = find.refused;
    located.from_nothing = located.track.has_value();
    located.is_by_hint = located.from_nothing && hint_.get();
    if (located.track) mapper_.begin_where_found(*located.track);
  }
  mapper_.expect_beginning_beside(rig_, !located.track && whereabouts_.bridge());
  if (!located.track && may_begin_submap(input)) return begin_submap(frame);
  return located;
}

bool Session::may_begin_submap(const InputFrame& input) const {
  if (!options_.map_online || is_mapping_paused_ || mapper_.is_read() || !mapper_.can_begin(rig_)) return false;
  const AnchoredTrajectory& trajectory = whereabouts_.trajectory();
  if (trajectory.empty()) return mapper_.online().keyframe_count() == 0 || (mission_ && rig_.is_stereo());
  if (input.fault != ImageFault::none || (!mission_ && !whereabouts_.bridge())) return false;
  const Timestamp last_seen = whereabouts_.last_seen().value_or(trajectory.back().time);
  return to_seconds(input.frame.time - last_seen) >= options_.mission.restart_after;
}

Session::Located Session::begin_submap(const Frame& frame) {
  const AnchoredTrajectory& trajectory = whereabouts_.trajectory();
  std::optional<Pose> predicted;  // camera_from_world
  if (!trajectory.empty()) {
    predicted = whereabouts_.motion().predict(camera_from_world(map(), trajectory.back()), rig_, 0.0);
  } else if (const auto told = whereabouts_.told_beginning()) {
    predicted = camera_pose(rig_, *told);
  }
  const Mapper::Beginning begun = mapper_.begin(frame, rig_, predicted, trajectory);
  if (begun.keyframes.empty()) return {.track = {}, .elsewhere = {}, .start_failure = begun.failure};
  whereabouts_.begin(begun.keyframes, mapper_.submaps().present(), rig_, mapper_.online());
  tracker_.restart_from(begun.keyframes.back());
  keyframe_watch_.restart();
  if (mission_) mission_->begin_submap();
  return {.track = {}, .elsewhere = {}, .begins_submap = true, .start_failure = begun.failure};
}

void Session::remember(const InputFrame& input, const Located& located, FrameReport& report) {
  const HybridTrack& track = *located.track;
  if (located.from_nothing && !mission_ && whereabouts_.motion().told()) keyframe_watch_.note_found();
  const bool is_on_map = mission_ && is_registered(mapper_);
  std::optional<PlaceHypothesis> known_place;
  if (is_on_map) {
    if (located.from_nothing) {
      known_place = mission_->begin_place(input.frame.time, track.tracked.camera_from_world);
    }
    mission_->test_rivals({input.frame, track, rig_, 0.0, false, {}, lens_watch_.hidden()}, located.elsewhere,
                          whereabouts_, mapper_);
  }
  const std::optional<PlaceView> view =
      is_on_map && (located.from_nothing || mission_->is_view_due(whereabouts_))
          ? std::optional(mission_->view_of(input.frame, track, rig_, lens_watch_.hidden(),
                                            located.from_nothing || !whereabouts_.place().is_accepted()))
          : std::nullopt;
  const Whereabouts::Progress progress =
      whereabouts_.note({input.frame, track, located.from_nothing, is_registered(mapper_), mapper_.submaps().present(),
                         located.is_by_hint, view ? &*view : nullptr, known_place ? &*known_place : nullptr,
                         is_on_map ? mission_->log_odds_of_rivals() : kNoRivals},
                        rig_, map());
  tracker_.note(track);
  if (!input.cuts.online_points) {
    keyframe_watch_.note_track(anchor_of(track), static_cast<int>(track.tracked.features.size()));
  }
  if (progress.was_proven && !located.from_nothing) {
    shutter_.note(input.frame, rig_, track.tracked, map(), whereabouts_.motion().velocity());
  }
  if (is_on_map) {
    const OfflineTracker::Consequence consequence =
        mission_->note({input.frame, track, rig_, progress.step, input.fault != ImageFault::none,
                        tracker_.offline_points(), lens_watch_.hidden()},
                       whereabouts_, mapper_);
    report.events.insert(report.events.end(), consequence.events.begin(), consequence.events.end());
    if (consequence.correction) mapper_.correct_later(*consequence.correction);
  }
  if (!whereabouts_.place().is_believed() || !is_registered(mapper_)) return;
  if (mission_ && !progress.was_ever_believed) {
    report.events.push_back(SessionEvent::localised);
  } else if (has_lost_its_way(state_)) {
    report.events.push_back(SessionEvent::relocalised);
  }
}

// Only for tracked, believed poses on a faultless image.
void Session::look_for_dirt(const InputFrame& input, const Located& located, FrameReport& report) {
  const bool is_known = whereabouts_.place().is_believed();
  if (located.from_nothing || !is_known || input.fault != ImageFault::none || located.track->maps_disagree) return;
  lens_watch_.note(input.frame, located.track->tracked, rig_, map());
  mapper_.note_hidden(lens_watch_.hidden());
  if (const auto news = lens_watch_.news()) report.events.push_back(*news);
}

// Adds a keyframe if needed; searches loops and places with every tracked frame.
void Session::extend_map(const InputFrame& input, const HybridTrack& track, FrameReport& report) {
  if (may_add_keyframe(input, track)) {
    const KeyframeId id = mapper_.add_keyframe(input.frame, track, rig_);
    shutter_.note_keyframe(id);
    tracker_.restart_from(id);
    keyframe_watch_.restart();
    whereabouts_.anchor_to(id);
    report.keyframe_added = true;
  }
  if (look_for_loop(input.frame, report.keyframe_added)) report.events.push_back(SessionEvent::loop_found);
  if (mission_)
    mission_->search_beside({input.frame, rig_, hint_.get(), trusted_place_.way_from_there(), lens_watch_.hidden()},
                            whereabouts_, mapper_);
}

bool Session::may_add_keyframe(const InputFrame& input, const HybridTrack& track) {
  if (!options_.map_online || is_mapping_paused_ || mapper_.is_read()) return false;
  if (!whereabouts_.place().is_believed() || input.fault != ImageFault::none) return false;
  const KeyframeEvidence evidence = keyframe_watch_.evidence(track, map(), mapper_.pending());
  return keyframe_watch_.asks_for_keyframe(track, evidence, input.cuts, options_.keyframes);
}

// Offline points that constrain the pose leave no drift for a loop to correct.
bool Session::look_for_loop(const Frame& frame, bool keyframe_added) {
  const auto newest = mapper_.newest_keyframe();
  if (!newest || (mission_ && is_registered(mapper_) && mission_->mission().view() == OfflineView::held)) return false;
  const Pose camera_from_map = camera_from_world(map(), whereabouts_.trajectory().back());
  return mapper_.look_for_loop({frame, camera_from_map, rig_, *newest, keyframe_added});
}

void Session::lose_pose(ImageFault fault, FrameReport& report) {
  if (whereabouts_.has_pose() && state_ == State::tracking) {
    report.events.push_back(SessionEvent::pose_lost);
    if (fault != ImageFault::none) report.events.push_back(SessionEvent::blinded);
  }
  whereabouts_.lose();
  if (mission_) mission_->lose();
}

void Session::finish() {
  if (mission_) mission_->finish();
  whereabouts_.follow(mapper_.finish());
}

FinishReport Session::finish_map(const FinishHooks& hooks) {
  if (const auto turn = mapper_.calibrate_at_last(rig_, hooks.should_stop)) take_turn(*turn);
  FinishReport report = mapper_.finish_map(hooks);
  whereabouts_.follow(report.length_changes);
  return report;
}

void Session::finish_mission(const FinishHooks& hooks) {
  if (mapper_.online().keyframe_count() == 0) return;
  whereabouts_.follow(mapper_.adjust_around_offline(hooks));
  whereabouts_.settle_all(map(), options_.track);
}

Trajectory Session::final_trajectory() const {
  return whereabouts_.trajectory().in_map_frame(map(), mapper_.submaps(), rig_);
}

}  // namespace byre
