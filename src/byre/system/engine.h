#pragma once

#include "byre/features/extract.h"
#include "byre/features/stereo_fit.h"
#include "byre/motion/motion_prior.h"
#include "byre/session/session.h"
#include "byre/system/logged_executor.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Where mapping runs.
//   same_thread  on the frame thread ("inline")
//   paced        on workers, taken over kPacedLatency frames later, corrections of the whole map
//                kPacedCorrectionLatency and searches in an offline map kPacedSearchLatency: repeatable
//   live         on workers, taken over when ready; a recording is then played at its own time stamps
enum class Pace : std::uint8_t { same_thread, paced, live };

// As on the command line.
std::string_view name_of(Pace pace);
std::string_view name_of(OfflinePolicy policy);

inline constexpr int kPacedLatency = 4;             // frames
inline constexpr int kPacedCorrectionLatency = 40;  // frames
inline constexpr int kPacedSearchLatency = 6;       // frames

struct EngineOptions {
  Pace pace = Pace::paced;
  ExtractOptions extract;
  SessionOptions session;
  bool self_calibrate = true;  // refine the calibration given from what is mapped
  // What the cameras are known to be; only their readout time is refined. Empty: what the offline map knows, if any.
  std::optional<RefinedCalibration> known;
  SelfCalibrationOptions self_calibration;
  std::optional<Vocabulary> vocabulary;  // to recognise places with; without it no loop is closed, nor the map finished
  // How wheels and a gyroscope were mounted when the map was made that is gone on with; a mission asks its offline map.
  KnownMounting mounting;
  bool use_known_mounting = true;
  MotionLimits motion_limits;
  // Least standard deviation of metres that wheels alone measure for a map by one camera, as a share.
  double wheel_scale_sigma = 0.02;
  double frame_deadline_ms = 0.0;             // wall time that a frame may take, see FrameBudget
  std::shared_ptr<const OfflineMap> offline;  // a mission on this map; what is mapped beside it is not finished
};

// What was found out while a map was made, and is kept with it.
struct KeptWithMap {
  std::optional<RefinedCalibration> calibration;  // calibration that the map lies by, where it was refined
  KnownMounting mounting;                         // mounting of wheels and a gyroscope
  std::optional<double> metres_sigma{};           // see Engine::wheel_scale_sigma
};

// Wall time of a frame's stages, seconds. All but decode are spent one after the other on the frame thread.
struct StageSeconds {
  double decode = 0.0;  // decoding ahead, in a thread of its own; not in total
  double rectify = 0.0;
  double extract = 0.0;
  double stereo = 0.0;  // stereo matching, or reading depths
  double track = 0.0;
  double map = 0.0;         // windows, deltas, new points, and jobs where they run on this thread
  double map_submit = 0.0;  // part of map: handing jobs to the executor, so the whole job where it runs on this thread
  double total = 0.0;       // from the images in memory to the report
};

// What finishing a map changed, and how sound it is now.
struct Finishing {
  FinishReport report;
  bool cut_short = false;           // finishing stopped early, by who asked it to
  double seconds = 0.0;             // wall time
  std::vector<std::string> faults;  // faults of the map as it is kept
};

// A camera rig's front end and the session that its frames go to. Call it from one thread.
class Engine {
 public:
  struct Processed {
    FrameReport report;
    StageSeconds seconds;
  };

  // given: by which the cameras were said to see. before: the map that is gone on with, an online copy; it needs the
  // vocabulary's words, and options a vocabulary. Throws InputError when the calibration cannot be rectified.
  Engine(const Calibration& given, const EngineOptions& options, std::optional<Map> before = {});
  Engine(const Engine&) = delete;  // executors know where its log is, and the session its prior
  Engine& operator=(const Engine&) = delete;

  // What wheels and a gyroscope tell, each in order of time, before the frames that it leads to.
  void tell_wheels(const StampedPose& odometry_from_base) { prior_.add(odometry_from_base); }
  void tell_wheels(const BaseVelocity& velocity) { prior_.add(velocity); }
  void tell_gyroscope(const AngularRate& rate) { prior_.add(rate); }
  void tell_accelerometer(const Acceleration& acceleration) { prior_.add(acceleration); }
  void tell_gyroscope_mounting(const Eigen::Quaterniond& left_from_gyroscope) {
    prior_.presume_gyroscope(body_from_left_ * left_from_gyroscope);
  }

  // A motion of the body from the last frame to a time, given by the caller; empty if it is faulty.
  std::optional<BodyMotion> checked(const std::optional<BodyMotion>& motion, Timestamp time);
  // Faults of motion inputs so far.
  const std::vector<MotionWarning>& warnings() const { return prior_.warnings(); }

  // motion: of the body since the last frame; empty: what wheels and a gyroscope tell, if they do.
  Processed process(const ImageFrame& images, const std::optional<BodyMotion>& motion = {});
  FrameReport process(const Frame& frame, const std::optional<BodyMotion>& motion = {});

  void look_near(const PoseHint& hint) { session_.look_near(hint); }  // see Slam
  void pause_mapping(bool is_paused) { session_.pause_mapping(is_paused); }
  void hurry() { session_.hurry(); }  // see Session
  void finish() { session_.finish(); }
  // After finish(), where there is a vocabulary and no offline map; faults are not looked for.
  Finishing finish_map(const FinishHooks& hooks);
  double finish_mission(const FinishHooks& hooks);  // finishes a mission, after finish(); wall time, seconds
  // Damage of the offline map's file, with file, section and remedy; nullptr without damage. Parts read before stay in
  // use, and all later reports are untrusted.
  const InputError* map_damage() const { return offline_ ? offline_->map().damage() : nullptr; }

  const Rig& rig() const { return extractor_.rig(); }
  const Map& online() const { return session_.map().online(); }
  const Session& session() const { return session_; }
  const JobLog& log() const { return log_; }
  const MotionPrior& prior() const { return prior_; }
  // Every frame that had a pose, as the map has it now, and those that wheels lead to from them.
  Trajectory trajectory() const { return prior_.completed(session_.final_trajectory()); }
  // By which the map lies; empty where nothing but what was given is known.
  std::optional<RefinedCalibration> calibration() const;
  // Row error of the calibration that rectifies images, over all pairs so far.
  const CommonRowError& row_error() const { return row_error_; }
  KeptWithMap kept_with_map() const { return {calibration(), prior_.to_keep(), metres_sigma_}; }
  // Whether lengths are metres. What one camera maps has them once it is finished, where wheels have told them.
  bool is_metric() const { return is_metric_; }
  // Standard deviation of metres that wheels alone measure, as a share; empty if lengths are not metres, or are
  // measured by cameras or a map.
  std::optional<double> wheel_scale_sigma() const { return metres_sigma_; }
  // What is kept of the map by now.
  Map kept_map() const;
  // The same at last: the session has none after that, so that no map is there twice.
  Map take_kept_map();

 private:
  void refine_calibration(const Calibration& given, const EngineOptions& options, bool is_extended);
  void measure_by_wheels();
  // The frame's budget has begun.
  FrameReport process_in_time(const Frame& frame, const std::optional<BodyMotion>& motion);

  JobLog log_;
  std::shared_ptr<const OfflineMap> offline_;  // nullptr without a mission
  Eigen::Quaterniond body_from_left_;          // constant after construction
  std::optional<RefinedCalibration> known_;    // before any frame
  Extractor extractor_;
  CommonRowError row_error_;
  MotionPrior prior_;
  bool is_metric_;
  double least_scale_sigma_;            // constant after construction
  std::optional<double> metres_sigma_;  // see wheel_scale_sigma
  std::optional<Timestamp> last_frame_;
  std::size_t warnings_reported_ = 0;
  FrameBudget budget_;
  Session session_;
};

}  // namespace byre
