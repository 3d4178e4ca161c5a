#include "byre/slam.h"

#include "byre/features/image_view.h"
#include "byre/geometry/baseline.h"
#include "byre/geometry/finite.h"
#include "byre/map/map_file.h"
#include "byre/map/map_values.h"
#include "byre/map/stored_calibration.h"
#include "byre/slam/system/engine.h"
#include "byre/slam/system/input_check.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/window/online_copy.h"

#include <cmath>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGivenCalibration = "the calibration given to Slam";

// Throws InputError for an invalid calibration. Those from files were checked on reading; others were not.
void require_valid(const Calibration& calibration, const SlamOptions& options) {
  const auto refuse = [](std::string_view reason) {
    throw InputError(kGivenCalibration, reason, "see byre/calibration.h");
  };
  if (const auto fault = fault_in(calibration); !fault.empty()) refuse(fault);
  if (calibration.right && calibration.depth) refuse("has both a right and a depth camera");
  if (calibration.depth) {
    const DepthCamera& depth = *calibration.depth;
    const bool is_sound = depth.units_per_metre > 0.0 && depth.sigma_at_one_metre > 0.0 && depth.baseline > 0.0 &&
                          (!depth.camera || fault_in(*depth.camera).empty());
    if (!is_sound) refuse("has an invalid depth camera");
  }
  if (options.max_features < 1) throw InputError("SlamOptions::max_features", "is less than one");
  if (options.image_threads < 1) throw InputError("SlamOptions::image_threads", "is less than one");
}

// Calibration with the baseline of the options. Throws InputError if invalid.
Calibration checked(const Calibration& calibration, const SlamOptions& options) {
  require_valid(calibration, options);
  return with_checked_baseline(calibration, options.baseline, kGivenCalibration, "SlamOptions::baseline = ");
}

Pace pace_of(Workers workers) {
  switch (workers) {
    case Workers::live:
      return Pace::live;
    case Workers::repeatable:
      return Pace::paced;
    case Workers::none:
      return Pace::same_thread;
  }
  return Pace::live;
}

void apply_settings(const SlamOptions& options, EngineOptions& engine) {
  for (const auto& [name, value] : options.settings) {
    if (const auto fault = set_option(engine, name, value)) {
      throw InputError("SlamOptions::settings", fault->reason, fault->remedy);
    }
  }
}

EngineOptions engine_options(const SlamOptions& options, const Vocabulary& vocabulary) {
  EngineOptions engine;
  engine.pace = pace_of(options.workers);
  engine.extract.max_features = options.max_features;
  engine.self_calibrate = options.refine_calibration;
  engine.extract.threads = options.image_threads;
  engine.session.map_online = options.map_online;
  engine.vocabulary = vocabulary;
  apply_settings(options, engine);
  return engine;
}

}  // namespace

struct Slam::Parts {
  Parts(const Calibration& given_calibration, const SlamOptions& slam_options, const Vocabulary& used_vocabulary,
        const EngineOptions& engine_options, StoredMap map_metadata, std::optional<Map> before = {})
      : given(given_calibration),
        options(slam_options),
        vocabulary(used_vocabulary),
        metadata(std::move(map_metadata)),
        offline(engine_options.offline),
        is_extended(before.has_value()),
        engine(given, engine_options, std::move(before)),
        input(given, engine.rig(), {options.max_pair_difference, options.max_gap}) {}
  ~Parts() { engine.finish_early(); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  // Images for the engine; empty if dropped, see input.
  const ImageFrame* take(const CameraImages& images);
  // Motion of the body since the last frame processed by the engine.
  std::optional<BodyMotion> take_motion(const std::optional<BodyMotion>& body_motion, Timestamp time, bool is_dropped);
  FrameReport completed(FrameReport report);
  // Whether the map is not empty; for an extended map, whether anything was added.
  bool has_mapped() const { return engine.online().keyframe_count() > 0 && (had_pose || !is_extended); }
  FrameReport dropped(Timestamp time) const;
  StoredMap stored_map() const;

  // Constant after construction.
  Calibration given;
  SlamOptions options;
  Vocabulary vocabulary;
  StoredMap metadata;  // saved data besides the map and the current recording
  std::shared_ptr<const OfflineMap> offline;
  bool is_extended = false;
  std::optional<fs::path> mission_map;   // map file of a mission
  std::optional<PlanRegistration> plan;  // registration of the map frame on its floor plan

  Engine engine;
  InputCheck input;
  ImageFrame buffer;                                       // holds the images during a call
  std::optional<BodyMotion> dropped_motion = no_motion();  // motion over dropped frames; empty: unknown
  State state = State::initialising;                       // state after the last frame
  std::optional<Timestamp> first_time;                     // time of the first frame not dropped
  Timestamp last_time{};
  bool had_pose = false;  // whether any frame had a map pose
  bool is_finished = false;
};

const ImageFrame* Slam::Parts::take(const CameraImages& images) {
  const InputFault fault = is_finished ? input.note(InputFault::after_finishing) : input.note(images);
  if (is_dropped(fault)) return nullptr;
  buffer.time = images.left.time;
  copy_grey(images.left, buffer.left);
  const bool has_right = input.may_use_right();
  if (!has_right) buffer.right.reset();
  if (has_right) copy_grey(*images.right, buffer.right ? *buffer.right : buffer.right.emplace());
  const bool has_depth = input.may_use_depth();
  if (!has_depth) buffer.depth.reset();
  if (has_depth) {
    copy_depth(*images.depth, given.depth->units_per_metre, buffer.depth ? *buffer.depth : buffer.depth.emplace());
  }
  return &buffer;
}

std::optional<BodyMotion> Slam::Parts::take_motion(const std::optional<BodyMotion>& body_motion, Timestamp time,
                                                   bool is_dropped) {
  const std::optional<BodyMotion> motion = engine.checked(body_motion, time);
  const bool is_metric = engine.is_metric();  // metric priors need a metric map
  const auto since = is_metric && dropped_motion && motion ? std::optional(*dropped_motion * *motion) : std::nullopt;
  dropped_motion = is_dropped ? since : no_motion();
  return since;
}

FrameReport Slam::Parts::completed(FrameReport report) {
  report.input = input.last();
  state = report.state;
  had_pose = had_pose || report.map_from_body;
  if (!first_time) first_time = report.time;
  last_time = report.time;
  return report;
}

FrameReport Slam::Parts::dropped(Timestamp time) const {
  FrameReport report;
  report.time = time;
  report.state = state;
  report.input = input.last();
  return report;
}

StoredMap Slam::Parts::stored_map() const {
  StoredMap stored = metadata;
  stored.map = engine.map_to_save();
  stored.scale = engine.is_metric() ? MapScale::metric : MapScale::unknown;
  stored.recordings.push_back(
      {options.recording, given, first_time.value_or(Timestamp{}), last_time, engine.calibration()});
  write_odometry_calibration(engine.prior().calibration_to_store(), stored.notes);
  if (const auto sigma = engine.wheel_scale_sigma()) stored.notes[kMetresNote] = metres_note(*sigma);
  return stored;
}

Slam::Slam(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;
Slam::~Slam() = default;

Slam Slam::mapping(const Calibration& calibration, const SlamOptions& options) {
  Calibration given = checked(calibration, options);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  if (!given.is_metric()) given.body_from_left = {};  // a lever arm in metres needs a metric map
  return Slam(std::make_unique<Parts>(given, options, vocabulary, engine_options(options, vocabulary), StoredMap{}));
}

Slam Slam::extending(const Calibration& calibration, const fs::path& map, const SlamOptions& options) {
  const Calibration given = checked(calibration, options);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  StoredMap metadata = load_for_mapping(map, vocabulary);
  metadata.pose_source = PoseSource::slam;
  Map before = online_copy(metadata.map);
  metadata.map = Map(Origin::offline);
  const auto plan = metadata.plan;
  EngineOptions engine = engine_options(options, vocabulary);
  engine.refined_calibration = stored_calibration(metadata.recordings, given);
  engine.extrinsics = odometry_calibration_for(read_odometry_calibration(metadata.notes), metadata.recordings, given);
  engine.session.recording = static_cast<int>(metadata.recordings.size());
  auto parts = std::make_unique<Parts>(given, options, vocabulary, engine, std::move(metadata), std::move(before));
  parts->plan = plan;
  return Slam(std::move(parts));
}

Slam Slam::on_map(const Calibration& calibration, const fs::path& map, const SlamOptions& options) {
  const Calibration given = checked(calibration, options);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  EngineOptions engine = engine_options(options, vocabulary);
  engine.offline = load_offline_map(map, vocabulary, options.plan);
  auto parts = std::make_unique<Parts>(given, options, vocabulary, engine, StoredMap{});
  parts->plan = load_plan_registration(map);
  parts->mission_map = map;
  return Slam(std::move(parts));
}

FrameReport Slam::process(const CameraImages& images, const std::optional<BodyMotion>& body_motion) {
  const ImageFrame* const taken = parts_->take(images);
  const auto motion = parts_->take_motion(body_motion, images.left.time, taken == nullptr);
  if (taken == nullptr) return parts_->dropped(images.left.time);
  return parts_->completed(parts_->engine.process(*taken, motion).report);
}

FrameReport Slam::process(const Frame& frame, const std::optional<BodyMotion>& body_motion) {
  const InputFault fault =
      parts_->is_finished ? parts_->input.note(InputFault::after_finishing) : parts_->input.note(frame);
  const auto motion = parts_->take_motion(body_motion, frame.time, is_dropped(fault));
  if (is_dropped(fault)) return parts_->dropped(frame.time);
  return parts_->completed(parts_->engine.process(frame, motion));
}

void Slam::add_wheel_odometry(const StampedPose& odometry_from_base) {
  parts_->engine.add_wheel_odometry(odometry_from_base);
}

void Slam::add_wheel_odometry(const BaseTwist& velocity) {
  parts_->engine.add_wheel_odometry(velocity);
}

void Slam::add_gyro(const AngularRate& rate) {
  parts_->engine.add_gyro(rate);
}

void Slam::add_accel(const Acceleration& acceleration) {
  parts_->engine.add_accel(acceleration);
}

void Slam::set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope) {
  parts_->engine.set_gyro_extrinsics(left_from_gyroscope);
}

void Slam::pause_mapping(bool is_paused) {
  parts_->engine.pause_mapping(is_paused);
}

bool Slam::is_mapping_paused() const {
  return parts_->engine.session().is_mapping_paused();
}

void Slam::set_initial_pose(const PoseHint& hint) {
  constexpr double kMaxOff = 0.1;  // tolerance of the quaternion's length 1
  const bool is_sound = is_finite(hint.map_from_body) && std::abs(hint.map_from_body.rotation.norm() - 1.0) < kMaxOff;
  if (is_sound) parts_->engine.set_initial_pose(hint);
}

std::optional<std::string> Slam::map_damage() const {
  const InputError* const damage = parts_->engine.map_damage();
  return damage != nullptr ? std::optional<std::string>(damage->what()) : std::nullopt;
}

void Slam::finish(const std::function<bool()>& should_stop) {
  if (std::exchange(parts_->is_finished, true)) return;
  const FinishHooks hooks{should_stop ? should_stop : [] { return false; }, {}};
  if (hooks.should_stop()) parts_->engine.finish_early();
  parts_->engine.finish();
  if (hooks.should_stop() || !parts_->has_mapped() || map_damage()) return;
  if (parts_->offline) {
    parts_->engine.finish_mission(hooks);
  } else {
    parts_->engine.finish_map(hooks);
  }
}

void Slam::save(const fs::path& path) const {
  if (!parts_->has_mapped()) {
    throw InputError(path.string(), "is not written, because the map is still empty",
                     "let the robot move, and check the frame reports");
  }
  std::error_code none_there;
  if (parts_->mission_map && fs::equivalent(path, *parts_->mission_map, none_there)) {
    throw InputError(path.string(), "is the offline map of the mission and must not be replaced", "name another file");
  }
  save_for_missions(parts_->stored_map(), parts_->vocabulary, parts_->options.site, path);
}

Trajectory Slam::trajectory() const {
  Trajectory trajectory = parts_->engine.trajectory();
  std::erase_if(trajectory, [](const StampedPose& pose) { return !is_finite(pose.world_from_body); });
  return trajectory;
}

std::optional<Pose> Slam::plan_from_body(const Pose& map_from_body) const {
  const auto& plan = parts_->plan;
  return plan && is_finite(map_from_body) ? std::optional(byre::plan_from_body(*plan, map_from_body)) : std::nullopt;
}

std::optional<Matrix6> Slam::plan_covariance(const Pose& map_from_body, const Matrix6& covariance) const {
  const auto& plan = parts_->plan;
  const bool is_sound = is_finite(map_from_body) && covariance.allFinite();
  return plan && is_sound ? std::optional(covariance_on_plan(*plan, map_from_body, covariance)) : std::nullopt;
}

const Rig& Slam::rig() const {
  return parts_->engine.rig();
}

Calibration Slam::calibration() const {
  const auto refined = parts_->engine.calibration();
  return refined ? refined->calibration : parts_->given;
}

bool Slam::is_metric() const {
  return parts_->engine.is_metric();
}

int Slam::keyframes() const {
  return parts_->engine.online().keyframe_count();
}

int Slam::points() const {
  return parts_->engine.online().point_count();
}

std::vector<Eigen::Vector3d> Slam::point_positions() const {
  const Map& map = parts_->engine.online();
  std::vector<Eigen::Vector3d> positions;
  for (const PointId id : map.point_ids()) positions.push_back(map.find_point(id)->position_in_world);
  return positions;
}

const std::vector<MotionWarning>& Slam::motion_warnings() const {
  return parts_->engine.warnings();
}

int Slam::frames() const {
  return parts_->input.frames();
}

int Slam::frames(InputFault fault) const {
  return parts_->input.frames(fault);
}

}  // namespace byre
