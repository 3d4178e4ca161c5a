#pragma once

#include "byre/base/job_slot.h"
#include "byre/map/map_upkeep.h"
#include "byre/session_event.h"
#include "byre/slam/frame/focal_check.h"
#include "byre/slam/localisation/look_alike_places.h"
#include "byre/slam/localisation/mission.h"
#include "byre/slam/localisation/mission_calibrator.h"
#include "byre/slam/localisation/place_search.h"
#include "byre/slam/localisation/pose_filter.h"
#include "byre/slam/localisation/rival_places.h"
#include "byre/slam/mapping/mapper.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

struct OfflineTrackerOptions {
  MissionOptions mission;
  TrackOptions track;
  LocaliseOptions relocalise;  // for place searches in parallel with tracking
  int local_keyframes = 15;    // see SessionOptions
  bool is_planar = false;      // constrains the body to the ground that the map was driven on
};

// The part of the method that needs an offline map: the registration to it, place searches in parallel with tracking,
// and evidence about the online map's pose and the cameras. A value.
class OfflineTracker {
 public:
  OfflineTracker(std::shared_ptr<const OfflineMap> offline, const OfflineTrackerOptions& options);

  // Jobs, for the owner to run; nullptr without calibration.
  JobState& search_job() { return search_; }
  JobState* calibration_job() { return calibrator_ ? &calibrator_->job() : nullptr; }

  const Mission& mission() const { return mission_; }
  const std::optional<MissionCalibrator>& calibrator() const { return calibrator_; }
  // The frame by the refined calibration, if there is one, without the tags found moved.
  Frame corrected(const Frame& frame);
  // A rival is to replace the place, see find_at_rival().
  bool is_place_refuted() const { return is_refuted_; }
  bool is_focal_length_off() const { return focal_check_.is_off(); }
  // Ground that constrains the body; nullptr if unknown, or if the last pose is not in the map's frame.
  const DrivenGround* ground_under(const PoseFilter& pose_filter, const Mapper& mapper) const;

  // Before the first frame.
  void refine_calibration(const Calibration& given, double prior_sigmas);
  void continue_calibration(MissionCalibrator calibrator) { calibrator_ = std::move(calibrator); }

  // Once for each frame.
  std::optional<MissionCalibrator::Switch> collect_camera();
  std::optional<PlaceSearch> collect_place();
  bool is_focal_check_due() { return focal_check_.is_due(); }  // whether this frame weighs focal lengths

  // A frame tracked while the online map is registered in the offline one.
  struct Seen {
    const Frame& frame;
    const HybridTrack& track;
    const Rig& rig;
    double step = 0.0;  // metres from the frame before
    bool image_is_faulty = false;
    std::span<const PointId> offline_around;  // suspended points included
    const ImageMask& hidden;                  // image cells without expected points
    const PlaceView* view = nullptr;          // part of the map in view, if computed
  };
  // Effect of a frame, or of a place search, on the session.
  struct MissionUpdate {
    std::vector<SessionEvent> events{};
    std::vector<MappedTag> moved_tags{};  // at their places now
    bool refutes_pose = false;            // the robot is elsewhere
    // Earlier trusted poses were wrong, since an unknown time.
    bool refutes_earlier_poses = false;
    bool agrees_with_hint = false;                 // a search of the whole map confirms the place found by a hint
    std::optional<OnlineCorrection> correction{};  // true pose of a part of the online map
  };
  // Whether the next tracked frame is evidence for its place: each frame until the place is beyond doubt, then every
  // third, to save time, and those that show tags.
  bool is_view_due(const Frame& frame, const PoseFilter& pose_filter);
  // The part of the map in view of a frame that was tracked in the map's frame. finds_rivals: marks points that a
  // look-alike place has as well, needed while the place is not accepted; takes 10 ms at a new place.
  PlaceView view_of(const Frame& frame, const HybridTrack& track, const Rig& rig, const ImageMask& hidden,
                    bool finds_rivals);
  // Log-odds of a frame's pose by that frame alone.
  double log_odds_of(const Frame& frame, const HybridTrack& track, const Rig& rig, const ImageMask& hidden);
  // See RivalPlaces.
  const PlaceHypothesis* find_place_test(Timestamp time, const Pose& camera_from_offline) const {
    return rivals_.find_test(time, camera_from_offline);
  }
  // Begins a place found without a prediction. Returns its test by earlier frames; empty for a new place.
  std::optional<PlaceHypothesis> begin_place(Timestamp time, const Pose& camera_from_place);
  // Tracks a frame at the rival that refuted the last frame's place; empty without one.
  std::optional<TrackedFrame> find_at_rival(const Frame& frame, const Rig& rig, const ImageMask& hidden);
  // Tests a tracked frame at the rivals of its place. New rivals are the other places at which the search found the
  // frame (elsewhere) and, while the place is not accepted, look-alike places of the map.
  void test_rivals(const Seen& seen, std::span<const HybridTrack> elsewhere, const PoseFilter& pose_filter,
                   const Mapper& mapper);
  // Log of the sum of the odds of the look-alike places that a place, not accepted yet, is tested against.
  double log_odds_of_rivals() const;
  MissionUpdate note(const Seen& seen, const PoseFilter& pose_filter, const Mapper& mapper);
  // Once for each frame. search: a search that ended since the last frame.
  MissionUpdate process_search(const std::optional<PlaceSearch>& search, const PoseFilter& pose_filter,
                               const Mapper& mapper);
  void note_focal_length(const FocalEvidence& evidence) { focal_check_.note(evidence); }
  // A submap begins in which offline points do not constrain the pose yet.
  void begin_submap() {
    mission_.forget_reference();
    rivals_.forget();
    held_keyframes_.clear();
  }
  void mark_lost();

  // Searches the last frame in the offline map in parallel with tracking: while its points do not constrain the pose,
  // or may do so by chance, and once a second while the place is in doubt. A place found by a hint is searched without
  // the hint.
  void search_in_background(const PlaceQuery& query, const PoseFilter& pose_filter, const Mapper& mapper);

  // What the frames showed of the offline map's points, by number.
  const std::vector<PointRecord>& point_records() const { return point_records_; }

  // The last frame showed enough offline points, or more than online ones, to end the drift, see PoseFilter::note_held.
  bool is_drift_closed() const { return is_drift_closed_; }
  // Standard error of the lengths in the last frame, as a share.
  double length_sigma() const { return length_sigma_; }

  // Adds measures of the offline map.
  Health with_map_health(Health health, Timestamp now, Timestamp first_frame) const;

 private:
  double length_sigma_of(const Features& features) const;
  std::vector<SessionEvent> note_view(const Seen& seen, const Mapper& mapper);
  void record_points(const Seen& seen);
  PointRecord& record_of(PointId point);
  std::vector<Pose> camera_by_contradicting_tags(const Seen& seen) const;
  std::vector<MappedTag> find_moved_tags(const Seen& seen, const PoseFilter& pose_filter);
  ScratchVector<PointId> points_around(const Pose& camera_from_offline) const;
  std::optional<TrackedFrame> track_at(const Frame& frame, const Pose& predicted, std::span<const PointId> points,
                                       const Rig& rig, const ImageMask& hidden) const;
  // features: receives the features tracked there.
  RivalPlaces::View view_at_rival(const Frame& frame, const Pose& predicted, const Rig& rig, const ImageMask& hidden,
                                  std::vector<int>* features = nullptr) const;
  // Look-alikes of a place, and those of the places since the last certain one: a building repeats at a shift, but not
  // each of its places has enough points that do.
  std::span<const LookAlikePlace> look_alikes_at(const Pose& camera_from_place);
  std::vector<PointId> points_in_common(const TrackedFrame& tracked);
  void propose_rivals(Timestamp time, const Pose& camera_from_place, std::span<const Pose> rivals, const Rig& rig,
                      const PoseFilter& pose_filter, const Mapper& mapper);
  double log_odds_of_path(const Pose& rival_from_place, const Mapper& mapper) const;
  bool is_search_needed(const PoseFilter& pose_filter, const Mapper& mapper) const;
  // Empty until enough frames agree.
  std::optional<OnlineCorrection> correction_by(const HybridTrack& track, const PoseFilter& pose_filter,
                                                const Mapper& mapper);
  // places: those of one search, which contradict each other.
  std::optional<OnlineCorrection> correction_by(std::span<const FoundPlace> places, const Pose& camera_from_online,
                                                Submaps::Frame frame, const PoseFilter& pose_filter);
  PlaceHypothesis begun_registration(const Pose& offline_from_online, bool is_registered,
                                     const PoseFilter& pose_filter) const;

  OfflineTrackerOptions options_;              // constant after construction
  std::shared_ptr<const OfflineMap> offline_;  // constant after construction

  Mission mission_;
  int frames_since_view_ = 0;
  ScratchVector<KeyframeId> nearby_keyframes_;  // keyframes near the last view_of
  ScratchVector<PointId> nearby_points_;        // points that these keyframes see
  RivalPlaces rivals_;
  ScratchVector<KeyframeId> keyframes_of_look_alikes_;  // keyframes of the last place that was not accepted
  std::vector<int> features_at_rivals_;                 // features of the frame that were tracked at rivals, ascending
  std::vector<LookAlikePlace> look_alikes_;             // see look_alikes_at()
  std::size_t present_look_alikes_ = 0;                 // number of that place's own look-alikes, the first ones
  int untestable_ = 0;                                  // look-alike places of the last view_of that cannot be tested
  bool shows_tag_ = false;                              // whether an agreeing tag is in that view
  int frames_since_rivals_ = 0;
  bool is_refuted_ = false;  // see RivalPlaces::refute
  std::optional<Timestamp> last_search_;
  std::vector<TagId> moved_tags_;     // ignored
  bool is_verifying_search_ = false;  // the running search is due to doubt, not to need
  JobSlot<PlaceSearch> search_;
  std::optional<MissionCalibrator> calibrator_;
  bool is_drift_closed_ = false;
  double length_sigma_ = 0.0;
  FocalCheck focal_check_;
  std::vector<PointRecord> point_records_;  // by number of the offline point
  // Number of the newest online keyframe when offline points last constrained the pose.
  std::uint32_t last_held_keyframe_ = 0;
  std::vector<KeyframeId> held_keyframes_;  // newest keyframes of the unbroken path while offline points held the pose
};

}  // namespace byre
