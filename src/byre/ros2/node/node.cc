#include "byre/ros2/node/node.h"

#include "byre/base/printable.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/ros2/dds/ros_network.h"
#include "byre/ros2/node/health_messages.h"
#include "byre/ros2/node/map_messages.h"
#include "byre/ros2/node/message_parsing.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// Monotonic clock, unrelated to the time of day.
Timestamp steady_now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

constexpr std::size_t kShownOfText = 100;  // bytes of external text quoted in an answer or a log line

// Bound for reading or writing a building's map on a slow disk; tracking pauses meanwhile.
constexpr std::chrono::minutes kLongestWithFiles{5};

// Texts are compared without numbers, which change all the time.
std::string without_digits(std::string text) {
  std::erase_if(text, [](char letter) { return letter >= '0' && letter <= '9'; });
  return text;
}

MessageType image_type(bool is_compressed) {
  return is_compressed ? message_type<ros::CompressedImage>() : message_type<ros::Image>();
}

PairingOptions pairing_options(const NodeConfig& config) {
  return {!config.second().empty(), from_seconds(config.pair_tolerance), from_seconds(config.pair_wait)};
}

}  // namespace

Node::Node(const NodeConfig& config, const RosNetwork& network, const std::string& cyclone_settings, NodeLog log)
    : config_(config),
      log_(std::move(log)),
      participant_(network, cyclone_settings),
      graph_(participant_, {config.name, config.name_space.empty() ? "/" : config.name_space}),
      inputs_([this](const std::string& topic) { return participant_.publishers(topic); }, steady_now()),
      calibration_source_(config, graph_, inputs_),
      runner_(config),
      watchers_(config.http_port ? std::make_shared<LiveTopics>() : nullptr),
      outputs_(config, graph_, watchers_.get()),
      motion_(config, graph_, inputs_),
      pairs_(pairing_options(config)),
      monitor_(config.topic(config.left), config.has_depth() ? "depth" : "right", steady_now()),
      robot_frames_({config.map_frame, config.odom_frame, config.base_frame}) {
  const auto subscribe = [this](const std::string& topic, const MessageType& type, const TopicQos& qos) {
    return topic.empty() ? std::nullopt : std::optional(graph_.subscribe(config_.topic(topic), type, qos));
  };
  const TopicQos images{.is_reliable = config.is_reliable, .depth = 5};
  const TopicQos small{.max_bytes = kMaxBytesWithoutImage};
  command_ = subscribe(config.command, message_type<ros::String>(), small);
  initial_pose_ = subscribe(config.initial_pose, message_type<ros::PoseWithCovarianceStamped>(), small);
  const TopicQos transforms{
      .is_reliable = false, .depth = 1000, .max_bytes = kMaxBytesWithoutImage, .ignores_own = true};
  tf_ = subscribe(config.tf, message_type<ros::TFMessage>(), transforms);
  tf_static_ = subscribe(config.tf_static, message_type<ros::TFMessage>(),
                         {.is_latched = true, .depth = 100, .max_bytes = kMaxBytesWithoutImage, .ignores_own = true});
  if (config.services.value_or(network.uses_cyclone)) services_.emplace(config, graph_, log_);
  calibration_ = calibration_source_.take("", std::nullopt);
  if (calibration_) start();
  require_plan_of_map(config_);
  outputs_.publish_plan();
  left_ = subscribe(config.left, image_type(config.is_compressed), images);
  second_ = subscribe(config.second(), image_type(config.is_second_compressed()), images);
  watch_images(images);
  watch_odometry(transforms);
  watch_outputs();
  graph_.announce();
  if (const auto fleet = fleet_options(config)) fleet_.emplace(*fleet);
  if (config.http_port) {
    web_server_.emplace(WebServerOptions{config.http_address, *config.http_port, {}},
                        std::make_unique<StatusSite>(board_), watchers_);
    for (const std::string& url : web_server_->urls())
      log_(LogLevel::info, "healthz, metrics and Foxglove are served at " + url);
  }
}

void Node::watch_images(const TopicQos& qos) {
  const auto watch = [&](const char* name, const std::string& topic, const std::optional<Subscriber>& subscriber,
                         const char* setting, bool is_compressed) {
    WatchedInput input{name, config_.topic(topic), {image_type(is_compressed).name}, qos};
    input.remedy_for_type = fmt::format("set {}: {}", setting, !is_compressed);
    input.remedy_for_reliability = "set images.reliable: false";
    input.matched = [source = &subscriber] { return (*source)->publishers(); };
    return inputs_.add(std::move(input));
  };
  left_input_ = watch("left images", config_.left, left_, "images.compressed", config_.is_compressed);
  if (!second_) return;
  second_input_ =
      config_.has_depth()
          ? watch("depth images", config_.depth, second_, "images.depth_compressed", config_.is_depth_compressed)
          : watch("right images", config_.right, second_, "images.compressed", config_.is_compressed);
}

void Node::watch_odometry(const TopicQos& qos) {
  WatchedInput input{"transform from " + config_.odom_frame + " to " + config_.base_frame,
                     config_.topic(config_.tf),
                     {message_type<ros::TFMessage>().name},
                     qos};
  input.matched = [this] { return tf_->publishers(); };
  input.detail = [this]() -> std::string {
    const std::string root = robot_frames_.root_of_base();
    if (root == config_.odom_frame) return "";
    if (robot_frames_.has_base_owner()) {
      return config_.base_frame + " has the parent " + root + "; start the base driver, or set frames.base: " + root;
    }
    return "start the base driver, or set frames.odom_to_base: true";
  };
  odometry_input_ = inputs_.add(std::move(input));
  inputs_.set_needed(odometry_input_, !config_.publishes_odom_to_base);
}

void Node::watch_outputs() {
  const std::string other_name = "two nodes have the name " + config_.full_name() + "; stop one, or set node.name";
  for (const std::string& topic : {config_.odometry, config_.path, config_.points, config_.health, config_.events}) {
    if (!topic.empty()) inputs_.add(WatchedOutput{config_.topic(topic), other_name});
  }
  if (!config_.pose.empty()) {
    inputs_.add(WatchedOutput{config_.topic(config_.pose), "stop it (such as amcl), or set topics.pose"});
  }
  if (!outputs_.has_grid()) return;
  const std::string other_grid = config_.plan ? "topics.grid: \"\"" : "grid.from_map: false";
  inputs_.add(WatchedOutput{config_.topic(config_.grid), "stop it (such as map_server), or set " + other_grid});
}

// Once; without frames that have a parent already.
void Node::publish_cameras(const std::string& left_frame, const std::string& right_frame) {
  if (!camera_frames_.empty() || !outputs_.has_cameras()) return;
  camera_frames_ = {left_frame, right_frame};
  const auto unless_taken = [this](const std::string& frame) -> std::string {
    return robot_frames_.has_parent(frame) ? "" : frame;
  };
  outputs_.publish_cameras(*calibration_, unless_taken(left_frame), unless_taken(right_frame));
}

// Frame of a camera to which another node publishes a transform; empty if none does.
std::string Node::rival_of_cameras() const {
  const auto found = std::ranges::find_if(camera_frames_, [this](const std::string& frame) {
    return frame != config_.base_frame && robot_frames_.has_parent(frame);
  });
  return found == camera_frames_.end() ? "" : *found;
}

void Node::check_inputs(Timestamp now) {
  constexpr Timestamp kInterval = 500ms;
  if (now - last_checked_ < kInterval) return;
  last_checked_ = now;
  // Another node that publishes a transform to the base owns odometry.
  inputs_.set_needed(odometry_input_, !config_.publishes_odom_to_base || robot_frames_.has_base_owner());
  const auto odometry = robot_frames_.last_odometry();
  if (odometry && odometry != last_odometry_) inputs_.note_arrival(odometry_input_);
  last_odometry_ = odometry;
  for (const LogLine& line : inputs_.check(now)) log_(line.level, line.text);
}

void Node::take_images(Timestamp now) {
  const auto stamp_of = [](const Message& message, const std::string& topic) -> std::optional<ros::Header> {
    return parsed_message<ros::Header>(message, topic);  // both image types begin with a header
  };
  for (Message& message : left_->take()) {
    const auto header = stamp_of(message, config_.left);
    if (!header) continue;
    monitor_.note_arrival(now);
    inputs_.note_arrival(left_input_);
    left_frame_ = header->frame_id;
    pairs_.add_left(ros::to_nanoseconds(header->stamp), std::move(message), now);
  }
  if (!second_) return;
  for (Message& message : second_->take()) {
    const auto header = stamp_of(message, config_.second());
    if (!header) continue;
    inputs_.note_arrival(second_input_);
    if (config_.has_depth() && !calibration_) note_depth_format(message, now);
    pairs_.add_second(ros::to_nanoseconds(header->stamp), std::move(message), now);
  }
}

void Node::take_transforms(Timestamp now) {
  for (const Message& message : tf_static_->take()) {
    if (const auto parsed = parsed_message<ros::TFMessage>(message, config_.tf_static))
      robot_frames_.take_static(*parsed);
  }
  for (const Message& message : tf_->take()) {
    if (const auto parsed = parsed_message<ros::TFMessage>(message, config_.tf)) robot_frames_.take(*parsed, now);
  }
  log_transforms(now);
}

// Reports each change of who publishes the transforms, with a remedy for conflicts.
void Node::log_transforms(Timestamp now) {
  constexpr Timestamp kPatience = 5s;
  const std::string tf = config_.topic(config_.tf);
  const std::string odometry = config_.odom_frame + " -> " + config_.base_frame;
  LogLevel level = LogLevel::warning;
  std::string text;
  if (config_.publishes_map_to_odom && robot_frames_.has_odom_owner(now)) {
    text = "another node publishes a transform to " + config_.odom_frame + " on " + tf +
           ", so byre does not; stop it (such as amcl), or set frames.map_to_odom: false";
  } else if (without_odometry_since_ && now - *without_odometry_since_ > kPatience && last_odometry_ &&
             now - *last_odometry_ < kPatience) {
    text = "no transform " + odometry + " at the time of the images on " + tf +
           " for 5 s; check that the clock of the base driver is that of the images";
  } else if (const std::string camera = rival_of_cameras(); !camera.empty()) {
    text = "another node publishes a transform to " + printable(camera, kShownOfText) +
           "; set frames.cameras: false, or frames.mounting: tf to use it";
  } else if (last_odometry_) {
    level = LogLevel::info;
    text = "another node publishes " + odometry + " on " + tf + "; " + config_.map_frame + " -> " + config_.odom_frame +
           " is computed from it";
  }
  if (text == last_transforms_) return;
  last_transforms_ = text;
  if (!text.empty()) log_(level, text);
}

void Node::start() {
  for (const std::string& warning : calibration_source_.take_warnings()) log_(LogLevel::warning, warning);
  manager_.busy(kLongestWithFiles);
  const std::string extrinsics = runner_.take_extrinsics(calibration_->body_from_left, motion_.base_of_wheels());
  const std::string note = runner_.start(*calibration_);
  if (!note.empty()) log_(LogLevel::warning, note);
  if (!extrinsics.empty()) log_(LogLevel::info, extrinsics);
  publish_grid_of_map();
}

// The first message of the wheels determines whether their extrinsics are those of /tf_static.
bool Node::is_waiting_for_wheels(Timestamp now) {
  constexpr Timestamp kPatience = 2s;  // for the discovery of the publisher
  if (!calibrated_at_) calibrated_at_ = now;
  waits_for_wheels_ = !config_.wheels.empty() && config_.extrinsics_source() == ExtrinsicsSource::tf &&
                      !config_.extrinsics_file && !motion_.base_of_wheels() && now - *calibrated_at_ < kPatience;
  return waits_for_wheels_;
}

// The grid of an earlier map is replaced also if this one has none.
void Node::publish_grid_of_map() {
  if (!outputs_.has_grid_of_map()) return;
  try {
    outputs_.publish_grid(runner_.occupancy().value_or(unknown_grid()));
  } catch (const InputError& error) {
    outputs_.publish_grid(unknown_grid());
    log_(LogLevel::warning, error.what());
  }
}

void Node::take_calibration(Timestamp now) {
  if (calibration_) return;
  try {
    const auto calibration = calibration_source_.take(left_frame_, depth_format_);
    if (!calibration || is_waiting_for_wheels(now)) return;
    calibration_ = calibration;
    start();
  } catch (const InputError& error) {
    calibration_.reset();
    monitor_.note_unusable(error, now);
    if (last_fault_ == error.what()) return;
    last_fault_ = error.what();
    log_(LogLevel::error, last_fault_);
  }
}

Outcome Node::answer(const std::string& request, const std::function<std::string()>& done) {
  Outcome outcome;
  manager_.busy(kLongestWithFiles);
  try {
    outcome = {true, done()};
  } catch (const InputError& error) {
    outcome = {false, error.what()};
  }
  log_(outcome.is_done ? LogLevel::info : LogLevel::warning, request + ": " + outcome.answer);
  outputs_.publish_answer(request, outcome.is_done, outcome.answer);
  return outcome;
}

Outcome Node::execute(const std::string& command) {
  return answer(printable(command, kShownOfText), [&] {
    const CommandResult result = byre::execute(runner_, command);
    if (result.restarts) restart();
    if (result.loads) publish_grid_of_map();
    return result.answer;
  });
}

Outcome Node::take_hint(const ros::PoseWithCovarianceStamped& hint) {
  return answer("initial pose", [&] { return compare(hint); });
}

void Node::restart() {
  pose_frames_.restart();
  if (fleet_) fleet_->restart();
  outputs_.restart();
  map_from_body_.reset();
  last_report_.reset();
}

// A pose set by hand is a hint. If it contradicts a reliable pose, relocalisation restarts, near the hint first.
std::string Node::compare(const ros::PoseWithCovarianceStamped& message) {
  constexpr double kNear = 2.0;  // metres
  const std::string& frame = message.header.frame_id;
  if (!frame.empty() && frame != config_.map_frame) {
    throw InputError(config_.initial_pose, "is in frame '" + printable(frame, kShownOfText) + "'",
                     "publish it in '" + config_.map_frame + "', the fixed frame of RViz");
  }
  auto hint = hint_of(message);
  if (!hint) throw InputError(config_.initial_pose, "has a non-finite position", "set the pose again");
  std::string answer;
  if (map_from_body_) {
    const double distance = (map_from_body_->translation - hint->map_from_body.translation).head<2>().norm();
    if (distance <= kNear) return fmt::format("agrees with the current pose within {:.1f} m", distance);
    answer = fmt::format("{:.1f} m from the current pose; ", distance) + runner_.relocalise() + "; ";
    hint->map_from_body.translation.z() = map_from_body_->translation.z();  // a click on a map has no height
    restart();
  }
  if (!runner_.set_initial_pose(*hint)) return "not used: the search already covers the whole map";
  return answer + fmt::format("searching within {:.1f} m of it for {:.0f} s, then in the whole map", hint->radius,
                              hint->seconds);
}

void Node::take_requests(Timestamp now) {
  const auto take = [](std::optional<Subscriber>& subscriber) {
    return subscriber ? subscriber->take() : std::vector<Message>();
  };
  for (const Message& message : take(command_)) {
    const auto command = parsed_message<ros::String>(message, config_.command);
    if (command) execute(command->data);
  }
  for (const Message& message : take(initial_pose_)) {
    const auto given = parsed_message<ros::PoseWithCovarianceStamped>(message, config_.initial_pose);
    if (given) take_hint(*given);
  }
  if (!services_) return;
  services_->answer(
      [this](const ServiceCall& call) { return call.hint ? take_hint(*call.hint) : execute(call.command); }, now);
}

ReceivedImage Node::decoded(const Message& message, const std::string& topic) const {
  const auto bytes = message.bytes();
  if (config_.is_compressed) {
    return received_image(ros::read_message<ros::CompressedImage>(bytes, ros::Encoding::cdr, topic), topic);
  }
  return received_image(ros::read_message<ros::Image>(bytes, ros::Encoding::cdr, topic), topic);
}

ReceivedDepth Node::decoded_depth(const Message& message) const {
  const std::string topic = config_.topic(config_.depth);
  if (config_.is_depth_compressed) {
    return received_depth(ros::read_message<ros::CompressedImage>(message.bytes(), ros::Encoding::cdr, topic), topic);
  }
  return received_depth(ros::read_message<ros::Image>(message.bytes(), ros::Encoding::cdr, topic), topic);
}

void Node::note_depth_format(const Message& message, Timestamp now) {
  try {
    const ReceivedDepth depth = decoded_depth(message);
    depth_format_ = {depth.header.frame_id, depth.image.width, depth.image.height, depth.is_in_metres};
  } catch (const InputError& error) {
    monitor_.note_unusable(error, now);
  }
}

// Empty for an image that is not as calibrated: the left image is then tracked alone.
std::optional<ReceivedDepth> Node::usable_depth(const Message& message, Timestamp now) {
  const std::string topic = config_.topic(config_.depth);
  try {
    ReceivedDepth depth = decoded_depth(message);
    require_calibrated_size(depth.image.width, depth.image.height,
                            calibration_->depth->camera.value_or(calibration_->left), topic);
    if (depth.is_in_metres == depth_format_->is_in_metres) return depth;
    throw InputError(topic, "changed between depths in metres and in millimetres", "start the node again");
  } catch (const InputError& error) {
    monitor_.note_unusable(error, now);
    return std::nullopt;
  }
}

void Node::process(const Pairs::Pair& pair) {
  const Timestamp begin = steady_now();
  ++frames_;
  try {
    ReceivedImage left = decoded(pair.left, config_.topic(config_.left));
    std::optional<ReceivedImage> right;
    std::optional<ReceivedDepth> depth;
    if (pair.second && config_.has_depth()) depth = usable_depth(*pair.second, begin);
    if (pair.second && config_.has_right()) right = decoded(*pair.second, config_.topic(config_.right));
    const auto [time, jump] = clock_.read(pair.stamp, begin);
    if (right) right->layout.time += time - left.layout.time;
    left.layout.time = time;
    CameraImages images{left.view()};
    if (right) images.right = right->view();
    if (depth) images.depth = depth->view(time + (ros::to_nanoseconds(depth->header.stamp) - pair.stamp));
    motion_.take();
    motion_.forward(clock_, runner_);
    if (const std::string fault = motion_.take_fault(); !fault.empty()) log_(LogLevel::warning, fault);
    const FrameReport report = runner_.process(images);
    outputs_.publish_images(pair.stamp, pair.left.bytes(),
                            pair.second ? pair.second->bytes() : std::span<const std::byte>());
    publish_cameras(left.header.frame_id, right ? right->header.frame_id : "");
    publish(left, report);
    const CameraFrame camera_frame{right || depth,
                                   second_.has_value(),
                                   report.health.doubt == DistrustReason::frozen,
                                   to_seconds(steady_now() - begin),
                                   report.input,
                                   pair.nearest,
                                   jump};
    monitor_.note_frame(camera_frame, steady_now());
  } catch (const InputError& error) {
    monitor_.note_unusable(error, begin);
  }
  monitor_.note_skipped(pairs_.counts().skipped, begin);
}

void Node::publish(const ReceivedImage& left, const FrameReport& report) {
  if (is_dropped(report.input)) return;  // without a pose
  if (report.has(SessionEvent::map_changed)) {
    restart();
    publish_grid_of_map();
  }
  map_from_body_ = report.map_from_body;
  const Timestamp now = steady_now();
  take_transforms(now);
  if (config_.publishes_odom_to_base && !robot_frames_.has_base_owner()) {
    pose_frames_.note(report);
  } else {
    const auto odom_from_base = robot_frames_.odom_from_base(ros::to_nanoseconds(left.header.stamp));
    if (odom_from_base) without_odometry_since_.reset();
    if (!odom_from_base && !without_odometry_since_) without_odometry_since_ = now;
    pose_frames_.note(report, odom_from_base);
  }
  outputs_.publish_frame(left.header, report, pose_frames_, !robot_frames_.has_odom_owner(now));
  if (fleet_) fleet_->note(report, steady_now(), std::string(advice_for(report.health.doubt)));
  last_image_time_ = ros::to_nanoseconds(left.header.stamp);
  const auto source_of = [this](MotionSensor sensor) { return motion_.source_of(sensor); };
  log_changes(report, last_report_, runner_.map_damage(), source_of, log_);
  last_report_ = report;
}

ros::DiagnosticStatus Node::localisation() const {
  ros::DiagnosticStatus status;
  if (last_report_) {
    status = localisation_status(*last_report_);
    if (!runner_.last_update().empty()) status.values.push_back({"map update", runner_.last_update()});
    return status;
  }
  status.level = ros::DiagnosticStatus::kWarn;
  status.name = "byre: localisation";
  const std::string missing =
      waits_for_wheels_ ? "wheel odometry on " + config_.topic(config_.wheels) : calibration_source_.missing_input();
  status.message = runner_.is_running() ? "no frame has been tracked yet" : "waiting for " + missing;
  return status;
}

void Node::publish_status(const ros::DiagnosticStatus& localisation, const ros::DiagnosticStatus& cameras) {
  const std::string summary = localisation.message + "; " + cameras.message;
  manager_.status(summary);
  const bool is_healthy = last_report_ && std::max(localisation.level, cameras.level) <= ros::DiagnosticStatus::kWarn;
  board_->put(
      {is_healthy, summary, metrics_text({monitor_.arrived(), pairs_.counts().skipped, frames_, last_report_})});
}

void Node::log_registry(const ros::DiagnosticStatus& status) {
  if (status.message == last_registry_) return;
  last_registry_ = status.message;
  log_(status.level == ros::DiagnosticStatus::kOk ? LogLevel::info : LogLevel::warning, "registry: " + last_registry_);
}

// Once a second, and immediately after a change.
void Node::publish_state(Timestamp now) {
  std::vector<ros::DiagnosticStatus> statuses = {localisation(), monitor_.status(now), inputs_.status()};
  if (const auto registry = runner_.registry()) {
    statuses.push_back(registry_status(*registry, std::chrono::system_clock::now()));
    log_registry(statuses.back());
  }
  std::string diagnosis;
  for (const ros::DiagnosticStatus& status : statuses) diagnosis += without_digits(status.message);
  const bool has_changed = diagnosis != last_diagnosis_ && now - last_published_ > 100ms;
  if (has_changed || now - last_published_ > 1s) {
    publish_status(statuses[0], statuses[1]);
    outputs_.publish_diagnostics(std::move(statuses));
    last_published_ = now;
    last_diagnosis_ = diagnosis;
  }
  if (runner_.is_running() && now - last_slow_published_ > 1s) {
    outputs_.publish_path(runner_, last_image_time_);
    outputs_.publish_points(runner_);
    last_slow_published_ = now;
  }
  // A running loop is not sufficient: while images arrive, some must be tracked.
  const bool is_working = frames_ != frames_at_last_keepalive_ || monitor_.arrived() == arrived_at_last_keepalive_;
  if (!is_working && runner_.is_running()) return;
  manager_.alive();
  frames_at_last_keepalive_ = frames_;
  arrived_at_last_keepalive_ = monitor_.arrived();
}

void Node::publish_fleet(Timestamp now) {
  if (!fleet_) return;
  if (const auto change = fleet_->connection_change()) log_(LogLevel::notice, "mqtt: " + *change);
  fleet_->publish({runner_.map_name(), config_.fleet.map_description}, now);
}

void Node::run(const std::function<bool()>& should_stop) {
  log_(LogLevel::info, "node " + config_.full_name() + " is ready");
  manager_.ready();
  while (!should_stop()) {
    participant_.wait(20ms);
    const Timestamp now = steady_now();
    take_calibration(now);
    take_requests(now);
    take_images(now);
    take_transforms(now);
    motion_.take();
    if (runner_.is_running()) {
      if (const auto pair = pairs_.next(now)) process(*pair);
    }
    check_inputs(steady_now());
    publish_state(steady_now());
    publish_fleet(steady_now());
    if (web_server_) web_server_->wake();
  }
  manager_.stopping();
  if (runner_.can_save()) log_(LogLevel::info, runner_.save());
  if (runner_.can_update()) execute("update");
}

}  // namespace byre
