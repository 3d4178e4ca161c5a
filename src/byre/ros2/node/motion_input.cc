#include "byre/ros2/node/motion_input.h"

#include "byre/io/recording/bag_motion.h"
#include "byre/io/recording/static_frames.h"
#include "byre/ros2/dds/ros_network.h"
#include "byre/ros2/node/message_parsing.h"

#include <algorithm>
#include <array>
#include <utility>

namespace byre {
namespace {

constexpr std::size_t kMaxKept = 10'000;  // several seconds of the fastest sensor

// Best effort, as sensor drivers publish.
constexpr TopicQos kMotionQos{.is_reliable = false, .depth = 1000, .max_bytes = kMaxBytesWithoutImage};

// Adds a sample; drops the oldest one if no frame takes samples.
template <typename Sample>
void keep(const Sample& sample, std::deque<Sample>& samples) {
  samples.push_back(sample);
  if (samples.size() > kMaxKept) samples.pop_front();
}

// Frame in which the motion of a message is measured.
std::string moving_frame(const auto& message) {
  if constexpr (requires { message.child_frame_id; }) {
    return frame_without_slash(message.child_frame_id);
  } else {
    return frame_without_slash(message.header.frame_id);
  }
}

// use: called with each sample and its frame.
template <ros::Message M, typename Use>
void take_samples(Subscriber& subscriber, const std::string& topic, const Use& use) {
  for (const Message& message : subscriber.take()) {
    const auto parsed = parsed_message<M>(message, topic);
    if (!parsed) continue;
    if (const auto sample = sample_of(*parsed, ros::to_nanoseconds(parsed->header.stamp))) {
      use(*sample, moving_frame(*parsed));
    }
  }
}

const std::array<MessageType, 3>& wheel_types() {
  static const std::array types = {message_type<ros::Odometry>(), message_type<ros::TwistStamped>(),
                                   message_type<ros::TwistWithCovarianceStamped>()};
  return types;
}

}  // namespace

MotionInput::MotionInput(const NodeConfig& config, GraphAnnouncement& graph, InputMonitor& monitor)
    : config_(config), graph_(graph), monitor_(monitor) {
  const auto watch = [&](const char* name, const std::string& topic, const std::optional<Subscriber>& subscriber) {
    WatchedInput input{name, config.topic(topic), {}, kMotionQos};
    input.matched = [source = &subscriber] { return *source ? (*source)->publishers() : 0; };
    return input;
  };
  if (!config.gyroscope.empty()) {
    gyroscope_ = subscribe(config.gyroscope, message_type<ros::Imu>());
    WatchedInput input = watch("gyroscope messages", config.gyroscope, gyroscope_);
    input.types = {message_type<ros::Imu>().name};
    gyroscope_input_ = monitor.add(std::move(input));
  }
  if (config.wheels.empty()) return;
  WatchedInput input = watch("wheel odometry", config.wheels, wheels_);
  for (const MessageType& type : wheel_types()) input.types.push_back(type.name);
  wheels_input_ = monitor.add(std::move(input));
}

Subscriber MotionInput::subscribe(const std::string& topic, const MessageType& type) {
  return graph_.subscribe(config_.topic(topic), type, kMotionQos);
}

// The publisher determines the type of the wheels topic.
void MotionInput::find_wheels() {
  const auto publishers = graph_.participant().publishers(config_.topic(config_.wheels));
  const auto type = std::ranges::find_if(wheel_types(), [&](const MessageType& known) {
    return std::ranges::find(publishers, known.name, &DiscoveredPublisher::type) != publishers.end();
  });
  if (type == wheel_types().end()) return;
  wheels_ = subscribe(config_.wheels, *type);
  wheels_type_ = type->name;
  graph_.announce();
}

void MotionInput::take() {
  if (gyroscope_) {
    take_samples<ros::Imu>(*gyroscope_, config_.gyroscope, [&](const auto& sample, const std::string&) {
      monitor_.note_arrival(*gyroscope_input_);
      keep(sample, imu_);
    });
  }
  if (config_.wheels.empty()) return;
  if (!wheels_) find_wheels();
  if (!wheels_) return;
  const auto add = [&](const WheelSample& sample, const std::string& frame) {
    monitor_.note_arrival(*wheels_input_);
    if (!base_of_wheels_) base_of_wheels_ = frame;
    stream_.add(sample);
  };
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
  if (sensor == MotionSensor::tags) return "";
  return config_.topic(sensor == MotionSensor::wheels ? config_.wheels : config_.gyroscope);
}

}  // namespace byre
