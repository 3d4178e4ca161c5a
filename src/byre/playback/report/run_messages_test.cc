#include "byre/playback/report/run_messages.h"

#include "byre/io/ros/message_matchers.h"
#include "byre/playback/play.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_scene.h"

#include <map>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::Key;

// Counts messages by topic; wants a given set of topics.
class CountingSink : public ros::MessageSink {
 public:
  explicit CountingSink(std::set<std::string> wanted) : wanted_(std::move(wanted)) {}

  TopicId add(ros::Topic topic) override {
    topics_.push_back(std::move(topic));
    return static_cast<TopicId>(topics_.size() - 1);
  }
  bool is_wanted(TopicId topic) const override { return wanted_.contains(topics_[topic].name); }
  void put(TopicId topic, Timestamp /*time*/, std::vector<std::byte> /*cdr*/) override {
    ++counts_[topics_[topic].name];
  }

  const std::map<std::string, int>& counts() const { return counts_; }

 private:
  std::set<std::string> wanted_;
  std::vector<ros::Topic> topics_;
  std::map<std::string, int> counts_;
};

constexpr int kFrames = 6;

std::map<std::string, int> messages_of_run(const std::set<std::string>& wanted, bool is_finished) {
  const auto recording = open_recording(RenderedFixture::shared().folder(), {.last = kFrames});
  CountingSink sink(wanted);
  RunMessages messages(sink, recording->calibration(), {.with_images = true, .is_watched = true});
  SlamOptions options;
  options.workers = Workers::none;
  PlayHooks hooks;
  hooks.should_stop = [] { return false; };
  hooks.after_frame = [](int, const PlayedFrame&) {};
  hooks.on_frame = [&messages](const RunView& view) { messages.note(view); };
  Slam slam = Slam::mapping(recording->calibration(), options);
  const RunResult run = play(slam, *recording, hooks);
  if (is_finished) messages.finish(run);
  return sink.counts();
}

TEST(RunMessages, CreateOnlyEventsAndExtrinsicsWithoutSubscribers) {
  EXPECT_THAT(messages_of_run({}, false), ElementsAre(Key("/byre/events"), Key("/tf_static")));
}

TEST(RunMessages, CreateSubscribedMessages) {
  const std::map<std::string, int> counts = messages_of_run({"/left/image_raw", "/diagnostics", "/byre/points"}, false);
  EXPECT_EQ(counts.at("/left/image_raw"), kFrames);
  EXPECT_EQ(counts.at("/diagnostics"), kFrames);
  EXPECT_EQ(counts.at("/byre/points"), 1);
  EXPECT_FALSE(counts.contains("/right/image_raw"));
  EXPECT_FALSE(counts.contains("/byre/path"));
}

TEST(RunMessages, LatchPathAndMap) {
  const std::map<std::string, int> counts = messages_of_run({}, true);
  EXPECT_EQ(counts.at("/byre/path"), 1);
  EXPECT_EQ(counts.at("/byre/points"), 1);
}

}  // namespace
}  // namespace byre
