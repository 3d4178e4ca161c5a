#pragma once

#include "byre/localisation/mission.h"
#include "byre/localisation/mission_calibrator.h"
#include "byre/localisation/place_search.h"
#include "byre/localisation/places_alike.h"
#include "byre/localisation/rival_places.h"
#include "byre/localisation/whereabouts.h"
#include "byre/mapping/mapper.h"
#include "byre/session_event.h"
#include "byre/slam/focal_check.h"
#include "byre/workers/worker.h"

#include <memory>
#include <optional>
#include <vector>

namespace byre {

struct OfflineTrackerOptions {
  MissionOptions mission;
  TrackOptions track;
  LocaliseOptions relocalise;  // for place searches beside tracking
  int local_keyframes = 15;    // see SessionOptions
  bool is_planar = false;      // the body is held to the ground that the map was driven on
};

// What a mission on an offline map adds to a session: the way in that map, places looked for in it beside tracking,
// what it says of the online map's place and of the cameras. Called from the session's thread.
class OfflineTracker {
 public:
  // Where places are looked for, and where calibrations are worked out.
  struct Lanes {
    std::unique_ptr<Executor> search;
    std::unique_ptr<Executor> calibration;
  };

  OfflineTracker(std::shared_ptr<const OfflineMap> offline, const OfflineTrackerOptions& options, Lanes lanes);

  const Mission& mission() const { return mission_; }
  const std::optional<MissionCalibrator>& calibrator() const { return calibrator_; }
  // The frame as the calibration that is refined has it; itself without one.
  Frame corrected(const Frame& frame) { return calibrator_ ? calibrator_->corrected(frame) : frame; }
  bool is_focal_length_off() const { return focal_check_.is_off(); }
  // What the body is held to; nullptr where nothing is known of it, or the last pose does not lie in the map's frame.
  const DrivenGround* ground_under(const Whereabouts& whereabouts, const Mapper& mapper) const;

  // Before the first frame.
  void refine_calibration(const Calibration& given, double prior_sigmas);

  // Once for each frame.
  std::optional<MissionCalibrator::Switch> collect_camera();
  std::optional<PlaceSearch> collect_place();
  bool ask_for_focal_length() { return focal_check_.is_due(); }  // whether this frame is to be asked

  // A frame tracked while the online map is known to lie in the offline one.
  struct Seen {
    const Frame& frame;
    const HybridTrack& track;
    const Rig& rig;
    double step = 0.0;  // metres from the frame before
    bool image_is_faulty = false;
    std::span<const PointId> offline_around;  // suspended ones included
    const HiddenCells& hidden;                // where no points are asked for
  };
  // What a frame, or a place found, means for the session.
  struct Consequence {
    std::vector<SessionEvent> events{};
    bool refutes_pose = false;                     // the robot is elsewhere
    bool refutes_way = false;                      // it was elsewhere while it was trusted, nobody knows since when
    bool agrees_with_hint = false;                 // it is where a hint had led, and nowhere else
    std::optional<OnlineCorrection> correction{};  // where a part of the online map really lies
  };
  // Whether the next tracked frame is evidence for its place: each frame until the place is beyond doubt, then one in
  // three, to save time.
  bool is_view_due(const Whereabouts& whereabouts);
  // The part of the map that a frame, tracked in the map's frame, shows. finds_rivals: points that a place alike has as
  // well are marked, as a place needs that is not accepted yet; costs 10 ms at a new place.
  PlaceView view_of(const Frame& frame, const HybridTrack& track, const Rig& rig, const HiddenCells& hidden,
                    bool finds_rivals);
  // Log-odds of a frame's pose by what that frame alone shows.
  double log_odds_of(const Frame& frame, const HybridTrack& track, const Rig& rig, const HiddenCells& hidden);
  // See RivalPlaces.
  const PlaceHypothesis* known_place_at(Timestamp time, const Pose& camera_from_offline) const {
    return rivals_.known_at(time, camera_from_offline);
  }
  // A frame was found at a place without a prediction. Returns the test of that place by earlier frames, if there is
  // one.
  std::optional<PlaceHypothesis> begin_place(Timestamp time, const Pose& camera_from_place);
  // Tracks a frame at the rival that refuted the last frame's place; empty if none did.
  std::optional<TrackedFrame> find_at_rival(const Frame& frame, const Rig& rig, const HiddenCells& hidden);
  // Tests a tracked frame at the rivals of its place. New rivals are the places elsewhere, at which the search found
  // the frame as well, and, while the place is not accepted, places that look alike in the map.
  void test_rivals(const Seen& seen, std::span<const HybridTrack> elsewhere, const Whereabouts& whereabouts,
                   const Mapper& mapper);
  // Log of the sum of the odds of the places alike that a place, not accepted yet, is tested against.
  double log_odds_of_rivals() const;
  Consequence note(const Seen& seen, const Whereabouts& whereabouts, const Mapper& mapper);
  // Once for each frame. search: a search that has ended since the last frame.
  Consequence consider(const std::optional<PlaceSearch>& search, const Whereabouts& whereabouts, const Mapper& mapper);
  void note_focal_length(const FocalEvidence& evidence) { focal_check_.note(evidence); }
  // A submap begins where offline points do not hold the pose yet.
  void begin_submap() {
    mission_.forget_reference();
    rivals_.forget();
  }
  void lose();

  // Looks for the last frame in the offline map beside tracking: while its points do not hold the pose, or may do so by
  // chance, and from time to time where few of them are seen. What a hint led to is looked for everywhere.
  void search_beside(const SoughtFrame& sought, const Whereabouts& whereabouts, const Mapper& mapper);

  // A health with what is known of the offline map in it.
  Health added_to(Health health, Timestamp now, Timestamp first_frame) const;

  void finish();  // waits for what is in flight, and forgets what comes of it

 private:
  std::vector<SessionEvent> note_view(const Seen& seen, const Mapper& mapper);
  ReusedVector<PointId> points_around(const Pose& camera_from_offline) const;
  std::optional<TrackedFrame> track_at(const Frame& frame, const Pose& predicted, std::span<const PointId> points,
                                       const Rig& rig, const HiddenCells& hidden) const;
  RivalPlaces::View view_at_rival(const Frame& frame, const Pose& predicted, const Rig& rig,
                                  const HiddenCells& hidden) const;
  std::span<const PlaceAlike> alike_at(const Pose& camera_from_place);
  bool is_untestable(const Pose& camera_from_alike) const;
  std::vector<PointId> points_in_common(const Pose& camera_from_place);
  struct PlaceOfFrame {
    Timestamp time{};
    Pose camera_from_offline;
  };
  void propose_rivals(const PlaceOfFrame& place, std::span<const Pose> rivals, const Rig& rig,
                      const Whereabouts& whereabouts, const Mapper& mapper);
  bool is_search_needed(const Whereabouts& whereabouts, const Mapper& mapper) const;
  // Once enough frames agree.
  std::optional<OnlineCorrection> correction_by(const HybridTrack& track, const Whereabouts& whereabouts,
                                                const Mapper& mapper);
  std::optional<OnlineCorrection> correction_by(const FoundPlace& found, const Pose& camera_from_online,
                                                Submaps::Frame frame, const Whereabouts& whereabouts);
  PlaceHypothesis begun_registration(const Pose& offline_from_online, bool is_registered,
                                     const Whereabouts& whereabouts) const;

  OfflineTrackerOptions options_;              // constant after construction
  std::shared_ptr<const OfflineMap> offline_;  // constant after construction

  Mission mission_;
  int frames_since_view_ = 0;
  ReusedVector<KeyframeId> nearby_keyframes_;  // keyframes near the last view_of
  ReusedVector<PointId> nearby_points_;        // points seen by these keyframes
  RivalPlaces rivals_;
  ReusedVector<KeyframeId> keyframes_of_alike_;  // keyframes of the last place that was not accepted
  std::vector<PlaceAlike> alike_;                // places that look like it
  int untestable_ = 0;                           // untestable places alike at the pose of the last view_of
  int frames_since_rivals_ = 0;
  bool is_refuted_ = false;  // see RivalPlaces::refute
  std::optional<Timestamp> last_search_;
  bool is_search_by_doubt_ = false;  // the one in flight, and not by need
  Worker<PlaceSearch> search_;
  std::unique_ptr<Executor> calibration_lane_;  // until calibration begins
  std::optional<MissionCalibrator> calibrator_;
  FocalCheck focal_check_;
  std::uint32_t last_held_keyframe_ = 0;  // number of the newest online keyframe when offline points last held the pose
};

}  // namespace byre
