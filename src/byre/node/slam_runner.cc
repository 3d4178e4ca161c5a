#include "byre/node/slam_runner.h"

#include "byre/dataset/settings_file.h"
#include "byre/input/output_file.h"
#include "byre/node/map_messages.h"
#include "byre/playback/options_file.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

namespace fs = std::filesystem;

SlamOptions slam_options(const NodeConfig& config) {
  SlamOptions options;
  options.workers = config.workers;
  options.vocabulary = config.vocabulary;
  options.max_pair_difference = std::max(options.max_pair_difference, config.pair_tolerance);
  if (!config.options) return options;
  EngineOptions checked;
  read_options(*config.options, checked);  // its messages tell the line
  for (const Setting& setting : read_settings(*config.options)) {
    if (setting.name != "pace") options.settings.emplace_back(setting.name, setting.text);  // workers tell that here
  }
  return options;
}

// A name in the folder of the map that is loaded, and no way out of it: whoever may send commands may not read files.
fs::path beside(const fs::path& map, const std::string& name) {
  if (name.empty() || name.starts_with('.') || name.find('/') != std::string::npos) {
    throw InputError("load", "'" + name.substr(0, 100) + "' is no file's name",
                     "name a file beside the present map, without its folder");
  }
  return map.parent_path() / name;
}

}  // namespace

SlamRunner::SlamRunner(const NodeConfig& config) : config_(config), options_(slam_options(config)), map_(config.map) {
  if (config.save) require_writable(*config.save);
}

FrameReport SlamRunner::process(const CameraImages& images) {
  FrameReport report = slam_->process(images);
  had_pose_ = had_pose_ || report.map_from_body;
  return report;
}

void SlamRunner::replace(Slam slam) {
  slam_.emplace(std::move(slam));
  had_pose_ = false;
}

Slam SlamRunner::make(const fs::path* map) const {
  switch (config_.task) {
    case NodeTask::mission:
      return Slam::on_map(*calibration_, *map, options_);
    case NodeTask::extend:
      return Slam::extending(*calibration_, *map, options_);
    case NodeTask::map:
      break;
  }
  return Slam::mapping(*calibration_, options_);
}

void SlamRunner::start(const Calibration& calibration) {
  calibration_ = calibration;
  replace(make(map_ ? &*map_ : nullptr));
  if (slam_->is_metric()) return;
  slam_.reset();
  throw InputError("the calibration", "is of one camera, which knows no metres without a map", "name a kept map");
}

Pose SlamRunner::published(const Pose& map_from_body) const {
  const auto on_plan = config_.in_plan ? slam_->plan_from_body(map_from_body) : std::nullopt;
  return on_plan.value_or(map_from_body);
}

std::string SlamRunner::map_name() const {
  const std::optional<fs::path>& file = map_ ? map_ : config_.save;
  return file ? file->stem().string() : "";
}

std::vector<Eigen::Vector3f> SlamRunner::points() const {
  if (!makes_a_map()) return points_of(*map_, config_.in_plan);
  const Pose published_from_map = published(Pose{});
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& point : slam_->point_positions())
    points.push_back((published_from_map * point).cast<float>());
  return points;
}

void SlamRunner::require_running() const {
  if (!slam_) throw InputError("byre node", "has no calibration yet", "wait for camera info");
}

std::string SlamRunner::save() const {
  require_running();
  if (!config_.save) throw InputError("save", "has no file to write", "set slam.save");
  slam_->save(*config_.save);
  return "saved " + config_.save->string();
}

std::string SlamRunner::load(const std::string& name) {
  require_running();
  if (config_.task != NodeTask::mission) {
    throw InputError("load", "would leave the map that is being made", "set slam.task to mission");
  }
  const fs::path map = beside(*map_, name);
  replace(make(&map));
  map_ = map;
  return "loaded " + map.string();
}

std::string SlamRunner::relocalise() {
  require_running();
  if (config_.task != NodeTask::mission) {
    throw InputError("relocalise", "would leave the map that is being made", "set slam.task to mission");
  }
  replace(make(&*map_));
  return "looking for the robot in " + map_->string();
}

bool SlamRunner::look_near(PoseHint hint) {
  require_running();
  if (config_.task != NodeTask::mission) return false;
  hint.map_from_body = inverse(published(Pose{})) * hint.map_from_body;
  slam_->look_near(hint);
  return true;
}

std::string obey(SlamRunner& runner, const std::string& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string word = line.substr(0, end);
  const std::string rest = end < line.size() ? line.substr(end + 1) : "";
  if (word == "load") return runner.load(rest);
  if (rest.empty() && word == "save") return runner.save();
  if (rest.empty() && word == "relocalise") return runner.relocalise();
  throw InputError("'" + line.substr(0, 100) + "'", "is no command", "send save, load NAME or relocalise");
}

}  // namespace byre
