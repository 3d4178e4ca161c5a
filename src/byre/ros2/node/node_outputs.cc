#include "byre/ros2/node/node_outputs.h"

#include "byre/floor_plan.h"
#include "byre/playback/report/report.h"
#include "byre/ros2/dds/ros_network.h"
#include "byre/ros2/node/health_messages.h"
#include "byre/ros2/node/map_messages.h"
#include "byre/site.h"

#include <chrono>
#include <utility>

#include <nlohmann/json.hpp>

namespace byre {
namespace {

constexpr TopicQos kReliable{.is_reliable = true, .is_latched = false, .depth = 10};
constexpr TopicQos kLatched{.is_reliable = true, .is_latched = true, .depth = 1};
constexpr TopicQos kTransforms{.is_reliable = true, .is_latched = false, .depth = 100};
constexpr TopicQos kEvents{.is_reliable = true, .is_latched = true, .depth = 50};

}  // namespace

Timestamp NodeOutputs::wall_time() {
  return std::chrono::system_clock::now().time_since_epoch();
}

template <ros::Message T>
NodeOutputs::OptionalOutput NodeOutputs::open(const std::string& topic, const TopicQos& qos) {
  const std::string name = config_.topic(topic);
  if (name.empty()) return std::nullopt;
  Output output{graph_.publish(name, message_type<T>(), qos), {}};
  const auto durability = qos.is_latched ? ros::Durability::latched : ros::Durability::only_new;
  if (watchers_ != nullptr) output.watched = watchers_->add(ros::topic_of<T>(name, durability));
  return output;
}

bool NodeOutputs::is_wanted(const OptionalOutput& output) const {
  if (!output) return false;
  return output->publisher.has_subscribers() || (output->watched && watchers_->is_wanted(*output->watched));
}

void NodeOutputs::send_bytes(Output& output, std::vector<std::byte> cdr) {
  if (output.watched) watchers_->put(*output.watched, stamp_, cdr);
  output.publisher.publish(std::move(cdr));
}

NodeOutputs::NodeOutputs(const NodeConfig& config, GraphAnnouncement& graph, ros::MessageSink* watchers)
    : config_(config), graph_(graph), watchers_(watchers) {
  odometry_ = open<ros::Odometry>(config.odometry, kReliable);
  pose_ = open<ros::PoseWithCovarianceStamped>(config.pose, kLatched);
  if (config.publishes_map_to_odom || config.publishes_odom_to_base) tf_ = open<ros::TFMessage>(config.tf, kTransforms);
  if (config.publishes_cameras && config.extrinsics_source() != ExtrinsicsSource::tf) {
    tf_static_ = open<ros::TFMessage>(config.tf_static, kLatched);
  }
  diagnostics_ = open<ros::DiagnosticArray>("/diagnostics", kReliable);
  path_ = open<ros::Path>(config.path, kLatched);
  points_ = open<ros::PointCloud2>(config.points, kLatched);
  const bool has_grid_of_map = config.map && (config.has_grid_of_map || is_site_file(*config.map));
  if (config.plan || has_grid_of_map) grid_ = open<ros::OccupancyGrid>(config.grid, kLatched);
  health_ = open<ros::String>(config.health, kLatched);
  events_ = open<ros::String>(config.events, kEvents);
  if (watchers_ == nullptr) return;
  const auto watch_images = [this](const std::string& topic, bool is_compressed) {
    const std::string name = config_.topic(topic);
    return watchers_->add(is_compressed ? ros::topic_of<ros::CompressedImage>(name) : ros::topic_of<ros::Image>(name));
  };
  left_ = watch_images(config.left, config.is_compressed);
  if (!config.second().empty()) second_ = watch_images(config.second(), config.is_second_compressed());
}

void NodeOutputs::publish_images(Timestamp stamp, std::span<const std::byte> left, std::span<const std::byte> second) {
  stamp_ = stamp;
  const auto send_image = [&](const std::optional<ros::MessageSink::TopicId>& topic, std::span<const std::byte> image) {
    if (!topic || image.empty() || !watchers_->is_wanted(*topic)) return;
    watchers_->put(*topic, stamp, {image.begin(), image.end()});
  };
  send_image(left_, left);
  send_image(second_, second);
}

ros::Header NodeOutputs::in_map(const ros::Header& image) const {
  return {image.stamp, config_.map_frame};
}

void NodeOutputs::publish_odometry(const ros::Header& header, const FrameReport& report, const Pose& odom_from_base) {
  ros::Odometry odometry;
  odometry.header = header;
  odometry.child_frame_id = config_.base_frame;
  odometry.pose = pose_message(header, odom_from_base, report.odometry_covariance).pose;
  const OdometrySample now = odometry_sample(report, odom_from_base);
  odometry.twist = twist_message(last_, now);
  last_ = now;
  send(odometry_, odometry);
}

void NodeOutputs::publish_transforms(const ros::Header& image, const PoseFrames& frames, bool is_map_free) {
  ros::TFMessage message;
  if (config_.publishes_map_to_odom && is_map_free && frames.map_from_odom()) {
    const ros::Time later = ros::to_time(ros::to_nanoseconds(image.stamp) + from_seconds(config_.future));
    message.transforms.push_back(
        transform_message({later, config_.map_frame}, config_.odom_frame, *frames.map_from_odom()));
  }
  if (frames.is_odometry_own() && frames.odom_from_base()) {
    message.transforms.push_back(
        transform_message({image.stamp, config_.odom_frame}, config_.base_frame, *frames.odom_from_base()));
  }
  if (!message.transforms.empty()) send(tf_, message);
}

void NodeOutputs::publish_events(const FrameReport& report) {
  PlayedFrame frame;
  frame.time = report.time;
  frame.report = report;
  event_log_.note(frames_, frame);
  std::istringstream lines(std::exchange(event_lines_, {}).str());
  for (std::string line; std::getline(lines, line);) send_text(events_, line);
}

void NodeOutputs::publish_frame(const ros::Header& image, const FrameReport& report, const PoseFrames& frames,
                                bool is_map_free) {
  if (frames.odom_from_base()) {
    const std::string frame = frames.is_odometry_own() ? config_.odom_frame : config_.name + "_odom";
    publish_odometry({image.stamp, frame}, report, *frames.odom_from_base());
  } else {
    last_.reset();
  }
  if (report.map_from_body && report.health.verdict != Verdict::untrusted) {
    send(pose_, pose_message(in_map(image), *report.map_from_body, report.covariance));
  }
  publish_transforms(image, frames, is_map_free);
  if (is_wanted(health_)) send_text(health_, health_line(report));
  publish_events(report);
  ++frames_;
}

void NodeOutputs::publish_cameras(const Calibration& calibration, const std::string& left_frame,
                                  const std::string& right_frame) {
  if (!tf_static_) return;
  const ros::Header header{ros::to_time(wall_time()), config_.base_frame};
  ros::TFMessage message;
  const auto add = [&](const std::string& frame, const Pose& base_from_camera) {
    if (!frame.empty() && frame != config_.base_frame) {
      message.transforms.push_back(transform_message(header, frame, base_from_camera));
    }
  };
  add(left_frame, calibration.body_from_left);
  if (calibration.right && right_frame != left_frame) {
    add(right_frame, calibration.body_from_left * inverse(calibration.right->right_from_left));
  }
  if (!message.transforms.empty()) send(tf_static_, message);
}

void NodeOutputs::publish_diagnostics(std::vector<ros::DiagnosticStatus> statuses) {
  send(diagnostics_, ros::DiagnosticArray{{ros::to_time(wall_time()), ""}, std::move(statuses)});
}

void NodeOutputs::publish_answer(const std::string& request, bool is_done, const std::string& answer) {
  const nlohmann::ordered_json line = {
      {"event", "command"}, {"command", request}, {"done", is_done}, {"answer", answer}};
  send_text(events_, dump_json(line));
}

void NodeOutputs::publish_plan() {
  if (grid_ && config_.plan) publish_grid(grid_of(read_floor_plan(*config_.plan)));
}

void NodeOutputs::publish_grid(ros::OccupancyGrid grid) {
  grid.header = {ros::to_time(wall_time()), config_.map_frame};
  grid.info.map_load_time = grid.header.stamp;
  send(grid_, grid);
}

void NodeOutputs::publish_path(const SlamRunner& runner, Timestamp image_time) {
  if (!is_wanted(path_)) return;
  const ros::Header header{ros::to_time(image_time), config_.map_frame};
  send(path_,
       path_message(header, runner.trajectory(), [&runner](const Pose& pose) { return runner.published(pose); }));
}

void NodeOutputs::publish_points(const SlamRunner& runner) {
  if (!is_wanted(points_)) return;
  if (std::exchange(has_published_points_, true) && !runner.makes_map()) return;
  send(points_, cloud_message({ros::to_time(wall_time()), config_.map_frame}, runner.points()));
}

}  // namespace byre
