#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

namespace byre::testing_ros2 {

struct PeerQos {
  bool is_reliable = true;
  bool is_latched = false;
  int depth = 10;
};

// A ROS 2 participant by Fast DDS, on the loopback interface, without shared memory.
class FastPeer {
 public:
  explicit FastPeer(int domain);
  ~FastPeer();
  FastPeer(const FastPeer&) = delete;
  FastPeer& operator=(const FastPeer&) = delete;

  eprosima::fastdds::dds::DataWriter* writer(const std::string& topic, eprosima::fastdds::dds::TypeSupport type,
                                             const PeerQos& qos);
  eprosima::fastdds::dds::DataReader* reader(const std::string& topic, eprosima::fastdds::dds::TypeSupport type,
                                             const PeerQos& qos, eprosima::fastdds::dds::DataReaderListener* listener);

  // Whether the writer gets a reader within some seconds.
  static bool has_subscriber(eprosima::fastdds::dds::DataWriter* writer);

 private:
  eprosima::fastdds::dds::Topic* topic(const std::string& name, eprosima::fastdds::dds::TypeSupport type);

  eprosima::fastdds::dds::DomainParticipant* participant_ = nullptr;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
};

template <typename Message, typename Type>
class Inbox : private eprosima::fastdds::dds::DataReaderListener {
 public:
  Inbox(FastPeer& peer, const std::string& topic, const PeerQos& qos)
      : reader_(peer.reader(topic, eprosima::fastdds::dds::TypeSupport(new Type), qos, this)) {}
  ~Inbox() override { reader_->set_listener(nullptr); }

  // The first message that fits, waiting for it up to patience.
  std::optional<Message> find(const std::function<bool(const Message&)>& fits,
                              std::chrono::seconds patience = std::chrono::seconds(20)) {
    std::unique_lock lock(mutex_);
    std::size_t looked_at = 0;
    std::optional<Message> found;
    received_.wait_for(lock, patience, [&] {
      for (; !found && looked_at < messages_.size(); ++looked_at) {
        if (fits(messages_[looked_at])) found = messages_[looked_at];
      }
      return found.has_value();
    });
    return found;
  }
  std::optional<Message> first() {
    return find([](const Message&) { return true; });
  }
  std::vector<Message> all() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  void clear() {
    const std::lock_guard lock(mutex_);
    messages_.clear();
  }

 private:
  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override {
    Message message;
    eprosima::fastdds::dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const std::lock_guard lock(mutex_);
      messages_.push_back(message);
      received_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable received_;
  std::vector<Message> messages_;  // guarded by mutex_
  eprosima::fastdds::dds::DataReader* reader_;
};

}  // namespace byre::testing_ros2
