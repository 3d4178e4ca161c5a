#pragma once

#include "byre/features/extract.h"
#include "byre/features/stereo_quality.h"
#include "byre/odometry/odometry_calibrator.h"
#include "byre/slam/session/session.h"
#include "byre/slam/system/logged_executor.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Threads of mapping.
//   same_thread  on the frame thread ("inline")
//   paced        on workers; results are applied a fixed number of frames later (constants below): repeatable
//   live         on workers; results are applied when ready; recordings are played in real time
enum class Pace : std::uint8_t { same_thread, paced, live };

// Names of the command line.
std::string_view name_of(Pace pace);
std::string_view name_of(OfflinePolicy policy);

inline constexpr int kPacedLatency = 4;             // frames, for mapping jobs
inline constexpr int kPacedCorrectionLatency = 40;  // frames, for corrections of the whole map
inline constexpr int kPacedSearchLatency = 6;       // frames, for searches in an offline map

struct EngineOptions {
  Pace pace = Pace::paced;
  ExtractOptions extract;
  SessionOptions session;
  bool self_calibrate = true;  // refine the given calibration from the map
  // Refined calibration to keep; only its readout time is refined further. Empty: that of the offline map, if any.
  std::optional<RefinedCalibration> refined_calibration;
  SelfCalibrationOptions self_calibration;
  std::optional<Vocabulary> vocabulary;  // for place recognition; without it neither loop closing nor finish_map()
  // Mounting of wheels and gyroscope, from the map that is extended; a mission takes that of its offline map.
  OdometryCalibration extrinsics;
  bool use_saved_extrinsics = true;
  MotionLimits motion_limits;
  // Lower bound of the relative standard deviation of a monocular map's scale, if measured by wheels only.
  double wheel_scale_sigma = 0.02;
  double frame_deadline_ms = 0.0;             // wall time limit per frame, see FrameBudget
  std::shared_ptr<const OfflineMap> offline;  // offline map of a mission; null otherwise
};

// Estimates saved with a map.
struct SavedEstimates {
  std::optional<RefinedCalibration> calibration;  // calibration of the map; empty unless refined
  OdometryCalibration extrinsics;                 // extrinsics of wheels and gyroscope
  std::optional<double> scale_sigma{};            // see Engine::wheel_scale_sigma
};

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

// Front end of a camera rig with its session. Call it from one thread.
class Engine {
 public:
  struct Processed {
    FrameReport report;
    StageSeconds seconds;
  };

  // given: calibration of the cameras. before: map to extend, an online copy with words of the vocabulary, which
  // options must contain. Throws InputError if the calibration cannot be rectified.
  Engine(const Calibration& given, const EngineOptions& options, std::optional<Map> before = {});
  Engine(const Engine&) = delete;  // executors refer to log_, the session to prior_
  Engine& operator=(const Engine&) = delete;

  // Samples of wheels and gyroscope, each in order of time, before the frame that they lead to.
  void add_wheel_odometry(const StampedPose& odometry_from_base) { prior_.add(odometry_from_base); }
  void add_wheel_odometry(const BaseTwist& velocity) { prior_.add(velocity); }
  void add_gyro(const AngularRate& rate) { prior_.add(rate); }
  void add_accel(const Acceleration& acceleration) { prior_.add(acceleration); }
  void set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope) {
    prior_.set_gyroscope_extrinsics(body_from_left_ * left_from_gyroscope);
  }

  // Checks a motion of the body from the last frame to a time; empty if faulty.
  std::optional<BodyMotion> checked(const std::optional<BodyMotion>& motion, Timestamp time);
  // Faults of motion inputs so far.
  const std::vector<MotionWarning>& warnings() const { return prior_.warnings(); }

  // motion: of the body since the last frame; empty: wheel and gyroscope samples are used, if any.
  Processed process(const ImageFrame& images, const std::optional<BodyMotion>& motion = {});
  FrameReport process(const Frame& frame, const std::optional<BodyMotion>& motion = {});

  void set_initial_pose(const PoseHint& hint) { session_.set_initial_pose(hint); }  // see Slam
  void pause_mapping(bool is_paused) { session_.pause_mapping(is_paused); }
  void finish_early() { session_.finish_early(); }  // see Session
  void finish() { session_.finish(); }
  // Call after finish(). Needs a vocabulary, and no offline map. Does not fill in FinishResult::faults.
  FinishResult finish_map(const FinishHooks& hooks);
  // Finishes the online map of a mission, after finish(). Returns the wall time in seconds.
  double finish_mission(const FinishHooks& hooks);
  // Damage of the offline map's file, with section and remedy; nullptr if undamaged. Parts already read stay in use;
  // all later reports are untrusted.
  const InputError* map_damage() const { return offline_ ? offline_->map().damage() : nullptr; }

  const Rig& rig() const { return extractor_.rig(); }
  const Map& online() const { return session_.map().online(); }
  const Session& session() const { return session_; }
  const JobLog& log() const { return log_; }
  const OdometryCalibrator& prior() const { return prior_; }
  // Current poses of all tracked frames, with gaps filled by wheel odometry.
  Trajectory trajectory() const { return prior_.fill_gaps(session_.final_trajectory()); }
  // Calibration of the map; empty if only the given one is available.
  std::optional<RefinedCalibration> calibration() const;
  // Row error of the rectification in use, over all stereo pairs so far.
  const CommonRowError& row_error() const { return row_error_; }
  SavedEstimates saved_estimates() const { return {calibration(), prior_.calibration_to_store(), scale_sigma_}; }
  // Whether lengths are metres. Monocular maps become metric in finish_map() if wheels determine the scale.
  bool is_metric() const { return is_metric_; }
  // Relative standard deviation of the scale if measured by wheels only; empty if the scale is unknown, or measured by
  // cameras or a map.
  std::optional<double> wheel_scale_sigma() const { return scale_sigma_; }
  // Copy of the map to save.
  Map map_to_save() const;
  // Same map as map_to_save(), without copying; the session's map is empty afterwards.
  Map take_map_to_save();

 private:
  void refine_calibration(const Calibration& given, const EngineOptions& options, bool is_extended);
  void scale_by_wheels();
  // Precondition: the frame's budget has begun.
  FrameReport process_in_time(const Frame& frame, const std::optional<BodyMotion>& motion);

  JobLog log_;
  std::shared_ptr<const OfflineMap> offline_;              // nullptr without a mission
  Eigen::Quaterniond body_from_left_;                      // constant after construction
  std::optional<RefinedCalibration> initial_calibration_;  // before any frame
  Extractor extractor_;
  CommonRowError row_error_;
  OdometryCalibrator prior_;
  bool is_metric_;
  double min_scale_sigma_;             // constant after construction
  std::optional<double> scale_sigma_;  // see wheel_scale_sigma
  std::optional<Timestamp> last_frame_;
  std::size_t warnings_reported_ = 0;
  FrameBudget budget_;
  Session session_;
};

}  // namespace byre
