#pragma once

#include "byre/base/serial_queue.h"
#include "byre/map/map_upkeep.h"
#include "byre/slam.h"
#include "byre/slam/system/active_map.h"
#include "byre/slam/system/input_check.h"
#include "byre/slam/system/logged_executor.h"
#include "byre/slam/system/method_options.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Wall times of the stages of a frame, seconds. All except decode run sequentially on the frame thread.
struct StageSeconds {
  double decode = 0.0;  // decoding ahead on its own thread; not part of total
  double rectify = 0.0;
  double extract = 0.0;
  double stereo = 0.0;  // stereo matching, or conversion of depths
  double track = 0.0;
  double map = 0.0;         // windows, deltas, new points, and jobs run on this thread
  double map_submit = 0.0;  // part of map: submitting jobs, including jobs run on this thread
  double total = 0.0;       // from decoded images to the report
};

// Result of finishing a map.
struct FinishResult {
  FinishReport report;
  bool cut_short = false;           // stopped early on request
  double seconds = 0.0;             // wall time
  std::vector<std::string> faults;  // faults of the saved map
};

// Offline map of a mission, alone or one of a site.
struct MissionMap {
  std::string name;  // in the site; empty without a site
  std::shared_ptr<const OfflineMap> offline;
  std::filesystem::path file;
  std::uint64_t id = 0;                              // see map_id
  std::optional<PlanRegistration> plan{};            // registration on a floor plan
  std::optional<std::filesystem::path> plan_file{};  // file of the plan, if a site names it
};

// Maps and names of a Slam.
struct SlamInputs {
  std::optional<Vocabulary> vocabulary{};       // without it neither loop closing nor finishing
  std::string recording = "live";               // name of this session in a saved map
  std::optional<Extrinsics> extrinsics{};       // robot's, with its camera
  std::string site{};                           // place where the map is made, stored in it unless empty
  std::vector<MissionMap> maps{};               // offline maps; empty unless a mission
  std::vector<SiteLink> links{};                // between the maps
  std::shared_ptr<const OfflineMap> offline{};  // active map of a mission; null otherwise
  std::optional<PlanRegistration> plan{};       // registration of the active or extended map on a floor plan
  int max_waiting = 1;                          // frames of submit() that wait for its thread
  StoredMap extended{};                         // data of the map to extend, without keyframes and points
  std::vector<Tag> tags{};                      // tags to map
  std::optional<MapGraph> before{};  // keyframes and points of that map: an online copy with words of the vocabulary
};

// Everything behind Slam: front end of the cameras, session, checks of inputs. All but calls() and submit() are called
// from one thread, or as tasks of calls().
class SlamImpl {
 public:
  // given: calibration of the cameras. Throws InputError if it cannot be rectified.
  SlamImpl(const Calibration& given, const MethodOptions& options, SlamInputs inputs,
           const InputCheckOptions& check = {});
  ~SlamImpl() {
    calls_.stop();
    finish_early();
  }
  SlamImpl(const SlamImpl&) = delete;  // executors refer to log_, the session to prior_
  SlamImpl& operator=(const SlamImpl&) = delete;

  // See Slam. Samples are in order of time, before the frame that they lead to.
  void add_wheel_odometry(const StampedPose& odometry_from_base) { prior_.add(odometry_from_base); }
  void add_wheel_odometry(const BaseTwist& velocity) { prior_.add(velocity); }
  void add_gyro(const AngularRate& rate) { prior_.add(rate); }
  void add_accel(const Acceleration& acceleration) { prior_.add(acceleration); }
  // Without effect if the extrinsics of the inputs have an IMU.
  void set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope);
  FrameReport process(const CameraImages& images, const std::optional<BodyMotion>& motion = {});
  FrameReport process(const ImageFrame& images, const std::optional<BodyMotion>& motion = {});
  FrameReport process(const Frame& frame, const std::optional<BodyMotion>& motion = {});
  // Drops a frame that was submitted, and replaced by newer ones.
  FrameReport skip(Timestamp time, const std::optional<BodyMotion>& motion);
  // See Slam::submit. process: calls process() with the images of this time.
  void submit(Timestamp time, std::function<FrameReport()> process, ReportCallback on_report,
              const std::optional<BodyMotion>& motion);
  // Calls of Slam, in order.
  SerialQueue& calls() const { return calls_; }
  void set_initial_pose(const PoseHint& hint) { session_->set_initial_pose(hint); }
  void pause_mapping(bool is_paused) { session_->pause_mapping(is_paused); }

  // Ends tracking, then finishes the map, or the online map of a mission. Empty if already finished, stopped, without a
  // pose or vocabulary, or after damage of the offline map. Does not fill in FinishResult::faults.
  std::optional<FinishResult> finish(const FinishHooks& hooks);

  // Pose world_from_body of a frame without a pose in the finished map; empty if not located. predicted: by frames
  // close in time. Call it after finish().
  std::optional<Pose> locate_in_finished_map(const ImageFrame& images, const Pose& predicted) {
    return session_->locate_in_finished_map(extractor_.extract(images, ImagesUsed::all).frame, predicted);
  }

  // Same without a prediction.
  std::optional<Pose> find_in_finished_map(const ImageFrame& images) {
    return session_->find_in_finished_map(extractor_.extract(images, ImagesUsed::all).frame);
  }

  // Refines the calibration of wheels, and the unit that they gave a monocular map, by frames located in the finished
  // map. Returns these poses in the lengths of the map. all: poses of tracked and of located frames.
  Trajectory refine_by_located(Trajectory all, const std::vector<Timestamp>& located);

  // Damage of the offline map's file, with section and remedy; nullptr if undamaged. Parts already read stay in use;
  // all later reports are untrusted.
  const InputError* map_damage() const { return inputs_.offline ? inputs_.offline->map().damage() : nullptr; }

  const Calibration& given() const { return given_; }
  const MethodOptions& options() const { return options_; }
  const SlamInputs& inputs() const { return inputs_; }
  const InputCheck& input() const { return check_; }
  const Rig& rig() const { return extractor_.rig(); }
  const MapGraph& online() const { return session_->map().online(); }
  const Session& session() const { return *session_; }
  const JobLog& log() const { return log_; }
  const OdometryCalibrator& prior() const { return prior_; }
  // Faults of motion inputs and tags so far.
  const std::vector<MotionWarning>& warnings() const { return prior_.warnings(); }
  // Times of the last frame, zero for a dropped one. Features of the caller have times of track, map and total only.
  const StageSeconds& seconds() const { return seconds_; }
  // Current poses of all tracked frames, with gaps filled by wheel odometry; each in the map active in its frame.
  Trajectory trajectory() const { return with_filled_gaps(session_->final_trajectory()); }
  // The same from the present session's poses.
  Trajectory with_filled_gaps(Trajectory seen) const;
  // Index of the active map. Precondition: a mission.
  std::size_t active_map() const { return active_->index(); }
  // Registration of the active map on a floor plan. For callers of any thread.
  std::optional<PlanRegistration> plan() const;
  // Calibration of the map; empty if only the given one is available.
  std::optional<RefinedCalibration> calibration() const;
  // Row error of the rectification in use, over all stereo pairs so far.
  const CommonRowError& row_error() const { return row_error_; }
  // Whether lengths are metres. Monocular maps become metric in finish() if tags or wheels determine the scale.
  bool is_metric() const { return is_metric_; }
  // Relative standard deviation of the scale if measured by wheels or tags only; empty if the scale is unknown, or
  // measured by cameras or a map.
  std::optional<double> scale_sigma() const { return scale_sigma_; }
  bool is_scaled_by_tags() const { return is_scaled_by_tags_; }
  // Whether there is a map to save: for an extended map, whether anything was added.
  bool has_mapped() const { return online().keyframe_count() > 0 && (had_pose_ || !is_extended_); }

  // Stored map of this session without keyframes and points: recordings, scale, calibrations, notes.
  StoredMap stored_metadata() const;
  // Stored map of this session.
  StoredMap stored_map() const;
  // What a mission learned, for keeping its offline map up to date. Precondition: a mission.
  std::pair<StoredMap, SessionRecord> session_to_store() const;
  // Same as stored_map(), without copying; the session's map is empty afterwards.
  StoredMap take_stored_map();

 private:
  void refine_calibration();
  void begin_with_extrinsics(const Extrinsics& extrinsics);
  double focal_change() const;  // focal length of the present calibration over that of the given one
  void begin_wheels();
  void warn_of_focal_length();
  void scale_by_tags();
  double scale_by_wheels();  // factor of all lengths; 1 if the motions do not determine it
  void finish_early() { session_->finish_early(); }
  std::optional<BodyMotion> checked(const std::optional<BodyMotion>& motion, Timestamp time);
  // Motion of the body since the last frame that was not dropped.
  std::optional<BodyMotion> take_motion(const std::optional<BodyMotion>& motion, Timestamp time, bool is_dropped);
  FrameReport process_images(const ImageFrame& images, const std::optional<BodyMotion>& motion);
  // Precondition: the frame's budget has begun.
  FrameReport process_in_time(const Frame& frame, const std::optional<BodyMotion>& motion);
  void begin_session(const Rig& rig);
  void begin_site();
  // Notes a mission's frame for the choice of the map. Poses are not trusted before their map is proved.
  std::optional<std::size_t> choose_map(const Frame& frame, FrameReport& report);
  void change_map(std::size_t map, const FrameReport& last);
  void note_moved_tags(const FrameReport& report);
  FrameReport completed(FrameReport report);
  FrameReport dropped(Timestamp time);
  void record_pose(const Frame& frame, const FrameReport& report);

  // Constant after construction.
  Calibration given_;
  MethodOptions options_;
  SlamInputs inputs_;  // except before, which becomes the session's map
  bool is_extended_;
  Eigen::Quaterniond body_from_left_;
  std::optional<RefinedCalibration> initial_calibration_;  // before any frame

  JobLog log_;
  Extractor extractor_;
  std::vector<TagId> moved_tags_;
  InputCheck check_;
  CommonRowError row_error_;
  OdometryCalibrator prior_;
  bool is_metric_;
  std::optional<double> scale_sigma_;  // see scale_sigma()
  bool is_scaled_by_tags_ = false;
  std::optional<Timestamp> last_frame_;
  std::size_t warnings_reported_ = 0;
  FrameBudget budget_;
  StageSeconds seconds_;
  std::optional<Session> session_;       // another one for each change of the map
  std::optional<ActiveMap> active_;      // mission alone
  std::unique_ptr<Executor> site_lane_;  // searches in the maps of a site; null with one map
  std::optional<Timestamp> last_search_;
  Trajectory earlier_poses_;                                // poses of sessions on maps before
  std::optional<Timestamp> map_since_;                      // last frame on the map before
  Pose odometry_before_;                                    // odometry at that frame
  bool was_proved_ = false;                                 // the active map, in this session
  bool is_map_changed_ = false;                             // to be reported
  ImageFrame buffer_;                                       // holds the caller's images during a call
  std::optional<BodyMotion> dropped_motion_ = no_motion();  // motion over dropped frames; empty: unknown
  State state_ = State::initialising;                       // state after the last frame
  std::optional<Timestamp> first_time_;                     // time of the first frame not dropped
  Timestamp last_time_{};
  bool had_pose_ = false;  // whether any frame had a map pose
  bool is_finished_ = false;
  SessionRecord record_;  // mission alone; points are in the session
  Timestamp record_spacing_ = std::chrono::milliseconds(500);
  mutable SerialQueue calls_;
};

}  // namespace byre
