#include "byre/slam.h"

#include "byre/features/image_view.h"
#include "byre/geometry/baseline.h"
#include "byre/geometry/finite.h"
#include "byre/map/map_file.h"
#include "byre/map/map_values.h"
#include "byre/map/point_grey.h"
#include "byre/site.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/slam_impl.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/window/online_copy.h"

#include <cmath>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr const char* kGivenCalibration = "the calibration given to Slam";

bool is_sound(const std::optional<SensorMounting>& mounting) {
  return !mounting || (is_finite(mounting->base_from_sensor) && mounting->sigma_m > 0.0 && mounting->sigma_rad > 0.0);
}

void require_valid(const Extrinsics& extrinsics) {
  const auto refuse = [](std::string_view reason, std::string_view remedy) {
    throw InputError("SlamOptions::extrinsics", reason, remedy);
  };
  if (!extrinsics.camera) refuse("has no camera", "give the pose of the camera on the base");
  if (!is_sound(extrinsics.camera) || !is_sound(extrinsics.imu)) {
    refuse("has a pose that is not finite, or a sigma that is not positive", "see byre/extrinsics.h");
  }
  const bool is_wheel_sound = extrinsics.wheel_scale > 0.0 && std::isfinite(extrinsics.wheel_scale) &&
                              extrinsics.wheel_scale_sigma > 0.0 && std::isfinite(extrinsics.wheel_delay.value_or(0.0));
  if (!is_wheel_sound) refuse("has a scale, sigma or delay of wheels that is not positive or finite", "");
}

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
  if (options.max_waiting < 1) throw InputError("SlamOptions::max_waiting", "is less than one");
  if (options.extrinsics) require_valid(*options.extrinsics);
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

MethodOptions method_options(const SlamOptions& options) {
  MethodOptions method;
  method.pace = pace_of(options.workers);
  method.extract.max_features = options.max_features;
  method.self_calibrate = options.refine_calibration;
  method.extract.threads = options.image_threads;
  method.keep_pictures = options.pictures;
  method.session.map_online = options.map_online;
  for (const auto& [name, value] : options.settings) {
    if (const auto fault = set_option(method, name, value)) {
      throw InputError("SlamOptions::settings", fault->reason, fault->remedy);
    }
  }
  return method;
}

std::unique_ptr<SlamImpl> make(const Calibration& given, const SlamOptions& options, SlamInputs inputs) {
  inputs.recording = options.recording;
  inputs.extrinsics = options.extrinsics;
  inputs.site = options.site;
  inputs.max_waiting = options.max_waiting;
  inputs.tags = options.tags;
  return std::make_unique<SlamImpl>(given, method_options(options), std::move(inputs),
                                    InputCheckOptions{options.max_pair_difference, options.max_gap});
}

void load_site(const Site& site, const SlamOptions& options, SlamInputs& inputs) {
  if (options.plan)
    throw InputError("SlamOptions::plan", "is of one map, not of a site", "name plans in the site file");
  if (site.maps.empty()) throw InputError("site " + site.name, "has no map", "see byre/site.h");
  for (const SiteMap& map : site.maps) {
    inputs.maps.push_back({map.name, load_offline_map(map.map, *inputs.vocabulary, map.drawn_plan), map.map,
                           map_id(map.map), load_plan_registration(map.map), map.plan});
  }
  for (const SiteLink& link : site.links) {
    if (link.polygon.empty() || inputs.maps[link.from].plan) continue;
    throw InputError(inputs.maps[link.from].file.string(), "is not registered on a floor plan, but has a link on it",
                     "register it with byre register, or give centre as [x, y, z] in the map");
  }
  inputs.links = site.links;
}

}  // namespace

Slam::Slam(std::unique_ptr<SlamImpl> impl) : impl_(std::move(impl)) {}
Slam::Slam(Slam&&) noexcept = default;
Slam& Slam::operator=(Slam&&) noexcept = default;
Slam::~Slam() = default;

Slam Slam::mapping(const Calibration& calibration, const SlamOptions& options) {
  Calibration given = checked(calibration, options);
  SlamInputs inputs;
  inputs.vocabulary = open_vocabulary(options.vocabulary);
  if (!given.is_metric()) given.body_from_left = {};  // a lever arm in metres needs a metric map
  return Slam(make(given, options, std::move(inputs)));
}

Slam Slam::extending(const Calibration& calibration, const fs::path& map, const SlamOptions& options) {
  const Calibration given = checked(calibration, options);
  if (!method_options(options).close_loops) {
    throw InputError("loops.close", "is false, but a map is extended by place recognition", "set it to true");
  }
  SlamInputs inputs;
  inputs.vocabulary = open_vocabulary(options.vocabulary);
  inputs.extended = load_for_mapping(map, *inputs.vocabulary);
  inputs.extended.pose_source = PoseSource::slam;
  inputs.before = online_copy(inputs.extended.map);
  inputs.extended.map = MapGraph(Origin::offline);
  inputs.plan = inputs.extended.plan;
  return Slam(make(given, options, std::move(inputs)));
}

Slam Slam::on_map(const Calibration& calibration, const fs::path& map, const SlamOptions& options) {
  if (is_site_file(map)) throw InputError(map.string(), "is a site, not a map", "give read_site() to Slam::on_site");
  SlamOptions of_map = options;
  SiteMap only{.name = "", .map = map, .drawn_plan = std::exchange(of_map.plan, {})};
  return on_site(calibration, {.name = "", .maps = {std::move(only)}, .links = {}}, of_map);
}

Slam Slam::on_site(const Calibration& calibration, const Site& site, const SlamOptions& options) {
  const Calibration given = checked(calibration, options);
  SlamInputs inputs;
  inputs.vocabulary = open_vocabulary(options.vocabulary);
  load_site(site, options, inputs);
  inputs.offline = inputs.maps.front().offline;
  inputs.plan = inputs.maps.front().plan;
  return Slam(make(given, options, std::move(inputs)));
}

FrameReport Slam::process(const CameraImages& images, const std::optional<BodyMotion>& body_motion) {
  impl_->calls().rethrow_failure();
  return impl_->calls().run([&] { return impl_->process(images, body_motion); });
}

FrameReport Slam::process(const Frame& frame, const std::optional<BodyMotion>& body_motion) {
  impl_->calls().rethrow_failure();
  return impl_->calls().run([&] { return impl_->process(frame, body_motion); });
}

void Slam::submit(ImageFrame images, ReportCallback on_report, const std::optional<BodyMotion>& body_motion) {
  const auto owned = std::make_shared<const ImageFrame>(std::move(images));
  impl_->submit(
      owned->time, [impl = impl_.get(), owned, body_motion] { return impl->process(*owned, body_motion); },
      std::move(on_report), body_motion);
}

void Slam::submit(const CameraImages& images, ReportCallback on_report, const std::optional<BodyMotion>& body_motion) {
  const auto copy = std::make_shared<const CopiedImages>(images);
  impl_->submit(
      images.left.time, [impl = impl_.get(), copy, body_motion] { return impl->process(copy->views(), body_motion); },
      std::move(on_report), body_motion);
}

void Slam::add_wheel_odometry(const StampedPose& odometry_from_base) {
  impl_->calls().add([impl = impl_.get(), odometry_from_base] { impl->add_wheel_odometry(odometry_from_base); });
}

void Slam::add_wheel_odometry(const BaseTwist& velocity) {
  impl_->calls().add([impl = impl_.get(), velocity] { impl->add_wheel_odometry(velocity); });
}

void Slam::add_gyro(const AngularRate& rate) {
  impl_->calls().add([impl = impl_.get(), rate] { impl->add_gyro(rate); });
}

void Slam::add_accel(const Acceleration& acceleration) {
  impl_->calls().add([impl = impl_.get(), acceleration] { impl->add_accel(acceleration); });
}

void Slam::set_gyro_extrinsics(const Eigen::Quaterniond& left_from_gyroscope) {
  impl_->calls().add([impl = impl_.get(), left_from_gyroscope] { impl->set_gyro_extrinsics(left_from_gyroscope); });
}

void Slam::pause_mapping(bool is_paused) {
  impl_->calls().add([impl = impl_.get(), is_paused] { impl->pause_mapping(is_paused); });
}

bool Slam::is_mapping_paused() const {
  return impl_->calls().run([&] { return impl_->session().is_mapping_paused(); });
}

void Slam::set_initial_pose(const PoseHint& hint) {
  constexpr double kMaxOff = 0.1;  // tolerance of the quaternion's length 1
  const bool is_sound = is_finite(hint.map_from_body) && std::abs(hint.map_from_body.rotation.norm() - 1.0) < kMaxOff;
  if (is_sound) impl_->calls().add([impl = impl_.get(), hint] { impl->set_initial_pose(hint); });
}

std::optional<std::string> Slam::map_damage() const {
  return impl_->calls().run([&] {
    const InputError* const damage = impl_->map_damage();
    return damage != nullptr ? std::optional<std::string>(damage->what()) : std::nullopt;
  });
}

void Slam::finish(const std::function<bool()>& should_stop) {
  impl_->calls().run([&] {
    impl_->calls().rethrow_failure();
    impl_->finish({should_stop ? should_stop : [] { return false; }, {}});
  });
}

namespace {

// What a session stores, taken in the order of calls. Throws InputError if it is empty or may not replace the file.
template <typename Take>
auto take_for(const fs::path& path, SlamImpl& slam, Take take) {
  auto stored = slam.calls().run([&] { return slam.has_mapped() ? std::optional(take()) : std::nullopt; });
  if (!stored) {
    throw InputError(path.string(), "is not written, because the map is still empty",
                     "let the robot move, and check the frame reports");
  }
  for (const MissionMap& map : slam.inputs().maps) {
    std::error_code none_there;
    if (!fs::equivalent(path, map.file, none_there)) continue;
    throw InputError(path.string(), "is the offline map of the mission and must not be replaced", "name another file");
  }
  return *std::move(stored);
}

}  // namespace

void Slam::save_session(const fs::path& path) const {
  const SlamInputs& inputs = impl_->inputs();
  if (!inputs.offline) {
    throw InputError(path.string(), "is not written, because a session needs a map that the mission runs on",
                     "make the mission with Slam::on_map, or save a map");
  }
  auto [stored, record] = take_for(path, *impl_, [this] { return impl_->session_to_store(); });
  save_session_for_updates(std::move(stored), std::move(record), *inputs.vocabulary, path);
}

void Slam::save(const fs::path& path) const {
  save_for_missions(take_for(path, *impl_, [this] { return impl_->stored_map(); }), *impl_->inputs().vocabulary,
                    impl_->inputs().site, path);
}

Trajectory Slam::trajectory() const {
  Trajectory trajectory = impl_->calls().run([&] { return impl_->trajectory(); });
  std::erase_if(trajectory, [](const StampedPose& pose) { return !is_finite(pose.world_from_body); });
  return trajectory;
}

std::optional<Pose> Slam::plan_from_body(const Pose& map_from_body) const {
  const auto plan = impl_->plan();
  return plan && is_finite(map_from_body) ? std::optional(byre::plan_from_body(*plan, map_from_body)) : std::nullopt;
}

std::optional<Matrix6> Slam::plan_covariance(const Pose& map_from_body, const Matrix6& covariance) const {
  const auto plan = impl_->plan();
  const bool is_sound = is_finite(map_from_body) && covariance.allFinite();
  return plan && is_sound ? std::optional(covariance_on_plan(*plan, map_from_body, covariance)) : std::nullopt;
}

const Rig& Slam::rig() const {
  return impl_->rig();
}

Calibration Slam::calibration() const {
  return impl_->calls().run([&] {
    const auto refined = impl_->calibration();
    return refined ? refined->calibration : impl_->given();
  });
}

bool Slam::is_metric() const {
  return impl_->calls().run([&] { return impl_->is_metric(); });
}

int Slam::keyframes() const {
  return impl_->calls().run([&] { return impl_->online().keyframe_count(); });
}

int Slam::points() const {
  return impl_->calls().run([&] { return impl_->online().point_count(); });
}

std::vector<Eigen::Vector3d> Slam::point_positions() const {
  return impl_->calls().run([&] {
    const MapGraph& map = impl_->online();
    std::vector<Eigen::Vector3d> positions;
    for (const PointId id : map.point_ids()) positions.push_back(map.find_point(id)->position_in_world);
    return positions;
  });
}

std::vector<std::optional<std::uint8_t>> Slam::point_greys() const {
  return impl_->calls().run([&] {
    const MapGraph& map = impl_->online();
    std::vector<std::optional<std::uint8_t>> greys;
    for (const PointId id : map.point_ids()) greys.push_back(grey_of(map, *map.find_point(id)));
    return greys;
  });
}

std::vector<MotionWarning> Slam::motion_warnings() const {
  return impl_->calls().run([&] { return impl_->warnings(); });
}

int Slam::frames() const {
  return impl_->calls().run([&] { return impl_->input().frames(); });
}

int Slam::frames(InputFault fault) const {
  return impl_->calls().run([&] { return impl_->input().frames(fault); });
}

}  // namespace byre
