#include "byre/node/motion_input.h"

#include "byre/dataset/motion_messages.h"
#include "byre/dds/type_hashes.h"
#include "byre/node/message_parsing.h"

namespace byre {
namespace {

constexpr std::size_t kMostKept = 10'000;  // some seconds of the fastest sensor

// Adds what came, and leaves the oldest out where no frame asks for it.
template <ros::Message M, typename Sample>
void take_samples(std::optional<Subscriber>& subscriber, const std::string& topic, std::deque<Sample>& samples) {
  if (!subscriber) return;
  for (const Message& message : subscriber->take()) {
    const auto parsed = parsed_message<M>(message, topic);
    if (!parsed) continue;
    if (const auto sample = sample_of(*parsed, ros::to_nanoseconds(parsed->header.stamp))) samples.push_back(*sample);
    if (samples.size() > kMostKept) samples.pop_front();
  }
}

}  // namespace

MotionInput::MotionInput(const NodeConfig& config, Participant& participant, GraphAnnouncement& graph)
    : config_(config) {
  const TopicQos qos{.is_reliable = false, .depth = 1000};  // as drivers of sensors send
  const auto subscribe = [&](const std::string& topic, const MessageType& type) {
    std::optional<Subscriber> subscriber;
    if (topic.empty()) return subscriber;
    subscriber = participant.subscribe(config.topic(topic), type, qos);
    graph.add(*subscriber);
    return subscriber;
  };
  wheels_ = subscribe(config.wheels, message_type<ros::Odometry>());
  gyroscope_ = subscribe(config.gyroscope, message_type<ros::Imu>());
}

void MotionInput::take() {
  take_samples<ros::Odometry>(wheels_, config_.wheels, poses_);
  take_samples<ros::Imu>(gyroscope_, config_.gyroscope, rates_);
}

void MotionInput::tell(const StampClock& clock, SlamRunner& runner) {
  for (const StampedPose& pose : poses_) {
    runner.tell_wheels({clock.without_jumps(pose.time), pose.world_from_body});
  }
  for (const AngularRate& rate : rates_) runner.tell_gyroscope({clock.without_jumps(rate.time), rate.rate});
  poses_.clear();
  rates_.clear();
}

}  // namespace byre
