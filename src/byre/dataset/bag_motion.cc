#include "byre/dataset/bag_motion.h"

#include "byre/dataset/bag_image.h"
#include "byre/dataset/motion_messages.h"
#include "byre/input_error.h"
#include "byre/ros/message_reader.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace byre {
namespace {

// How a sensor is asked for.
struct Asked {
  const std::optional<std::string>& topic;  // empty: the only one
  const char* remedy;
};

template <ros::Message M>
std::size_t choose_topic(const BagContent& content, const Asked& asked, const std::string& place) {
  std::vector<std::size_t> topics;
  std::string names;
  for (std::size_t i = 0; i < content.topics.size(); ++i) {
    const BagTopic& topic = content.topics[i];
    if (!holds<M>(topic) || topic.messages == 0 || !encoding_of(topic)) continue;
    names += (names.empty() ? "" : ", ") + topic.name;
    if (!asked.topic || topic.name == *asked.topic || topic.name == "/" + *asked.topic) topics.push_back(i);
  }
  if (topics.size() == 1) return topics.front();
  throw InputError(place,
                   (asked.topic ? "has no " + std::string(M::kType) + " of the topic " + *asked.topic
                                : "does not tell which " + std::string(M::kType) + " to take") +
                       "; its topics of that kind: " + (names.empty() ? "none" : names),
                   asked.remedy);
}

// The samples of one topic.
template <ros::Message M, typename Sample>
class TopicReader {
 public:
  TopicReader(Bag& bag, std::size_t topic, const std::string& place)
      : bag_(bag), topic_(topic), name_(place + ": " + bag.content().topics[topic].name) {}

  std::vector<Sample> read(std::vector<std::string>& warnings) {
    for (const BagMessage& message : bag_.content().messages) {
      if (message.topic == topic_) take(message);
    }
    if (!samples_.empty() &&
        std::ranges::all_of(samples_, [](const Sample& sample) { return sample.time == Timestamp(0); })) {
      for (std::size_t i = 0; i < samples_.size(); ++i) samples_[i].time = log_times_[i];
      warnings.push_back(name_ + ": has no time stamps in its headers, so those of the recorder are taken");
    }
    const auto is_later = [](const Sample& one, const Sample& other) { return one.time > other.time; };
    const bool is_in_order = std::ranges::adjacent_find(samples_, is_later) == samples_.end();
    std::ranges::stable_sort(samples_, {}, &Sample::time);
    const auto repeated = std::ranges::unique(samples_, {}, &Sample::time);
    samples_.erase(repeated.begin(), repeated.end());
    if (!is_in_order) warnings.push_back(name_ + ": some messages were recorded after later ones");
    if (unusable_ > 0) {
      warnings.push_back(name_ + ": " + std::to_string(unusable_) + " messages are damaged or hold no numbers");
    }
    return std::move(samples_);
  }

 private:
  void take(const BagMessage& message) {
    const BagContent& content = bag_.content();
    const BagTopic& topic = content.topics[topic_];
    try {
      const M read = ros::read_message<M>(bag_.read(message), *encoding_of(topic), name_);
      if (const auto sample = sample_of(read, stamp_of(content, message))) {
        samples_.push_back(*sample);
        log_times_.push_back(message.log_time);
        return;
      }
    } catch (const InputError&) {
      // counted with those that hold no numbers
    }
    ++unusable_;
  }

  Bag& bag_;
  std::size_t topic_;
  std::string name_;
  std::vector<Sample> samples_;
  std::vector<Timestamp> log_times_;  // one a sample
  int unusable_ = 0;                  // messages
};

bool wants_gyroscope(const OpenOptions& options) {
  return options.use_gyroscope || options.imu_topic;
}

}  // namespace

bool is_of_motion(std::string_view type, const OpenOptions& options) {
  const BagTopic topic{"", std::string(type), ""};
  return (options.wheels_topic && holds<ros::Odometry>(topic)) || (wants_gyroscope(options) && holds<ros::Imu>(topic));
}

BagMotion read_bag_motion(Bag& bag, const OpenOptions& options, const std::string& place) {
  BagMotion motion;
  if (options.wheels) {
    motion.samples.wheels = read_trajectory(*options.wheels);
  } else if (options.wheels_topic) {
    const Asked asked{options.wheels_topic, "name one of them: --wheels-topic TOPIC"};
    const std::size_t topic = choose_topic<ros::Odometry>(bag.content(), asked, place);
    motion.samples.wheels = TopicReader<ros::Odometry, StampedPose>(bag, topic, place).read(motion.warnings);
  }
  if (wants_gyroscope(options)) {
    const Asked asked{options.imu_topic, "name one of them: --imu-topic TOPIC, or leave the gyroscope out"};
    const std::size_t topic = choose_topic<ros::Imu>(bag.content(), asked, place);
    motion.samples.rates = TopicReader<ros::Imu, AngularRate>(bag, topic, place).read(motion.warnings);
  }
  return motion;
}

}  // namespace byre
