#include "byre/ros2/node/motion_input.h"

#include "byre/io/recording/motion_messages.h"
#include "byre/ros2/dds/ros_names.h"
#include "byre/ros2/node/message_parsing.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMaxKept = 10'000;  // several seconds of the fastest sensor

// Adds a sample; drops the oldest one if no frame takes samples.
template <typename Sample>
void keep(const Sample& sample, std::deque<Sample>& samples) {
  samples.push_back(sample);
  if (samples.size() > kMaxKept) samples.pop_front();
}

template <ros::Message M, typename Use>
void take_samples(Subscriber& subscriber, const std::string& topic, const Use& use) {
  for (const Message& message : subscriber.take()) {
    const auto parsed = parsed_message<M>(message, topic);
    if (!parsed) continue;
    if (const auto sample = sample_of(*parsed, ros::to_nanoseconds(parsed->header.stamp))) use(*sample);
  }
}

std::optional<MessageType> wheels_type(const std::vector<std::string>& published) {
  for (const MessageType& type : {message_type<ros::Odometry>(), message_type<ros::TwistStamped>(),
                                  message_type<ros::TwistWithCovarianceStamped>()}) {
    if (std::ranges::find(published, type.name) != published.end()) return type;
  }
  return std::nullopt;
}

}  // namespace

MotionInput::MotionInput(const NodeConfig& config, GraphAnnouncement& graph) : config_(config), graph_(graph) {
  if (!config.gyroscope.empty()) gyroscope_ = subscribe(config.gyroscope, message_type<ros::Imu>());
}

Subscriber MotionInput::subscribe(const std::string& topic, const MessageType& type) {
  // Best effort, as sensor drivers publish.
  const TopicQos qos{.is_reliable = false, .depth = 1000, .max_bytes = kMaxBytesWithoutImage};
  return graph_.subscribe(config_.topic(topic), type, qos);
}

// The publisher determines the type of the wheels topic.
void MotionInput::find_wheels() {
  const auto type = wheels_type(graph_.participant().published_types(config_.topic(config_.wheels)));
  if (!type) return;
  wheels_ = subscribe(config_.wheels, *type);
  wheels_type_ = type->name;
  graph_.announce();
}

void MotionInput::take() {
  if (gyroscope_) {
    take_samples<ros::Imu>(*gyroscope_, config_.gyroscope, [&](const auto& sample) { keep(sample, imu_); });
  }
  if (config_.wheels.empty()) return;
  if (!wheels_) find_wheels();
  if (!wheels_) return;
  const auto add = [&](const WheelSample& sample) { stream_.add(sample); };
  if (wheels_type_ == ros::Odometry::kType) take_samples<ros::Odometry>(*wheels_, config_.wheels, add);
  if (wheels_type_ == ros::TwistStamped::kType) take_samples<ros::TwistStamped>(*wheels_, config_.wheels, add);
  if (wheels_type_ == ros::TwistWithCovarianceStamped::kType) {
    take_samples<ros::TwistWithCovarianceStamped>(*wheels_, config_.wheels, add);
  }
  for (const WheelSample& sample : stream_.take()) keep(sample, samples_);
}

void MotionInput::forward(const StampClock& clock, SlamRunner& runner) {
  for (const WheelSample& sample : samples_) {
    const Timestamp time = clock.without_jumps(sample.time);
    if (sample.pose) runner.add_wheel_odometry(StampedPose{time, *sample.pose});
    if (!sample.velocity) continue;
    BaseTwist velocity = *sample.velocity;
    velocity.time = time;
    runner.add_wheel_odometry(velocity);
  }
  for (const ImuSample& sample : imu_) {
    const Timestamp time = clock.without_jumps(sample.time);
    if (sample.rate) runner.add_gyro({time, sample.rate->rate});
    if (!sample.rate) has_unmeasured_rates_ = true;
    if (sample.acceleration) runner.add_accel({time, sample.acceleration->acceleration});
  }
  samples_.clear();
  imu_.clear();
}

std::string MotionInput::take_fault() {
  if (!has_unmeasured_rates_ || std::exchange(is_reported_, true)) return "";
  return config_.topic(config_.gyroscope) + ": " + kRatesNotMeasured;
}

std::string MotionInput::source_of(MotionSensor sensor) const {
  return config_.topic(sensor == MotionSensor::wheels ? config_.wheels : config_.gyroscope);
}

}  // namespace byre
