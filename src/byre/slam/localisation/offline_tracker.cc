#include "byre/slam/localisation/offline_tracker.h"

#include "byre/geometry/tag_pose.h"
#include "byre/slam/places/localisation.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/keyframes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Accepted, and neither the map cells in view nor a tag contradict the pose.
bool is_certain(const PoseFilter& pose_filter) {
  const PlaceHypothesis& place = pose_filter.place();
  return place.is_accepted() && place.log_odds() >= 0.0 && !place.is_contradicted_by_tag();
}

// Shifts to the look-alike place and to the one on the other side, where the building may repeat beyond the map.
std::array<Eigen::Vector3d, 2> both_ways(const LookAlikePlace& place) {
  return {place.shift, -place.shift};
}

// camera_from_offline at the place that is shifted so far.
Pose camera_at(const Eigen::Vector3d& shift, const Pose& camera_from_place) {
  return camera_from_place * Pose{Eigen::Quaterniond::Identity(), -shift};
}

}  // namespace

OfflineTracker::OfflineTracker(std::shared_ptr<const OfflineMap> offline, const OfflineTrackerOptions& options)
    : options_(options),
      offline_(std::move(offline)),
      mission_(offline_, options.mission),
      rivals_(options.mission.registration),
      point_records_(static_cast<std::size_t>(offline_->map().point_count())) {}

void OfflineTracker::refine_calibration(const Calibration& given, double prior_sigmas) {
  calibrator_.emplace(given, prior_sigmas);
}

const DrivenGround* OfflineTracker::ground_under(const PoseFilter& pose_filter, const Mapper& mapper) const {
  const AnchoredTrajectory& trajectory = pose_filter.trajectory();
  if (!options_.is_planar || !options_.mission.bounds.is_on_ground_of_map || trajectory.empty()) return nullptr;
  const bool is_in_map = mapper.submaps().frame(trajectory.back().submap) == Submaps::kMapFrame;
  return is_in_map ? offline_->ground() : nullptr;
}

std::optional<MissionCalibrator::Switch> OfflineTracker::collect_camera() {
  return calibrator_ ? calibrator_->collect() : std::nullopt;
}

std::optional<PlaceSearch> OfflineTracker::collect_place() {
  auto finished = search_.collect();
  return finished ? std::optional(std::move(finished->result)) : std::nullopt;
}

Frame OfflineTracker::corrected(const Frame& frame) {
  Frame result = calibrator_ ? calibrator_->corrected(frame) : frame;
  std::erase_if(result.tags, [this](const TagSighting& seen) { return std::ranges::count(moved_tags_, seen.id) > 0; });
  return result;
}

bool OfflineTracker::is_view_due(const Frame& frame, const PoseFilter& pose_filter) {
  constexpr int kFramesOfKnownPlace = 3;
  constexpr double kBeyondDoubt = 5.0;  // log-odds
  const PlaceHypothesis& place = pose_filter.place();
  const bool is_known = pose_filter.has_pose() && place.is_accepted() && place.log_odds() >= kBeyondDoubt;
  if (is_known && frame.tags.empty() && ++frames_since_view_ < kFramesOfKnownPlace) return false;
  frames_since_view_ = 0;
  return true;
}

PlaceView OfflineTracker::view_of(const Frame& frame, const HybridTrack& track, const Rig& rig, const ImageMask& hidden,
                                  bool finds_rivals) {
  const Pose& pose = track.tracked.camera_from_world;
  ScratchVector<KeyframeId> keyframes = keyframes_of_place(*offline_, pose);
  if (keyframes != nearby_keyframes_) {
    nearby_points_ = points_of_place(*offline_, keyframes);
    nearby_keyframes_ = std::move(keyframes);
  }
  ScratchVector<PointId> around;
  constexpr std::size_t kFew = 200;  // nearby points; with fewer, too few may be in view
  if (nearby_points_.size() < kFew) {
    auto reference = track.offline_reference;
    if (!reference) reference = mission_.keyframe_near(pose);
    if (reference) around = local_points(offline_->map(), *reference, options_.local_keyframes);
  }
  const std::vector<PointId> in_common = finds_rivals ? points_in_common(track.tracked) : std::vector<PointId>();
  PlaceView view =
      view_of_place({offline_->map(), rig, frame, track.tracked, nearby_points_, around, hidden, offline_->tags(),
                     [this](PointId id) { return mission_.moved_points().is_suspended(id); },
                     [&](PointId id) { return std::ranges::binary_search(in_common, id); }, offline_->cell_unit()});
  shows_tag_ = std::ranges::any_of(view.tags, &TagInView::agrees);
  return view;
}

double OfflineTracker::log_odds_of(const Frame& frame, const HybridTrack& track, const Rig& rig,
                                   const ImageMask& hidden) {
  return byre::log_odds_of(view_of(frame, track, rig, hidden, false));
}

std::optional<PlaceHypothesis> OfflineTracker::begin_place(Timestamp time, const Pose& camera_from_place) {
  is_refuted_ = false;
  held_keyframes_.clear();
  return rivals_.begin(time, camera_from_place);
}

std::optional<TrackedFrame> OfflineTracker::find_at_rival(const Frame& frame, const Rig& rig, const ImageMask& hidden) {
  const std::optional<Pose> predicted = rivals_.camera_from_likeliest();
  if (!std::exchange(is_refuted_, false) || !predicted) return std::nullopt;
  return track_at(frame, *predicted, points_around(*predicted), rig, hidden);
}

std::optional<TrackedFrame> OfflineTracker::track_at(const Frame& frame, const Pose& predicted,
                                                     std::span<const PointId> points, const Rig& rig,
                                                     const ImageMask& hidden) const {
  TrackOptions options = options_.track;
  options.hidden = hidden;
  return track(frame, predicted, rig, offline_->map(), points, options);
}

ScratchVector<PointId> OfflineTracker::points_around(const Pose& camera_from_offline) const {
  constexpr double kNear = 10.0;  // metres; keyframes far from a place may have seen its points
  constexpr int kKeyframes = 5;
  ScratchVector<PointId> around;
  for (const KeyframeId id : offline_->keyframes_near(camera_from_offline, kNear, kKeyframes)) {
    const ScratchVector<PointId> points = local_points(offline_->map(), id, kKeyframesOfPlace);
    around.insert(around.end(), points.begin(), points.end());
  }
  std::ranges::sort(around);
  around.erase(std::ranges::unique(around).begin(), around.end());
  return around;
}

// Points that look alike proposed the rival, so they are no evidence for it.
RivalPlaces::View OfflineTracker::view_at_rival(const Frame& frame, const Pose& predicted, const Rig& rig,
                                                const ImageMask& hidden, std::vector<int>* features) const {
  const ScratchVector<PointId> around = points_around(predicted);
  const auto tracked = track_at(frame, predicted, around, rig, hidden);
  if (tracked && features != nullptr) {
    for (const TrackedFeature& seen : tracked->features) features->push_back(seen.feature);
  }
  TrackedFrame there;
  there.camera_from_world = predicted;
  if (tracked) there = *tracked;
  const Pose& pose = there.camera_from_world;
  const ScratchVector<PointId> nearby = points_of_place(*offline_, keyframes_of_place(*offline_, pose));
  const auto is_repeated = [this](PointId id) {
    return std::ranges::any_of(
        look_alikes_, [id](const LookAlikePlace& place) { return std::ranges::binary_search(place.repeated, id); });
  };
  return {pose,
          view_of_place({offline_->map(),
                         rig,
                         frame,
                         there,
                         nearby,
                         around,
                         hidden,
                         offline_->tags(),
                         is_repeated,
                         {},
                         offline_->cell_unit()}),
          tracked.has_value()};
}

void OfflineTracker::test_rivals(const Seen& seen, std::span<const HybridTrack> elsewhere,
                                 const PoseFilter& pose_filter, const Mapper& mapper) {
  constexpr int kFramesOfAcceptedPlace = 3;  // to save time
  features_at_rivals_.clear();
  const Pose& camera_from_place = seen.track.tracked.camera_from_world;
  const bool is_accepted = pose_filter.place().is_accepted() && elsewhere.empty();
  std::vector<Pose> rivals = camera_by_contradicting_tags(seen);  // camera_from_offline
  if (is_accepted && rivals.empty() && ++frames_since_rivals_ < kFramesOfAcceptedPlace) return;
  frames_since_rivals_ = 0;
  for (const HybridTrack& other : elsewhere) rivals.push_back(other.tracked.camera_from_world);
  if (!is_accepted) {
    for (const LookAlikePlace& place : look_alikes_at(camera_from_place)) {
      for (const Eigen::Vector3d& shift : both_ways(place)) rivals.push_back(camera_at(shift, camera_from_place));
    }
  }
  propose_rivals(seen.frame.time, camera_from_place, rivals, seen.rig, pose_filter, mapper);
  rivals_.observe(camera_from_place, [&](const Pose& predicted) {
    return view_at_rival(seen.frame, predicted, seen.rig, seen.hidden, &features_at_rivals_);
  });
  std::ranges::sort(features_at_rivals_);
}

void OfflineTracker::propose_rivals(Timestamp time, const Pose& camera_from_place, std::span<const Pose> rivals,
                                    const Rig& rig, const PoseFilter& pose_filter, const Mapper& mapper) {
  for (const Pose& camera_from_rival : rivals) {
    const Pose body = body_pose(rig, camera_from_rival);
    rivals_.propose(camera_from_place, camera_from_rival,
                    pose_filter.log_odds_of_relocalisation(time, body, rig, mapper.map()));
  }
}

// Evidence against a rival by keyframes of the path on which offline points held the pose: a rival of an unbroken path
// had the same relative pose there. 0 if they agree with it, or if the rival's path is outside the map.
double OfflineTracker::log_odds_of_path(const Pose& rival_from_place, const Mapper& mapper) const {
  constexpr std::size_t kMostKeyframes = 4;  // spread over the path, to save time
  PlaceHypothesis of_path(0.0, 0);
  const std::size_t held = held_keyframes_.size(), count = std::min(kMostKeyframes, held);
  for (std::size_t i = 0; i < count; ++i) {
    const KeyframeId id = held_keyframes_[count > 1 ? i * (held - 1) / (count - 1) : 0];
    const Keyframe* const keyframe = mapper.online().find_keyframe(id);
    if (keyframe == nullptr || !keyframe->frame.features) continue;
    const Pose predicted = mapper.online().camera_from_world(id) * inverse(rival_from_place);
    const Rig& rig = mapper.online().rigs()[static_cast<std::size_t>(keyframe->rig)];
    const RivalPlaces::View seen = view_at_rival(keyframe->frame, predicted, rig, {});
    if (seen.is_tracked || seen.view.is_near_keyframe) of_path.observe(seen.view, seen.is_tracked);
  }
  return std::min(0.0, of_path.log_odds());
}

std::span<const LookAlikePlace> OfflineTracker::look_alikes_at(const Pose& camera_from_place) {
  ScratchVector<KeyframeId> keyframes = keyframes_of_place(*offline_, camera_from_place);
  if (keyframes != keyframes_of_look_alikes_) {
    const auto before = std::exchange(look_alikes_, look_alike_places(*offline_, camera_from_place));
    present_look_alikes_ = look_alikes_.size();
    add_look_alikes(before, look_alikes_);
    keyframes_of_look_alikes_ = std::move(keyframes);
  }
  return look_alikes_;
}

// Points of a place, ascending, that may be those of a look-alike place: by their descriptors, or by features of the
// frame that are tracked at rivals too.
std::vector<PointId> OfflineTracker::points_in_common(const TrackedFrame& tracked) {
  const Pose& camera_from_place = tracked.camera_from_world;
  std::vector<PointId> in_common;
  untestable_ = 0;
  for (const LookAlikePlace& place : look_alikes_at(camera_from_place)) {
    for (const Eigen::Vector3d& shift : both_ways(place)) {
      const Pose camera_from_look_alike = camera_at(shift, camera_from_place);
      // The robot may be there, but no keyframe has this viewing direction.
      const bool cannot_be_tested = keyframes_of_place(*offline_, camera_from_look_alike).empty();
      if (!cannot_be_tested && !rivals_.has_at(camera_from_place, camera_from_look_alike)) continue;
      untestable_ += cannot_be_tested;
      in_common.insert(in_common.end(), place.repeated.begin(), place.repeated.end());
    }
  }
  for (const TrackedFeature& seen : tracked.features) {
    if (std::ranges::binary_search(features_at_rivals_, seen.feature)) in_common.push_back(seen.point);
  }
  std::ranges::sort(in_common);
  return in_common;
}

double OfflineTracker::log_odds_of_rivals() const {
  constexpr double kOddsOfUntestable = 7.4;  // typical odds of testable look-alikes, in barns with bays
  const double of_untestable = shows_tag_ ? 1.0 : kOddsOfUntestable;  // a tag has no look-alike
  return std::log(of_untestable * untestable_ + std::exp(rivals_.log_odds()));
}

double OfflineTracker::length_sigma_of(const Features& features) const {
  return calibrator_ ? calibrator_->length_sigma(features) : byre::length_sigma(features);
}

OfflineTracker::MissionUpdate OfflineTracker::note(const Seen& seen, const PoseFilter& pose_filter,
                                                   const Mapper& mapper) {
  MissionUpdate update{.events = note_view(seen, mapper)};
  update.moved_tags = find_moved_tags(seen, pose_filter);
  if (!update.moved_tags.empty()) update.events.push_back(SessionEvent::tag_moved);
  length_sigma_ = length_sigma_of(*seen.frame.features);
  if (is_certain(pose_filter)) {
    rivals_.forget();
    look_alikes_.resize(present_look_alikes_);
  }
  rivals_.note_place(seen.frame.time, seen.track.tracked.camera_from_world, pose_filter.place());
  if (!pose_filter.place().is_confirmed()) return update;
  if (pose_filter.place().is_accepted()) record_points(seen);
  if (!mapper.has_correction()) update.correction = correction_by(seen.track, pose_filter, mapper);
  if (calibrator_ && pose_filter.place().is_accepted() && !seen.track.maps_disagree) {
    calibrator_->note(seen.frame, seen.rig, seen.track.tracked, mapper.map());
  }
  return update;
}

std::vector<Pose> OfflineTracker::camera_by_contradicting_tags(const Seen& seen) const {
  std::vector<MappedTag> contradicting;
  for (const TagInView& tag :
       tags_in_view(seen.frame, seen.track.tracked.camera_from_world, seen.rig, offline_->tags())) {
    if (!tag.agrees) contradicting.push_back(*std::ranges::find(offline_->tags(), tag.id, &MappedTag::id));
  }
  return camera_poses_by_tags(seen.frame, seen.rig, contradicting);
}

// While the frame is tracked at the pose by a contradicting tag, the place may be wrong instead of the tag.
std::vector<MappedTag> OfflineTracker::find_moved_tags(const Seen& seen, const PoseFilter& pose_filter) {
  constexpr int kContradictions = 3;
  const PlaceHypothesis& place = pose_filter.place();
  if (seen.frame.tags.empty() || !place.is_accepted() || place.log_odds() < 0.0) return {};
  const Pose& camera = seen.track.tracked.camera_from_world;
  const auto is_rival = [&](const Pose& rival) { return rivals_.has_at(camera, rival); };
  if (std::ranges::any_of(camera_by_contradicting_tags(seen), is_rival)) return {};
  std::vector<MappedTag> moved;
  for (const TagSighting& sighting : seen.frame.tags) {
    if (place.contradictions(sighting.id) < kContradictions) continue;
    moved_tags_.push_back(sighting.id);
    MappedTag tag = *std::ranges::find(offline_->tags(), sighting.id, &MappedTag::id);
    const TagView view{camera, seen.rig, sighting.corners};
    const std::vector<TagEstimate> estimates = estimate_tag_pose({&view, 1}, tag.size);
    if (!estimates.empty()) tag.map_from_tag = estimates[0].world_from_tag;
    moved.push_back(tag);
  }
  return moved;
}

std::vector<SessionEvent> OfflineTracker::note_view(const Seen& seen, const Mapper& mapper) {
  const HybridTrack& track = seen.track;
  const OfflineView before = mission_.view();
  mission_.note(track, seen.frame.time, seen.step,
                {track.offline_expected, track.offline_inliers, seen.image_is_faulty, seen.frame.features->size()});
  const OfflineView now = mission_.view();
  const bool is_agreed = now == OfflineView::held && !track.maps_disagree;
  const bool is_held = is_agreed && track.offline_inliers >= kOfflineThatHolds;
  if (const auto newest = mapper.newest_keyframe(); is_held && newest) {
    last_held_keyframe_ = newest->number;
    if (held_keyframes_.empty() || held_keyframes_.back() != *newest) held_keyframes_.push_back(*newest);
  }
  is_drift_closed_ = is_held || (is_agreed && track.offline_inliers >= track.online_inliers());
  const ScratchVector<PointId> due = mission_.due_for_retest(seen.offline_around);
  if (!due.empty()) {
    TrackOptions options = options_.track;
    options.hidden = seen.hidden;
    mission_.note_retest(
        search_points(seen.frame, track.tracked.camera_from_world, seen.rig, mapper.map(), due, options));
  }
  if (now == before || now == OfflineView::changed) return {};
  if (now == OfflineView::off_the_map) return {SessionEvent::left_mapped_area};
  return {now == OfflineView::blinded ? SessionEvent::blinded : SessionEvent::entered_mapped_area};
}

// Grows the records for maps in memory whose point numbers have gaps; those of files have none.
PointRecord& OfflineTracker::record_of(PointId point) {
  if (point.number >= point_records_.size()) point_records_.resize(point.number + 1);
  return point_records_[point.number];
}

// Points hidden from the pose by walls, by dirt or by darkness are not missed: they were seen from nearby keyframes,
// and the share of points seen weighs the frame.
void OfflineTracker::record_points(const Seen& seen) {
  if (seen.view == nullptr || !seen.view->is_near_keyframe || seen.image_is_faulty || seen.track.maps_disagree) return;
  const auto count = [](const ScratchVector<PointId>& points) { return static_cast<float>(points.size()); };
  const float share = std::min(count(seen.view->seen) / count(seen.view->expected), 1.0f);
  for (const PointId id : seen.view->expected) {
    PointRecord& record = record_of(id);
    ++record.expected;
    record.seen += std::ranges::binary_search(seen.view->seen, id);
    record.due += share;
  }
  for (const PointId id : seen.track.offline_moved) ++record_of(id).elsewhere;
}

void OfflineTracker::mark_lost() {
  mission_.forget_reference();
  mission_.forget_registrations();
}

void OfflineTracker::search_in_background(const PlaceQuery& query, const PoseFilter& pose_filter,
                                          const Mapper& mapper) {
  constexpr double kVerifyEvery = 1.0;  // seconds
  const PlaceHypothesis& place = pose_filter.place();
  if (!search_.is_idle() || mapper.has_correction() || (place.is_accepted() && !place.is_confirmed())) return;
  const bool is_due = !last_search_ || to_seconds(query.frame.time - *last_search_) >= kVerifyEvery;
  is_verifying_search_ = !is_search_needed(pose_filter, mapper);
  if (is_verifying_search_ && (is_certain(pose_filter) || !is_due)) return;
  last_search_ = query.frame.time;
  const bool is_hint_to_be_checked = pose_filter.is_by_hint() && mapper.submaps().is_registered();
  // A find elsewhere refutes an accepted pose, so the motion measured from that pose must not constrain the search.
  const bool is_reach_uncertain = pose_filter.place().is_accepted() && mapper.submaps().is_registered();
  search_.request([frame = query.frame, rig = query.rig, hint = is_hint_to_be_checked ? std::nullopt : query.hint,
                   reach = is_reach_uncertain ? std::nullopt : query.reach, hidden = query.hidden, offline = offline_,
                   options = PlaceSearchOptions{options_.relocalise, options_.mission.bounds}] {
    return search_place(*offline, {frame, rig, hint, reach, hidden}, options);
  });
}

bool OfflineTracker::is_search_needed(const PoseFilter& pose_filter, const Mapper& mapper) const {
  return !mapper.submaps().is_registered() || !pose_filter.place().is_accepted() ||
         mission_.distance_since_offline() > options_.mission.search_after;
}

// A much more likely rival replaces the place. The online map is corrected if offline points do not constrain it.
OfflineTracker::MissionUpdate OfflineTracker::process_search(const std::optional<PlaceSearch>& search,
                                                             const PoseFilter& pose_filter, const Mapper& mapper) {
  const PlaceHypothesis& place = pose_filter.place();
  const auto of_path = [&](const Pose& rival_from_place) { return log_odds_of_path(rival_from_place, mapper); };
  is_refuted_ = pose_filter.has_pose() && mapper.submaps().is_registered() &&
                rivals_.refute(place, pose_filter.is_by_hint(), of_path);
  if (is_refuted_)
    return {.refutes_pose = true, .refutes_earlier_poses = place.is_accepted() || pose_filter.is_by_hint()};
  if (!search) return {};
  const Submaps& submaps = mapper.submaps();
  if (!pose_filter.has_pose() || mapper.has_correction()) return {};
  const AnchoredPose* const then = pose_filter.trajectory().find(search->time);
  if (then == nullptr || submaps.frame(then->submap) != submaps.frame()) return {};
  const Pose camera_from_online = camera_from_world(mapper.map(), *then);
  const bool is_in_place = then->submap == submaps.present() && submaps.is_registered();
  if (is_in_place) {
    std::vector<Pose> places;
    for (const FoundPlace& found : search->places) places.push_back(found.camera_from_offline);
    propose_rivals(search->time, camera_from_online, places, search->rig, pose_filter, mapper);
  }
  if (!place.is_confirmed()) return {};
  if (submaps.frame() != Submaps::kMapFrame) {
    return {.correction = correction_by(search->places, camera_from_online, submaps.frame(), pose_filter)};
  }
  if (!search->found) return {};
  const FoundPlace& found = *search->found;
  if (is_in_place && (place.is_accepted() || pose_filter.is_by_hint())) {
    constexpr double kElsewhere = 0.5;  // metres
    if (pose_filter.is_by_hint() &&
        agreement_of(found.camera_from_offline, camera_from_online).translation <= kElsewhere) {
      return {.agrees_with_hint = true};
    }
    if (is_verifying_search_) return {};
  }
  return {.correction = correction_by({&found, 1}, camera_from_online, submaps.frame(), pose_filter)};
}

// Tracking was continuous, so the robot was not carried: a find beyond the drift bound is a look-alike place.
std::optional<OnlineCorrection> OfflineTracker::correction_by(std::span<const FoundPlace> places,
                                                              const Pose& camera_from_online, Submaps::Frame frame,
                                                              const PoseFilter& pose_filter) {
  const bool is_registered = frame == Submaps::kMapFrame;
  std::vector<Mission::RegistrationEvidence> seen;
  for (const FoundPlace& found : places) {
    const bool is_possible =
        !is_registered || is_within(agreement_of(found.camera_from_offline, camera_from_online), mission_.drift());
    if (!is_possible) continue;
    seen.push_back({inverse(found.camera_from_offline) * camera_from_online, inverse(camera_from_online).translation,
                    found.median_depth, found.view});
  }
  if (seen.empty()) return std::nullopt;
  const auto confirmed = mission_.test_registrations(seen, [&](const Pose& offline_from_online) {
    return begun_registration(offline_from_online, is_registered, pose_filter);
  });
  if (!confirmed) return std::nullopt;
  if (is_registered) return OnlineCorrection{frame, last_held_keyframe_, *confirmed, CorrectionShape::spread};
  return OnlineCorrection{frame, 0, *confirmed, CorrectionShape::rigid};
}

std::optional<OnlineCorrection> OfflineTracker::correction_by(const HybridTrack& track, const PoseFilter& pose_filter,
                                                              const Mapper& mapper) {
  if (!track.is_online_displaced()) return std::nullopt;
  const PlaceView tested_already;
  const Mission::RegistrationEvidence seen{inverse(*track.from_offline) * *track.from_online,
                                           inverse(*track.from_online).translation,
                                           median_depth(track.tracked, mapper.map()), tested_already};
  const auto confirmed = mission_.test_registrations({&seen, 1}, [&](const Pose& offline_from_online) {
    return begun_registration(offline_from_online, true, pose_filter);
  });
  if (!confirmed) return std::nullopt;
  return OnlineCorrection{mapper.submaps().frame(), last_held_keyframe_, *confirmed, CorrectionShape::spread};
}

// In the map's frame the test of the present place continues; otherwise a new test begins.
PlaceHypothesis OfflineTracker::begun_registration(const Pose& offline_from_online, bool is_registered,
                                                   const PoseFilter& pose_filter) const {
  const RegistrationOptions& options = options_.mission.registration;
  if (!is_registered) {
    const double prior = pose_filter.log_odds_of_registration(offline_from_online);
    return PlaceHypothesis(prior, options.confirmations, options.accept_log_odds);
  }
  PlaceHypothesis place = pose_filter.place();
  place.require_confirmations(options.confirmations);
  return place;
}

Health OfflineTracker::with_map_health(Health health, Timestamp now, Timestamp first_frame) const {
  health.focal_error = focal_check_.error();
  health.suspended = mission_.moved_points().count();
  health.distance_since_offline = mission_.distance_since_offline();
  health.seconds_since_offline = to_seconds(now - mission_.last_offline_time().value_or(first_frame));
  return health;
}

}  // namespace byre
