#include "byre/node/node.h"

#include "byre/dds/type_hashes.h"
#include "byre/input/printable.h"
#include "byre/node/health_messages.h"
#include "byre/node/hint_message.h"
#include "byre/node/message_parsing.h"
#include "byre/node/metrics.h"

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

PairingOptions pairing_options(const NodeConfig& config) {
  return {config.has_right(), from_seconds(config.pair_tolerance), from_seconds(config.pair_wait)};
}

}  // namespace

Node::Node(const NodeConfig& config, const RosNetwork& network, const std::string& cyclone_settings, NodeLog log)
    : config_(config),
      log_(std::move(log)),
      participant_(network, cyclone_settings),
      graph_(participant_, {config.name, config.name_space.empty() ? "/" : config.name_space}),
      calibration_source_(config, participant_, graph_),
      runner_(config),
      watchers_(config.http_port ? std::make_shared<LiveTopics>() : nullptr),
      outputs_(config, participant_, graph_, watchers_.get()),
      motion_(config, participant_, graph_),
      pairs_(pairing_options(config)),
      watch_(config.topic(config.left), steady_now()) {
  const auto subscribe = [this](const std::string& topic, const MessageType& type, const TopicQos& qos) {
    std::optional<Subscriber> subscriber;
    if (topic.empty()) return subscriber;
    subscriber = participant_.subscribe(config_.topic(topic), type, qos);
    graph_.add(*subscriber);
    return subscriber;
  };
  const MessageType image = config.is_compressed ? message_type<ros::CompressedImage>() : message_type<ros::Image>();
  const TopicQos images{.is_reliable = config.is_reliable, .depth = 5};
  const TopicQos small{.most_bytes = kMostBytesWithoutImage};
  command_ = subscribe(config.command, message_type<ros::String>(), small);
  initial_pose_ = subscribe(config.initial_pose, message_type<ros::PoseWithCovarianceStamped>(), small);
  if (config.services.value_or(network.has_cyclone)) services_.emplace(config, participant_, graph_, log_);
  calibration_ = calibration_source_.take("");
  if (calibration_) start();
  require_plan_of_map(config_);
  outputs_.tell_plan();
  left_ = subscribe(config.left, image, images);
  right_ = subscribe(config.right, image, images);
  graph_.tell();
  if (const auto fleet = fleet_options(config)) fleet_.emplace(*fleet);
  if (config.http_port) {
    web_server_.emplace(WebServerOptions{config.http_address, *config.http_port, {}},
                        std::make_unique<StatusSite>(board_), watchers_);
    for (const std::string& url : web_server_->urls())
      log_(LogLevel::info, "healthz, metrics and Foxglove are served at " + url);
  }
}

void Node::take_images(Timestamp now) {
  const auto stamp_of = [](const Message& message, const std::string& topic) -> std::optional<ros::Header> {
    return parsed_message<ros::Header>(message, topic);  // both image types begin with a header
  };
  for (Message& message : left_->take()) {
    const auto header = stamp_of(message, config_.left);
    if (!header) continue;
    watch_.note_arrival(now);
    left_frame_ = header->frame_id;
    pairs_.add_left(ros::to_nanoseconds(header->stamp), std::move(message), now);
  }
  if (!right_) return;
  for (Message& message : right_->take()) {
    const auto header = stamp_of(message, config_.right);
    if (header) pairs_.add_right(ros::to_nanoseconds(header->stamp), std::move(message), now);
  }
}

void Node::start() {
  manager_.busy(kLongestWithFiles);
  const std::string said = runner_.start(*calibration_);
  if (!said.empty()) log_(LogLevel::warning, said);
}

void Node::take_calibration(Timestamp now) {
  if (calibration_) return;
  try {
    calibration_ = calibration_source_.take(left_frame_);
    if (calibration_) start();
  } catch (const InputError& error) {
    calibration_.reset();
    watch_.note_unusable(error, now);
    if (last_fault_ == error.what()) return;
    last_fault_ = error.what();
    log_(LogLevel::error, last_fault_);
  }
}

Outcome Node::answer(const std::string& asked, const std::function<std::string()>& done) {
  Outcome outcome;
  manager_.busy(kLongestWithFiles);
  try {
    outcome = {true, done()};
  } catch (const InputError& error) {
    outcome = {false, error.what()};
  }
  log_(outcome.is_done ? LogLevel::info : LogLevel::warning, asked + ": " + outcome.answer);
  outputs_.tell_answer(asked, outcome.is_done, outcome.answer);
  return outcome;
}

Outcome Node::obey(const std::string& command) {
  return answer(printable(command, kShownOfText), [&] {
    const Obeyed obeyed = byre::obey(runner_, command);
    if (obeyed.begins_anew) begin_anew();
    return obeyed.answer;
  });
}

Outcome Node::take_hint(const ros::PoseWithCovarianceStamped& hint) {
  return answer("initial pose", [&] { return compare(hint); });
}

void Node::begin_anew() {
  pose_frames_.begin_anew();
  if (fleet_) fleet_->begin_anew();
  outputs_.forget_points();
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
    begin_anew();
  }
  if (!runner_.look_near(*hint)) return "not used: the search already covers the whole map";
  return answer + fmt::format("searching within {:.1f} m of it for {:.0f} s, then in the whole map", hint->radius,
                              hint->seconds);
}

void Node::take_requests(Timestamp now) {
  const auto take = [](std::optional<Subscriber>& subscriber) {
    return subscriber ? subscriber->take() : std::vector<Message>();
  };
  for (const Message& message : take(command_)) {
    const auto command = parsed_message<ros::String>(message, config_.command);
    if (command) obey(command->data);
  }
  for (const Message& message : take(initial_pose_)) {
    const auto given = parsed_message<ros::PoseWithCovarianceStamped>(message, config_.initial_pose);
    if (given) take_hint(*given);
  }
  if (!services_) return;
  services_->answer([this](const ServiceCall& call) { return call.hint ? take_hint(*call.hint) : obey(call.command); },
                    now);
}

ReceivedImage Node::decoded(const Message& message, const std::string& topic) const {
  const auto bytes = message.bytes();
  if (config_.is_compressed) {
    return received_image(ros::read_message<ros::CompressedImage>(bytes, ros::Encoding::cdr, topic), topic);
  }
  return received_image(ros::read_message<ros::Image>(bytes, ros::Encoding::cdr, topic), topic);
}

void Node::process(const Pairs::Pair& pair) {
  const Timestamp begin = steady_now();
  ++frames_;
  try {
    ReceivedImage left = decoded(pair.left, config_.topic(config_.left));
    std::optional<ReceivedImage> right;
    if (pair.right) right = decoded(*pair.right, config_.topic(config_.right));
    const auto [time, jump] = clock_.read(pair.stamp, begin);
    if (right) right->about.time += time - left.about.time;
    left.about.time = time;
    CameraImages images{left.view()};
    if (right) images.right = right->view();
    motion_.take();
    motion_.tell(clock_, runner_);
    if (const std::string news = motion_.news(); !news.empty()) log_(LogLevel::warning, news);
    const FrameReport report = runner_.process(images);
    outputs_.tell_images(pair.stamp, pair.left.bytes(),
                         pair.right ? pair.right->bytes() : std::span<const std::byte>());
    if (!std::exchange(has_told_cameras_, true)) {
      outputs_.tell_cameras(*calibration_, left.header.frame_id, right ? right->header.frame_id : "");
    }
    publish(left, report);
    const CameraFrame told{right.has_value(),
                           config_.has_right(),
                           report.health.doubt == Doubt::frozen,
                           to_seconds(steady_now() - begin),
                           report.input,
                           pair.nearest,
                           jump};
    watch_.note_frame(told, steady_now());
  } catch (const InputError& error) {
    watch_.note_unusable(error, begin);
  }
  watch_.note_passed_over(pairs_.counts().passed_over, begin);
}

void Node::publish(const ReceivedImage& left, const FrameReport& report) {
  if (is_dropped(report.input)) return;  // without a pose
  map_from_body_ = report.map_from_body;
  pose_frames_.note(report);
  outputs_.tell_frame(left.header, report, pose_frames_);
  if (fleet_) fleet_->note(report, steady_now(), advice_for(report.health.doubt));
  last_image_time_ = ros::to_nanoseconds(left.header.stamp);
  const auto source_of = [this](MotionSensor sensor) { return motion_.source_of(sensor); };
  log_changes(report, last_report_, runner_.map_damage(), source_of, log_);
  last_report_ = report;
}

ros::DiagnosticStatus Node::localisation() const {
  if (last_report_) return localisation_status(*last_report_);
  ros::DiagnosticStatus status;
  status.level = ros::DiagnosticStatus::kWarn;
  status.name = "byre: localisation";
  status.message =
      runner_.is_running() ? "no frame has been tracked yet" : "waiting for " + calibration_source_.awaited();
  return status;
}

void Node::tell_status(const ros::DiagnosticStatus& localisation, const ros::DiagnosticStatus& cameras) {
  const std::string summary = localisation.message + "; " + cameras.message;
  manager_.status(summary);
  const bool is_well = last_report_ && std::max(localisation.level, cameras.level) <= ros::DiagnosticStatus::kWarn;
  board_->put({is_well, summary, metrics_text({watch_.arrived(), pairs_.counts().passed_over, frames_, last_report_})});
}

// Once a second, and immediately after a change.
void Node::tell_state(Timestamp now) {
  std::vector<ros::DiagnosticStatus> statuses = {localisation(), watch_.status(now)};
  const std::string diagnosis = without_digits(statuses[0].message + statuses[1].message);
  const bool is_news = diagnosis != last_diagnosis_ && now - last_told_ > 100ms;
  if (is_news || now - last_told_ > 1s) {
    tell_status(statuses[0], statuses[1]);
    outputs_.tell_diagnostics(std::move(statuses));
    last_told_ = now;
    last_diagnosis_ = diagnosis;
  }
  if (runner_.is_running() && now - last_slow_told_ > 1s) {
    outputs_.tell_path(runner_, last_image_time_);
    outputs_.tell_points(runner_);
    last_slow_told_ = now;
  }
  // A running loop is not sufficient: while images arrive, some must be tracked.
  const bool is_at_work = frames_ != frames_at_last_sign_ || watch_.arrived() == arrived_at_last_sign_;
  if (!is_at_work && runner_.is_running()) return;
  manager_.alive();
  frames_at_last_sign_ = frames_;
  arrived_at_last_sign_ = watch_.arrived();
}

void Node::tell_fleet(Timestamp now) {
  if (!fleet_) return;
  if (const auto news = fleet_->news()) log_(LogLevel::notice, "mqtt: " + *news);
  fleet_->tell({runner_.map_name(), config_.fleet.map_description}, now);
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
    motion_.take();
    if (runner_.is_running()) {
      if (const auto pair = pairs_.next(now)) process(*pair);
    }
    tell_state(steady_now());
    tell_fleet(steady_now());
    if (web_server_) web_server_->wake();
  }
  manager_.stopping();
  if (runner_.has_anything_to_save()) log_(LogLevel::info, runner_.save());
}

}  // namespace byre
