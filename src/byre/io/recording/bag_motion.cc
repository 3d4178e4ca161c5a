#include "byre/io/recording/bag_motion.h"

#include "byre/input_error.h"
#include "byre/io/recording/motion_files.h"
#include "byre/io/recording/timed_messages.h"
#include "byre/io/ros/message_bytes.h"

#include <cmath>

namespace byre {
namespace {

std::optional<BaseTwist> velocity_of(const ros::Twist& twist, Timestamp time) {
  const BaseTwist velocity{time, twist.linear.x, twist.linear.y, twist.angular.z};
  const bool is_finite = std::isfinite(velocity.vx + velocity.vy + velocity.wz);
  return is_finite ? std::optional(velocity) : std::nullopt;
}

std::optional<WheelSample> wheel_sample(const std::optional<BaseTwist>& velocity, Timestamp time) {
  return velocity ? std::optional(WheelSample{time, {}, velocity}) : std::nullopt;
}

// Topic of a sensor in the options.
struct TopicRequest {
  const std::optional<std::string>& topic;  // empty: the only one
  const char* remedy;
};

// Names of these message types for errors.
template <ros::Message First, ros::Message... Others>
std::string kinds() {
  return (std::string(First::kType) + ... + (" or " + std::string(Others::kType)));
}

template <ros::Message... Ms>
std::size_t choose_topic(const BagContent& content, const TopicRequest& request, const std::string& place) {
  std::vector<std::size_t> topics;
  std::string names;
  for (std::size_t i = 0; i < content.topics.size(); ++i) {
    const BagTopic& topic = content.topics[i];
    if (!(holds<Ms>(topic) || ...) || topic.messages == 0 || !encoding_of(topic)) continue;
    names += (names.empty() ? "" : ", ") + topic.name;
    if (!request.topic || topic.name == *request.topic || topic.name == "/" + *request.topic) topics.push_back(i);
  }
  if (topics.size() == 1) return topics.front();
  throw InputError(place,
                   (request.topic ? "has no " + kinds<Ms...>() + " messages on topic " + *request.topic
                                  : "has no unique topic of type " + kinds<Ms...>()) +
                       "; available topics of this type: " + (names.empty() ? "none" : names),
                   request.remedy);
}

// Samples of the messages of one topic.
template <ros::Message M, typename Sample>
std::vector<Sample> read_topic(Bag& bag, std::size_t topic, const std::string& place, const SensorClock& images,
                               std::vector<std::string>& warnings) {
  SensorClock shared = images;
  shared.source = TimeSource::stamps;  // sound stamps of a sensor are used even if those of images are not
  const TimedMessages timed = timed_messages(bag.content(), topic, {place, "message", "message"}, shared);
  warnings.insert(warnings.end(), timed.warnings.begin(), timed.warnings.end());
  const BagTopic& kind = bag.content().topics[topic];
  const std::string name = place + ": " + kind.name;
  std::vector<Sample> samples;
  for (const auto& [time, message] : timed.messages) {
    try {
      const M read = ros::read_message<M>(bag.read(message), *encoding_of(kind), name);
      if (const auto sample = sample_of(read, time)) samples.push_back(*sample);
    } catch (const InputError&) {
      // Counted with the non-finite ones.
    }
  }
  if (const std::size_t unusable = timed.messages.size() - samples.size(); unusable > 0) {
    warnings.push_back(name + ": " + std::to_string(unusable) + " messages are damaged or contain no finite values");
  }
  return samples;
}

std::vector<WheelSample> read_wheels(Bag& bag, std::size_t topic, const std::string& place, const SensorClock& images,
                                     std::vector<std::string>& warnings) {
  const BagTopic& kind = bag.content().topics[topic];
  if (holds<ros::TwistStamped>(kind))
    return read_topic<ros::TwistStamped, WheelSample>(bag, topic, place, images, warnings);
  if (holds<ros::TwistWithCovarianceStamped>(kind)) {
    return read_topic<ros::TwistWithCovarianceStamped, WheelSample>(bag, topic, place, images, warnings);
  }
  return read_topic<ros::Odometry, WheelSample>(bag, topic, place, images, warnings);
}

// All messages use one kind, which may only be decided by later ones.
void append_wheel_odometry(const std::vector<WheelSample>& wheels, MotionSamples& samples) {
  WheelStream stream;
  for (const WheelSample& sample : wheels) stream.add(sample);
  const bool has_velocities = stream.kind() == WheelStream::Kind::velocities;
  for (const WheelSample& sample : wheels) {
    if (has_velocities && sample.velocity) samples.velocities.push_back(*sample.velocity);
    if (!has_velocities && sample.pose) samples.wheels.push_back({sample.time, *sample.pose});
  }
}

bool wants_gyroscope(const OpenOptions& options) {
  return options.use_gyroscope || options.imu_topic;
}

}  // namespace

std::optional<Pose> pose_of(const ros::Pose& message) {
  const auto& [position, orientation] = message;
  const Eigen::Quaterniond rotation(orientation.w, orientation.x, orientation.y, orientation.z);
  const Eigen::Vector3d translation(position.x, position.y, position.z);
  if (!translation.allFinite() || !(rotation.norm() > 0.5)) return std::nullopt;
  return Pose{rotation.normalized(), translation};
}

std::optional<WheelSample> sample_of(const ros::Odometry& message, Timestamp time) {
  const ros::Quaternion& turn = message.pose.pose.orientation;
  const bool has_no_turn = turn.w == 0.0 && turn.x == 0.0 && turn.y == 0.0 && turn.z == 0.0;
  const auto velocity = velocity_of(message.twist.twist, time);
  if (has_no_turn || message.pose.covariance[0] < 0.0) return wheel_sample(velocity, time);
  const auto pose = pose_of(message.pose.pose);
  return pose ? std::optional(WheelSample{time, pose, velocity}) : std::nullopt;
}

std::optional<WheelSample> sample_of(const ros::TwistStamped& message, Timestamp time) {
  return wheel_sample(velocity_of(message.twist, time), time);
}

std::optional<WheelSample> sample_of(const ros::TwistWithCovarianceStamped& message, Timestamp time) {
  return wheel_sample(velocity_of(message.twist.twist, time), time);
}

std::optional<ImuSample> sample_of(const ros::Imu& message, Timestamp time) {
  const auto vector_of = [](const ros::Vector3& vector) { return Eigen::Vector3d(vector.x, vector.y, vector.z); };
  const Eigen::Vector3d rate = vector_of(message.angular_velocity);
  const Eigen::Vector3d acceleration = vector_of(message.linear_acceleration);
  const bool has_rate = message.angular_velocity_covariance[0] != -1.0;
  if (has_rate && !rate.allFinite()) return std::nullopt;
  ImuSample sample{time};
  if (has_rate) sample.rate = {time, rate};
  const bool has_acceleration = message.linear_acceleration_covariance[0] != -1.0 && acceleration.allFinite();
  if (has_acceleration && !acceleration.isZero(0.0)) sample.acceleration = {time, acceleration};
  return sample;
}

bool is_motion_type(std::string_view type, const OpenOptions& options) {
  const BagTopic topic{"", std::string(type), ""};
  const bool is_of_wheels =
      holds<ros::Odometry>(topic) || holds<ros::TwistStamped>(topic) || holds<ros::TwistWithCovarianceStamped>(topic);
  return (options.wheels_topic && is_of_wheels) || (wants_gyroscope(options) && holds<ros::Imu>(topic));
}

SensorMotion read_bag_motion(Bag& bag, const OpenOptions& options, const std::string& place,
                             const SensorClock& images) {
  SensorMotion motion;
  if (options.wheels) {
    motion.samples.wheels = read_wheel_file(*options.wheels, images, motion.warnings);
  } else if (options.wheels_topic) {
    const TopicRequest request{options.wheels_topic, "select one with --wheels-topic TOPIC"};
    const std::size_t topic =
        choose_topic<ros::Odometry, ros::TwistStamped, ros::TwistWithCovarianceStamped>(bag.content(), request, place);
    append_wheel_odometry(read_wheels(bag, topic, place, images, motion.warnings), motion.samples);
  }
  if (wants_gyroscope(options)) {
    const TopicRequest request{options.imu_topic, "select one with --imu-topic TOPIC, or omit the gyroscope"};
    const std::size_t topic = choose_topic<ros::Imu>(bag.content(), request, place);
    std::size_t unmeasured = 0;
    for (const ImuSample& sample : read_topic<ros::Imu, ImuSample>(bag, topic, place, images, motion.warnings)) {
      if (sample.rate) motion.samples.rates.push_back(*sample.rate);
      if (!sample.rate) ++unmeasured;
      if (sample.acceleration) motion.samples.accelerations.push_back(*sample.acceleration);
    }
    if (unmeasured > 0) {
      motion.warnings.push_back(place + ": " + bag.content().topics[topic].name + ": " + std::to_string(unmeasured) +
                                " messages: " + kRatesNotMeasured);
    }
  }
  return motion;
}

}  // namespace byre
