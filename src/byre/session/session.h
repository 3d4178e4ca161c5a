#pragma once

#include "byre/frame_report.h"
#include "byre/localisation/offline_tracker.h"
#include "byre/localisation/standing_hint.h"
#include "byre/localisation/trusted_place.h"
#include "byre/localisation/whereabouts.h"
#include "byre/mapping/keyframe_watch.h"
#include "byre/mapping/mapper.h"
#include "byre/mapping/shutter.h"
#include "byre/session/frame_summary.h"
#include "byre/session/session_options.h"
#include "byre/session/tracker.h"
#include "byre/slam/frame_budget.h"
#include "byre/slam/health.h"
#include "byre/slam/input_watch.h"
#include "byre/slam/lens_watch.h"
#include "byre/slam/state.h"
#include "byre/workers/executor.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Where mapping runs: the neighbourhood of new keyframes, and corrections of the whole map; in a mission on an offline
// map the second looks for places in that instead.
struct Lanes {
  // NOLINTNEXTLINE(google-explicit-constructor): a session that is to close no loops needs one lane
  Lanes(std::unique_ptr<Executor> local_lane, std::unique_ptr<Executor> global_lane = make_inline_executor(),
        std::unique_ptr<Executor> calibration_lane = make_inline_executor(),
        std::unique_ptr<Executor> reading_lane = make_inline_executor())
      : local(std::move(local_lane)),
        global(std::move(global_lane)),
        calibration(std::move(calibration_lane)),
        reading(std::move(reading_lane)) {}

  std::unique_ptr<Executor> local;
  std::unique_ptr<Executor> global;
  std::unique_ptr<Executor> calibration;  // calibrating a mission's cameras
  std::unique_ptr<Executor> reading;      // looking at the map itself, which does not change meanwhile
};

// The one stateful object: give it frames in order of time. It has the tracker find each frame, and the mapper make
// keyframes of some; what is known of the pose is kept in its whereabouts. Call every method from one thread; only the
// executors have others.
class Session {
 public:
  // With a vocabulary the session recognises places: it closes loops, and finds itself again when lost.
  // With an offline map it is a mission on that: it finds itself in it, and its poses are in the map's frame.
  Session(const Rig& rig, const SessionOptions& options, Lanes lanes, std::optional<Vocabulary> vocabulary = {},
          std::shared_ptr<const OfflineMap> offline = nullptr);

  // What wheels tell of the way between keyframes, and of how far the robot can be. Call it before the first frame.
  void hear(TellMotion tell, TellReach reach) {
    mapper_.hear(std::move(tell));
    whereabouts_.hear(std::move(reach));
  }

  // Goes on with a map made before, of another recording: the session is lost until it finds itself in it, and what it
  // maps becomes part of it. Call it before the first frame, with a vocabulary whose words the keyframes have.
  void continue_map(Map online);

  // The calibration by which the frames are rectified may err, and is refined from what is seen, the readout time of a
  // rolling shutter with it. Call it before the first frame.
  void refine_calibration(const Calibration& given, const SelfCalibrationOptions& options);

  // Refines the readout time alone, and keeps all else as it is known to be. Call it before the first frame.
  void refine_readout(const RefinedCalibration& known);

  // What is known of the calibration by now; empty until it was refined.
  std::optional<RefinedCalibration> self_calibration() const;

  // Where the robot is in the offline map, as somebody says: where it is looked for from nothing while the hint counts.
  void look_near(const PoseHint& hint) {
    hint_.give(hint);
    trusted_place_.forget();
  }

  // While it is paused frames are tracked on the map as it is, and nothing is added to it.
  void pause_mapping(bool is_paused) { is_mapping_paused_ = is_paused; }
  bool is_mapping_paused() const { return is_mapping_paused_; }

  // How the body is tilted at the next frame, where that is known: of use where nothing is seen.
  void tell_tilt(const std::optional<BodyTilt>& tilt) { whereabouts_.tell_tilt(tilt); }
  int tilts_held() const { return whereabouts_.tilts_held(); }  // frames of which it was of use
  // motion: of the body since the last frame, where that is known. budget: what the frame may take, if that is limited;
  // its begin() was called, and its end() is left to the caller.
  FrameReport process(const Frame& rectified, const std::optional<BodyMotion>& motion = {},
                      FrameBudget* budget = nullptr);

  // A correction of the whole map that is in flight ends soon, with what it has reached: for stopping early.
  void hurry() { mapper_.hurry(); }

  // Takes over what mapping still has to give. Call it once, after the last frame.
  void finish();

  // The last search for loops and adjustment of the whole map. Call it after finish().
  FinishReport finish_map(const FinishHooks& hooks);
  Map take_online() { return mapper_.take_online(); }  // see Mapper

  // All lengths so many times as long. Call it after finish_map().
  void stretch(double factor) { whereabouts_.follow(mapper_.stretch(factor)); }

  // Adjusts all that was mapped beside the offline map at once, around that. Call it after finish().
  void finish_mission(const FinishHooks& hooks);

  MapView map() const { return mapper_.map(); }

  // Map points matched in the last frame; none when it had no pose.
  const std::vector<SeenPoint>& seen_points() const { return seen_; }

  // Places found again so far, each with what was seen of it then.
  const std::vector<LoopEdge>& loops() const { return mapper_.loops(); }

  // Every frame that had a pose, recomputed from its keyframe as that one lies now. world_from_body.
  Trajectory final_trajectory() const;

 private:
  // What a frame came to.
  struct Located {
    std::optional<HybridTrack> track;
    std::vector<HybridTrack> elsewhere;  // other places that show the frame
    bool from_nothing = false;
    bool is_by_hint = false;     // it was looked for near a hint alone
    bool begins_submap = false;  // a first keyframe was made of it
    TwoViewFailure start_failure = TwoViewFailure::none;
    Doubt refused = Doubt::none;  // why the robot cannot be where it was found
  };

  void take_over_results(FrameReport& report);
  void take_over_place(FrameReport& report);
  bool take_over_camera();
  void take_turn(const RigTurn& turn);
  InputFrame input_of(const Frame& rectified, const std::optional<BodyMotion>& motion);
  void put_most_likely_first(std::vector<HybridTrack>& places, const Frame& frame);
  Located locate(const InputFrame& input);
  bool may_begin_submap(const InputFrame& input) const;
  Located begin_submap(const Frame& frame);
  void remember(const InputFrame& input, const Located& located, FrameReport& report);
  void look_for_dirt(const InputFrame& input, const Located& located, FrameReport& report);
  void extend_map(const InputFrame& input, const HybridTrack& track, FrameReport& report);
  bool may_add_keyframe(const InputFrame& input, const HybridTrack& track);
  bool look_for_loop(const Frame& frame, bool keyframe_added);
  void lose_pose(ImageFault fault, FrameReport& report);
  void note_quality(const FrameReport& report);

  SessionOptions options_;  // constant after construction

  // Owned by the calling thread.
  Rig rig_;  // rig of the frames that come
  Mapper mapper_;
  Tracker tracker_;
  std::optional<OfflineTracker> mission_;
  StandingHint hint_;
  Whereabouts whereabouts_;
  KeyframeWatch keyframe_watch_;
  InputWatch input_watch_;
  LastingDoubts doubts_;
  LensWatch lens_watch_;
  Shutter shutter_;
  State state_ = State::initialising;
  std::optional<Timestamp> first_frame_;
  TrustedPlace trusted_place_;
  bool is_error_told_ = false;  // a navigation error
  bool is_mapping_paused_ = false;
  std::vector<SeenPoint> seen_;  // in the last frame
};

}  // namespace byre
