#include "byre/ros2/node/slam_runner.h"

#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/extrinsics_file.h"
#include "byre/floor_plan.h"
#include "byre/geometry/baseline.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/file_safety.h"
#include "byre/io/recording/settings_file.h"
#include "byre/io/recording/static_frames.h"
#include "byre/map.h"
#include "byre/map/map_file.h"
#include "byre/playback/options_file.h"
#include "byre/ros2/node/mission_sessions.h"
#include "byre/site.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/upkeep/update_map.h"
#include "byre/tag_file.h"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// A node runs for weeks: a quarter of an hour at 20 Hz in full, older poses subsampled.
constexpr const char* kMaxPoses = "20000";

SlamOptions slam_options(const NodeConfig& config) {
  SlamOptions options;
  options.settings.emplace_back("trajectory.max_poses", kMaxPoses);
  options.workers = config.workers;
  options.vocabulary = config.vocabulary;
  options.baseline = config.baseline;
  if (config.tags) options.tags = read_tags(*config.tags);
  if (config.extrinsics_file) {
    options.extrinsics = read_extrinsics(*config.extrinsics_file, config.extrinsics_frames);
    if (!options.extrinsics->camera) {
      throw InputError(config.extrinsics_file->string(), "has no pose of the camera", "add base_from_camera");
    }
  }
  options.max_pair_difference = std::max(options.max_pair_difference, config.pair_tolerance);
  if (!config.options) return options;
  MethodOptions checked;
  read_options(*config.options, checked);  // its messages name the line
  for (const Setting& setting : read_settings(*config.options)) {
    if (setting.name != "pace") options.settings.emplace_back(setting.name, setting.text);  // replaced by workers
  }
  return options;
}

// Whether the map is registered on the plan; another map need not be.
bool lies_on(const fs::path& map, const fs::path& plan) {
  const auto registration = load_plan_registration(map);
  return registration && registration->plan == plan.filename().string();
}

// File in the folder of the loaded map. Other folders are rejected, as senders of commands may not read arbitrary
// files.
fs::path sibling_path(const fs::path& map, const std::string& name) {
  if (name.empty() || name.starts_with('.') || name.find('/') != std::string::npos) {
    throw InputError("load", "'" + name.substr(0, 100) + "' is not a file name",
                     "give a file in the folder of the current map, without the folder");
  }
  return map.parent_path() / name;
}

// Throws InputError if slam.save may not be written, or if it or its previous version is an input of the node, other
// than the map to extend.
void require_safe_save(const NodeConfig& config) {
  if (!config.save) return;
  NamedFiles files;
  const auto add = [&files](InputKind kind, const char* name, const std::optional<fs::path>& file) {
    if (file) files.inputs.push_back({kind, name, *file});
  };
  add(InputKind::file, "the settings", config.file);
  if (config.task != NodeTask::extend) add(InputKind::file, "slam.map", config.map);
  add(InputKind::file, "slam.options", config.options);
  add(InputKind::file, "slam.vocabulary", config.vocabulary);
  add(InputKind::plan, "slam.plan", config.plan);
  add(InputKind::file, "slam.tags", config.tags);
  add(InputKind::file, "extrinsics.file", config.extrinsics_file);
  add(InputKind::file, "calibration.file", config.calibration);
  add(InputKind::file, "mqtt.password_file", config.fleet.password_file);
  for (const fs::path& written : {*config.save, previous_map(*config.save)}) {
    files.outputs.push_back({OutputKind::map, "slam.save", written});
  }
  try {
    require_not_read(files);
  } catch (const FileConflict& conflict) {
    throw InputError(conflict.argument(), conflict.what());
  }
  require_writable(*config.save, FileContent::map);
}

}  // namespace

fs::path previous_map(const fs::path& map) {
  return beside(map, "previous", map.extension());
}

void keep_as_previous(const fs::path& map) {
  if (content_of(map) != FileContent::map) return;
  const auto version = [&](int age) {
    return age == 0 ? map : beside(map, age == 1 ? "previous" : fmt::format("previous_{}", age), map.extension());
  };
  std::error_code error;
  if (fs::equivalent(map, version(1), error)) return;
  constexpr int kKept = 3;
  for (int age = kKept; age > 0; --age) {
    if (content_of(version(age - 1)) == FileContent::map) link_or_copy(version(age - 1), version(age));
  }
}

SlamRunner::SlamRunner(const NodeConfig& config) : config_(config), options_(slam_options(config)), map_(config.map) {
  require_safe_save(config);
  if (config.update != MapUpdates::off && config.map && !is_site_file(*config.map))
    require_writable(proposed_map(*config.map), FileContent::map);
  const RegistrySettings& registry = config.registry;
  if (registry.site.empty() || !config.map) return;
  if (is_site_file(*config.map)) {
    throw InputError("registry.site", "is of one map, but slam.map is a site", "name a map, or leave this empty");
  }
  registry_.emplace(RobotLinkOptions{registry.database, registry.site, *config.map, beside(*config.map, "registry", ""),
                                     registry.interval, static_cast<std::uintmax_t>(1e6 * registry.max_megabytes)});
}

std::optional<RobotLinkState> SlamRunner::registry() const {
  return registry_ ? std::optional(registry_->state()) : std::nullopt;
}

FrameReport SlamRunner::process(const CameraImages& images) {
  FrameReport report = slam_->process(images);
  had_pose_ = had_pose_ || report.map_from_body;
  if (!config_.in_plan || !report.map_from_body) return report;
  const auto covariance = slam_->plan_covariance(*report.map_from_body, report.covariance);
  report.covariance = covariance.value_or(report.covariance);
  report.map_from_body = published(*report.map_from_body);
  return report;
}

void SlamRunner::replace(Slam slam) {
  slam.pause_mapping(slam_ && slam_->is_mapping_paused());
  slam_.emplace(std::move(slam));
  session_.reset();
  had_pose_ = false;
  has_saved_ = false;
}

SlamOptions SlamRunner::options_for(const fs::path& map) const {
  SlamOptions options = options_;
  if (config_.plan && lies_on(map, *config_.plan)) options.plan = read_drawn_floor_plan(*config_.plan);
  return options;
}

Slam SlamRunner::make(const fs::path* map) const {
  switch (config_.task) {
    case NodeTask::mission:
      if (is_site_file(*map)) return Slam::on_site(*calibration_, read_site_with_plans(*map), options_);
      return Slam::on_map(*calibration_, *map, options_for(*map));
    case NodeTask::extend:
      return Slam::extending(*calibration_, *map, options_);
    case NodeTask::map:
      break;
  }
  return Slam::mapping(*calibration_, options_);
}

std::string SlamRunner::take_extrinsics(const Pose& base_from_left, const std::optional<std::string>& base_of_wheels) {
  constexpr double kVertical = 0.7;  // cosine of 45 degrees, between the optical axis and z of the base
  const bool has_transform = config_.extrinsics_source() == ExtrinsicsSource::tf && !config_.wheels.empty();
  const std::string base = frame_without_slash(config_.base_frame);
  const std::string transform = base + " -> left camera on " + config_.topic(config_.tf_static);
  const std::string wheels = config_.topic(config_.wheels);
  if (config_.extrinsics_file) {
    const std::string other = has_transform ? "; not the transform " + transform : "";
    return "the extrinsics start with those of " + config_.extrinsics_file->string() + other;
  }
  if (!has_transform) return "";
  const std::string unused = ", so the extrinsics of the wheels do not start with the transform " + transform;
  if (!base_of_wheels) return "no message on " + wheels + " before the first frame" + unused;
  if (*base_of_wheels != base) {
    return wheels + " measures the motion of '" + printable(*base_of_wheels, 100) + "', not of " + base + unused;
  }
  if (std::abs((base_from_left.rotation * Eigen::Vector3d::UnitZ()).z()) > kVertical) {
    return "the left camera looks up or down" + unused + "; give extrinsics.file to confirm it";
  }
  options_.extrinsics.emplace().camera.emplace().base_from_sensor = base_from_left;
  return "the extrinsics of the wheels on " + wheels + " start with the transform " + transform;
}

std::string SlamRunner::start(const Calibration& calibration) {
  calibration_ =
      with_checked_baseline(calibration, config_.baseline,
                            config_.calibration ? config_.calibration->string() : "the calibration", kBaselineSetting);
  std::string note;
  try {
    replace(make(map_ ? &*map_ : nullptr));
  } catch (const InputError& error) {
    const bool is_kept = map_ && fs::exists(previous_map(*map_));
    if (!is_kept) throw;
    const fs::path previous = previous_map(*map_);
    replace(make(&previous));
    map_ = previous;
    is_map_intact_ = false;
    note = std::string(error.what()) + "; the previous map is used, " + previous.string();
  }
  if (registry_) registry_->start();
  if (slam_->is_metric()) return note;
  slam_.reset();
  throw InputError("the calibration", "is of one camera, which has no metric scale without a map",
                   "set slam.map, or images.depth");
}

Pose SlamRunner::published(const Pose& map_from_body) const {
  const auto on_plan = config_.in_plan ? slam_->plan_from_body(map_from_body) : std::nullopt;
  return on_plan.value_or(map_from_body);
}

const MissionMap* SlamRunner::active_map() const {
  if (!slam_ || makes_map()) return nullptr;
  const SlamImpl& impl = slam_->impl();
  return &impl.inputs().maps[impl.active_map()];
}

std::string SlamRunner::map_name() const {
  if (const MissionMap* const active = active_map(); active != nullptr && !active->name.empty()) return active->name;
  const std::optional<fs::path>& file = map_ ? map_ : config_.save;
  return file ? file->stem().string() : "";
}

std::vector<CloudPoint> SlamRunner::points() const {
  if (!makes_map()) return points_of(active_map()->file, config_.in_plan);
  const Pose published_from_map = published(Pose{});
  const auto positions = slam_->point_positions();
  const auto greys = slam_->point_greys();
  assert(greys.size() == positions.size());  // only calls of this runner change the map
  std::vector<CloudPoint> points;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    points.push_back(cloud_point(published_from_map * positions[i], greys[i]));
  }
  return points;
}

std::optional<ros::OccupancyGrid> SlamRunner::occupancy() const {
  const MissionMap* const active = active_map();
  if (active != nullptr && active->plan_file && config_.in_plan) return grid_of(read_floor_plan(*active->plan_file));
  if (!map_ || !config_.has_grid_of_map) return std::nullopt;
  GridOptions options;
  options.resolution = config_.grid_resolution;
  options.footprint_radius = config_.grid_footprint;
  options.body_height = config_.body_height;
  try {
    return grid_of(load_map(active != nullptr ? active->file : *map_), config_.in_plan, options);
  } catch (const InputError& error) {
    throw InputError("no occupancy grid of " + map_->string(), error.reason(),
                     error.remedy() + "; the settings are grid.body_height, grid.resolution and grid.from_map");
  }
}

void SlamRunner::require_running() const {
  if (!slam_) throw InputError("byre node", "has no calibration yet", "wait for camera info");
}

std::string SlamRunner::save() {
  require_running();
  if (!config_.save) throw InputError("save", "has no output file", "set slam.save");
  require_safe_save(config_);
  if (slam_->keyframes() > 0 && is_map_intact_ && !has_saved_) keep_as_previous(*config_.save);
  slam_->save(*config_.save);
  is_map_intact_ = true;
  has_saved_ = true;
  return "saved " + config_.save->string();
}

CommandResult SlamRunner::update() {
  require_running();
  if (config_.update == MapUpdates::off) {
    throw InputError("update", "is switched off", "set slam.update to propose or automatic");
  }
  if (is_site_file(*map_)) {
    throw InputError("update", "is of one map, but slam.map is a site", "run each map alone, or use byre update");
  }
  if (!is_map_intact_) {
    throw InputError("update", "is impossible, as the previous map is used", "restore the damaged map first");
  }
  if (registry_) return update_from_registry();
  if (!session_) session_ = session_file(*map_, std::chrono::system_clock::now());
  slam_->save_session(*session_);
  const std::vector<fs::path> sessions = waiting_sessions(*map_);
  const fs::path child = proposed_map(*map_);
  const MapUpdateResult result = update_map_file(*map_, sessions, child, config_.vocabulary);
  const std::string changes = fmt::format("{} keyframes and {} points added, {} points retired", result.keyframes_added,
                                          result.points_added, result.points_retired);
  if (!result.refusal.empty() || config_.update == MapUpdates::propose) {
    last_update_ = result.refusal.empty() ? "proposed " + child.string() + ": " + changes
                                          : map_->string() + " stays as it is: " + result.refusal;
    return {last_update_};
  }
  keep_as_previous(*map_);
  std::error_code error;
  fs::rename(child, *map_, error);
  if (error) throw InputError(map_->string(), "cannot be replaced: " + error.message(), "check its folder");
  for (const fs::path& session : sessions) fs::remove(session, error);
  replace(make(&*map_));
  last_update_ = "updated " + map_->string() + ": " + changes;
  return {last_update_, true, true};
}

// A session that is queued ends: later ones have other keyframes.
CommandResult SlamRunner::update_from_registry() {
  if (map_ != config_.map) {
    throw InputError("update", "is of " + config_.map->string() + ", but another map is used",
                     "load " + config_.map->filename().string() + " first");
  }
  std::string queued = "no session to send";
  const bool has_session = can_update();
  if (has_session) {
    const fs::path name = session_file(*map_, std::chrono::system_clock::now()).stem();
    slam_->save_session(registry_->last_session());
    queued = registry_->queue_last_session(name.string())
                 ? "the session " + name.string() + " waits for the registry"
                 : "the session is not sent, as " + std::to_string(registry_->state().waiting) +
                       " others exceed registry.max_megabytes";
  }
  const std::string present = registry_->state().present;
  last_update_ = use_fetched() + "; " + queued;
  const bool is_replaced = registry_->state().present != present;
  if (is_replaced || has_session) replace(make(&*map_));
  return {last_update_, is_replaced || has_session, is_replaced};
}

std::string SlamRunner::use_fetched() {
  const std::optional<fs::path> fetched = registry_->fetched();
  if (!fetched) return map_->string() + " stays as it is: no other version is accepted";
  const std::string version = "version " + fetched->stem().string();
  const auto refuse = [&](const std::string& reason) {
    registry_->refuse(*fetched, reason);
    return map_->string() + " stays as it is: " + version + " is refused: " + reason;
  };
  std::error_code error;
  if (!fs::exists(registry_->last_session(), error)) return refuse("no session proves it yet");
  try {
    const Vocabulary vocabulary = open_vocabulary(config_.vocabulary);
    const std::string fault = fault_of_replacement(load_version(*map_, vocabulary), load_version(*fetched, vocabulary),
                                                   load_session(registry_->last_session(), vocabulary), vocabulary);
    if (!fault.empty()) return refuse(fault);
    if (config_.update == MapUpdates::propose) {
      link_or_copy(*fetched, proposed_map(*map_));
      return "proposed " + proposed_map(*map_).string() + ": " + version;
    }
    keep_as_previous(*map_);
    link_or_copy(*fetched, *map_);
  } catch (const InputError& unusable) {
    return refuse(unusable.what());
  }
  registry_->note_present();
  return "updated " + map_->string() + " to " + version;
}

std::string SlamRunner::load(const std::string& name) {
  require_running();
  if (config_.task != NodeTask::mission) {
    throw InputError("load", "would discard the map being made", "set slam.task to mission");
  }
  const fs::path map = sibling_path(*map_, name);
  replace(make(&map));
  map_ = map;
  return "loaded " + map.string();
}

std::string SlamRunner::relocalise() {
  require_running();
  if (config_.task != NodeTask::mission) {
    throw InputError("relocalise", "would discard the map being made", "set slam.task to mission");
  }
  replace(make(&*map_));
  return "relocalising in " + map_->string();
}

bool SlamRunner::set_initial_pose(PoseHint hint) {
  require_running();
  if (config_.task != NodeTask::mission) return false;
  hint.map_from_body = inverse(published(Pose{})) * hint.map_from_body;
  slam_->set_initial_pose(hint);
  return true;
}

std::string SlamRunner::pause_mapping(bool is_paused) {
  require_running();
  slam_->pause_mapping(is_paused);
  return is_paused ? "mapping is paused" : "mapping is resumed";
}

CommandResult execute(SlamRunner& runner, const std::string& line) {
  constexpr std::string_view kLoad = "load ";
  if (line.starts_with(kLoad)) return {runner.load(line.substr(kLoad.size())), true, true};
  if (line == "relocalise") return {runner.relocalise(), true};
  if (line == "save") return {runner.save()};
  if (line == "update") return runner.update();
  if (line == "pause mapping") return {runner.pause_mapping(true)};
  if (line == "resume mapping") return {runner.pause_mapping(false)};
  throw InputError("'" + printable(line, 100) + "'", "is not a command",
                   "send save, update, load NAME, relocalise, pause mapping or resume mapping");
}

}  // namespace byre
