#include "byre/playback/report/run_record.h"

#include "byre/io/bag/bag.h"
#include "byre/io/ros/message_bytes.h"
#include "byre/io/ros/message_matchers.h"
#include "byre/io/ros/messages.h"
#include "byre/map/point_grey.h"
#include "byre/playback/play.h"
#include "byre/recording.h"
#include "byre/simulation/rendered_scene.h"

#include <cstring>
#include <filesystem>
#include <map>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr int kFramesRecorded = 6;

// A recorded run of a few frames, made once.
class RecordedRun {
 public:
  RecordedRun() : path_(fs::path(testing::TempDir()) / ("run_record." + std::to_string(getpid()) + ".mcap")) {
    const auto recording = open_recording(RenderedFixture::shared().folder(), {.last = kFramesRecorded});
    SlamOptions options;
    options.workers = Workers::none;
    RunRecord record(McapWriter(path_), recording->calibration(), true,
                     [](const std::string& fault) { ADD_FAILURE() << fault; });
    PlayHooks hooks;
    hooks.should_stop = [] { return false; };
    hooks.after_frame = [](int, const PlayedFrame&) {};
    hooks.on_frame = [&record](const RunView& view) { record.note(view); };
    Slam slam = Slam::mapping(recording->calibration(), options);
    run_ = play(slam, *recording, hooks);
    PlayedFrame unread;
    unread.time = run_.frames.back().time + Timestamp(1);
    record.note_unreadable(unread);
    record.finish(run_);
  }
  ~RecordedRun() { fs::remove(path_); }
  RecordedRun(const RecordedRun&) = delete;
  RecordedRun& operator=(const RecordedRun&) = delete;

  static const RecordedRun& shared() {
    static const RecordedRun recorded;
    return recorded;
  }

  const fs::path& path() const { return path_; }
  const RunResult& run() const { return run_; }

  // All messages of a topic, read back as a bag.
  template <ros::Message M>
  std::vector<M> messages(const std::string& topic) const {
    const auto bag = open_bag(path_, [](std::string_view) { return true; });
    std::vector<M> messages;
    for (const BagMessage& each : bag->content().messages) {
      if (bag->content().topics[each.topic].name != topic) continue;
      messages.push_back(ros::read_message<M>(bag->read(each), ros::Encoding::cdr, topic));
    }
    return messages;
  }

 private:
  fs::path path_;
  RunResult run_;
};

TEST(RunRecord, IsACompleteBag) {
  const auto bag = open_bag(RecordedRun::shared().path(), [](std::string_view) { return false; });
  EXPECT_THAT(bag->content().damage, testing::IsEmpty());
  std::map<std::string, std::uint64_t> counts;
  for (const BagTopic& topic : bag->content().topics) counts[topic.name] = topic.messages;
  EXPECT_EQ(counts["/tf_static"], 1u);
  EXPECT_EQ(counts["/byre/points"], 2u);
  EXPECT_EQ(counts["/byre/path"], 2u);
  EXPECT_EQ(counts["/diagnostics"], kFramesRecorded + 1u);
  for (const char* const topic : {"/tf", "/byre/odometry", "/left/image_raw", "/right/camera_info"}) {
    EXPECT_EQ(counts[topic], static_cast<std::uint64_t>(kFramesRecorded)) << topic;
  }
}

TEST(RunRecord, ContainsThePosesOfTheReports) {
  const RecordedRun& recorded = RecordedRun::shared();
  const auto odometry = recorded.messages<ros::Odometry>("/byre/odometry");
  ASSERT_EQ(odometry.size(), recorded.run().frames.size());
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    const FrameReport& report = *recorded.run().frames[i].report;
    EXPECT_EQ(ros::to_nanoseconds(odometry[i].header.stamp), report.time);
    EXPECT_EQ(odometry[i].pose.pose.position.x, report.odometry_from_body->translation.x());
  }
}

TEST(RunRecord, ReportsUnreadableFrames) {
  const auto diagnostics = RecordedRun::shared().messages<ros::DiagnosticArray>("/diagnostics");
  EXPECT_NE(diagnostics.front().status.at(0).level, ros::DiagnosticStatus::kStale);
  EXPECT_EQ(diagnostics.back().status.at(0).level, ros::DiagnosticStatus::kStale);
}

TEST(RunRecord, EndsWithTheFinalPathAndMap) {
  const RecordedRun& recorded = RecordedRun::shared();
  const ros::Path path = recorded.messages<ros::Path>("/byre/path").back();
  ASSERT_EQ(path.poses.size(), recorded.run().final.size());
  EXPECT_EQ(path.poses.back().pose.position.y, recorded.run().final.back().world_from_body.translation.y());
  const ros::PointCloud2 cloud = recorded.messages<ros::PointCloud2>("/byre/points").back();
  EXPECT_EQ(cloud.width, static_cast<std::uint32_t>(recorded.run().stored.map.point_count()));
  EXPECT_EQ(cloud.data.size(), 20u * cloud.width);
}

TEST(RunRecord, StatesTheGreyValuesOfPoints) {
  const RecordedRun& recorded = RecordedRun::shared();
  const ros::PointCloud2 cloud = recorded.messages<ros::PointCloud2>("/byre/points").back();
  ASSERT_EQ(cloud.point_fields.at(3).name, "intensity");
  const MapGraph& map = recorded.run().stored.map;
  std::set<float> greys;
  std::size_t at = cloud.point_fields.at(3).offset;
  for (const PointId id : map.point_ids()) {
    float grey = -1.0f;
    std::memcpy(&grey, cloud.data.data() + at, sizeof(grey));
    EXPECT_EQ(grey, grey_of(map, *map.find_point(id)).value_or(kUnknownGrey));
    greys.insert(grey);
    at += cloud.point_step;
  }
  EXPECT_GT(greys.size(), 20u) << "texture";
}

TEST(RunRecord, CanBeRunAgainWithImages) {
  const RecordedRun& recorded = RecordedRun::shared();
  const auto original = open_recording(RenderedFixture::shared().folder(), {.last = kFramesRecorded});
  const auto again = open_recording(recorded.path(), {});
  EXPECT_EQ(again->times(), original->times());
  EXPECT_EQ(again->calibration().left, original->calibration().left);
  const Pose& expected = original->calibration().right->right_from_left;
  const Pose& found = again->calibration().right->right_from_left;
  EXPECT_LT((found.translation - expected.translation).norm(), 1e-12);
  EXPECT_LT(angle_between(found.rotation, expected.rotation), 1e-7);
  EXPECT_EQ(again->read(3)->left.pixels, original->read(3)->left.pixels);
  EXPECT_EQ(again->read(3)->right->pixels, original->read(3)->right->pixels);
}

TEST(RunRecord, CanBeReadWhenTruncated) {
  const fs::path cut = RecordedRun::shared().path().string() + ".cut.mcap";
  fs::copy_file(RecordedRun::shared().path(), cut, fs::copy_options::overwrite_existing);
  fs::resize_file(cut, fs::file_size(cut) * 3 / 4);
  const auto bag = open_bag(cut, [](std::string_view) { return true; });
  EXPECT_GT(bag->content().message_count, 10u);
  EXPECT_FALSE(bag->content().damage.empty());
  fs::remove(cut);
}

}  // namespace
}  // namespace byre
