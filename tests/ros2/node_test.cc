// Messages of `byre node` to other vendors' ROS 2 programs, and its handling of their commands.

#include "byre/map.h"
#include "byre/map/map_file.h"
#include "byre/map/map_upkeep.h"
#include "byre/map/plan/occupancy_grid.h"
#include "mapped_recording.h"
#include "node_fixture.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <thread>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::testing_ros2 {
namespace {

using testing::HasSubstr;
using std::chrono_literals::operator""ms;

TEST_F(ByreNode, PublishesThePosesOfSlam) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::mapping(read_calibration(room.calibration()), Room::options()));
  Clouds points(peer_, "rt/byre/points", kLatched);
  NodeProcess node(folder_, mapping(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto odometry = answer_to(feed_, odometry_, room.frames()[i]);
    ASSERT_TRUE(odometry.has_value()) << "frame " << i << "\n" << node.stderr_output();
    ASSERT_TRUE(expected[i].odometry_from_body.has_value());
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected[i].odometry_from_body->translation).norm(), 1e-6) << "frame " << i;
    EXPECT_EQ(odometry->header().frame_id(), "odom");
    EXPECT_EQ(odometry->child_frame_id(), "base_link");
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double variance = odometry->twist().covariance()[7 * axis];
      if (i < 2) {
        EXPECT_DOUBLE_EQ(variance, 1e6) << "frame " << i << ": the first pose has no covariance";
      } else {
        EXPECT_GT(variance, 1e-4) << "frame " << i << ", axis " << axis;
        EXPECT_LT(variance, 10.0) << "frame " << i << ", axis " << axis;
      }
    }
  }
  EXPECT_TRUE(points.find([](const auto& cloud) { return cloud.width() > 100; })) << "of the online map";
  EXPECT_EQ(node.stop(), 0);
  EXPECT_TRUE(fs::exists(folder_ / "made.byre")) << "the map is saved at the end";
}

geometry_msgs::msg::TransformStamped transform_message(Timestamp time, const std::string& parent,
                                                       const std::string& child, const Pose& parent_from_child) {
  geometry_msgs::msg::TransformStamped message;
  message.header().stamp(ros_time(time));
  message.header().frame_id(parent);
  message.child_frame_id(child);
  message.transform().translation().x(parent_from_child.translation.x());
  message.transform().translation().y(parent_from_child.translation.y());
  message.transform().translation().z(parent_from_child.translation.z());
  message.transform().rotation().w(parent_from_child.rotation.w());
  message.transform().rotation().x(parent_from_child.rotation.x());
  message.transform().rotation().y(parent_from_child.rotation.y());
  message.transform().rotation().z(parent_from_child.rotation.z());
  return message;
}

Pose pose_of(const geometry_msgs::msg::TransformStamped& message) {
  const auto& [rotation, translation] = std::pair(message.transform().rotation(), message.transform().translation());
  return {Eigen::Quaterniond(rotation.w(), rotation.x(), rotation.y(), rotation.z()),
          {translation.x(), translation.y(), translation.z()}};
}

// A base driver publishes odom -> base_link, which drifts and restarts half-way (REP-105).
TEST_F(ByreNode, ComputesMapToOdomFromTheOdometryOfABaseDriver) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::on_map(read_calibration(room.calibration()), room.map(), Room::options()));
  const auto driver = peer_.writer("rt/tf", TypeSupport(new tf2_msgs::msg::TFMessagePubSubType), kVolatile);
  Transforms transforms(peer_, "rt/tf", kVolatile);
  Texts health(peer_, "rt/byre/health", kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  ASSERT_TRUE(FastPeer::has_subscriber(driver));
  const auto odom_from_base = [&](std::size_t i) {
    const bool is_restarted = i > expected.size() / 2;
    const Pose map_from_base = expected[i].map_from_body.value_or(Pose{});
    const Pose odom_from_map{rotation_exp({0.0, 0.0, 0.02 * static_cast<double>(i)}),
                             {is_restarted ? 5.0 : 1.0, 2.0, 0.0}};
    return odom_from_map * map_from_base;
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    tf2_msgs::msg::TFMessage message;
    message.transforms().push_back(transform_message(expected[i].time, "odom", "base_link", odom_from_base(i)));
    driver->write(&message);
    std::this_thread::sleep_for(20ms);
    feed_.send(room.frames()[i]);
    const std::string time = "\"time_ns\":" + std::to_string(expected[i].time.count());
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time + ",") != std::string::npos; }))
        << "frame " << i << "\n"
        << node.stderr_output();
  }
  constexpr Timestamp kFuture = 100ms;  // frames.future
  int compared = 0;
  for (const tf2_msgs::msg::TFMessage& message : transforms.all()) {
    for (const auto& transform : message.transforms()) {
      if (transform.child_frame_id() != "odom") continue;
      const Timestamp stamp = time_of(transform.header().stamp()) - kFuture;
      const auto frame = std::ranges::find(expected, stamp, &FrameReport::time);
      ASSERT_NE(frame, expected.end());
      if (frame->health.verdict == Verdict::untrusted) continue;
      const Pose map_from_base =
          pose_of(transform) * odom_from_base(static_cast<std::size_t>(frame - expected.begin()));
      EXPECT_LT((map_from_base.translation - frame->map_from_body->translation).norm(), 1e-3) << "metres";
      EXPECT_EQ(message.transforms().size(), 1u) << "odom -> base_link belongs to the base driver";
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
  EXPECT_EQ(node.stop(), 0);
  EXPECT_TRUE(node.has_logged("another node publishes odom -> base_link")) << node.stderr_output();
}

TEST_F(ByreNode, KeepsItsTransformsInTheNamespaceOfItsRobot) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  Odometry odometry(peer_, "rt/robot1/byre/odometry", kVolatile);
  Transforms transforms(peer_, "rt/robot1/tf", kVolatile), of_all(peer_, "rt/tf", kVolatile);
  auto* const hint = peer_.writer("rt/robot1/initialpose",
                                  TypeSupport(new geometry_msgs::msg::PoseWithCovarianceStampedPubSubType), kVolatile);
  NodeProcess node(folder_, mission("node:\n  namespace: /robot1\ntopics:\n  in_namespace: true\n"), domain_);
  ASSERT_TRUE(diagnostics_.first() && feed_.has_subscriber() && FastPeer::has_subscriber(hint)) << node.stderr_output();
  ASSERT_TRUE(feed_.send_acknowledged());
  for (std::size_t i = 0; i < 10; ++i) ASSERT_TRUE(answer_to(feed_, odometry, frames[i])) << node.stderr_output();
  const auto is_to_base = [](const auto& message) {
    return std::ranges::any_of(message.transforms(),
                               [](const auto& each) { return each.child_frame_id() == "base_link"; });
  };
  EXPECT_TRUE(transforms.find(is_to_base)) << node.stderr_output();
  EXPECT_THAT(of_all.all(), testing::IsEmpty());
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, PublishesTheMissionPosesOfSlam) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::on_map(read_calibration(room.calibration()), room.map(), Room::options()));
  Poses poses(peer_, "rt/byre/pose", kLatched);
  Transforms transforms(peer_, "rt/tf", kVolatile);
  Texts health(peer_, "rt/byre/health", kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  for (const FrameReport& report : expected) {
    const auto index = static_cast<std::size_t>(&report - expected.data());
    feed_.send(room.frames()[index]);
    const std::string time = "\"time_ns\":" + std::to_string(report.time.count());
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time + ",") != std::string::npos; }))
        << "frame " << index << "\n"
        << node.stderr_output();
  }
  int compared = 0;
  for (const FrameReport& report : expected) {
    if (report.health.verdict == Verdict::untrusted) continue;
    const auto pose = poses.find([&](const auto& message) { return time_of(message.header().stamp()) == report.time; });
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT((vector_of(pose->pose().pose().position()) - report.map_from_body->translation).norm(), 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 20);
  const FrameReport& last = expected.back();
  ASSERT_NE(last.health.verdict, Verdict::untrusted);
  const auto pose = poses.find([&](const auto& message) { return time_of(message.header().stamp()) == last.time; });
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((vector_of(pose->pose().pose().position()) - last.map_from_body->translation).norm(), 1e-6);
  const Matrix6 turned = [&] {
    Matrix6 turn = Matrix6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = last.map_from_body->rotation.toRotationMatrix();
    return Matrix6(turn * last.covariance * turn.transpose());
  }();
  EXPECT_NEAR(pose->pose().covariance()[1], turned(0, 1), 1e-12);
  EXPECT_NEAR(pose->pose().covariance()[35], turned(5, 5), 1e-12);
  EXPECT_TRUE(transforms.find([](const auto& message) {
    return message.transforms().size() == 2 && message.transforms()[0].header().frame_id() == "map" &&
           message.transforms()[0].child_frame_id() == "odom" &&
           message.transforms()[1].child_frame_id() == "base_link";
  }));
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, LocalisesInAMapAndPublishesToLateJoiners) {
  const Room& room = Room::shared();
  std::ofstream(folder_ / "plan.pgm") << "P5\n3 2\n255\n" << std::string("\xff\x00\xff\x80\xff\x00", 6);
  std::ofstream(folder_ / "plan.yaml") << "image: plan.pgm\nresolution: 0.5\norigin: [-1, 2, 0]\n";
  StoredMap stored = load_map(room.map());
  stored.plan = PlanRegistration{"plan.yaml", {1.0, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 10.0}}}};
  save_map(stored, folder_ / "on_plan.byre");
  NodeProcess node(folder_, config("  map: on_plan.byre\n  plan: plan.yaml\n"), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  for (const ImageFrame& frame : room.frames()) {
    feed_.send(frame);
    std::this_thread::sleep_for(30ms);
  }
  Poses early(peer_, "rt/byre/pose", kLatched);
  ASSERT_TRUE(early.find([&](const auto& message) {
    return time_of(message.header().stamp()) == room.frames().back().time;
  })) << node.stderr_output();

  FastPeer late(domain_);
  Poses poses(late, "rt/byre/pose", kLatched);
  Transforms fixed(late, "rt/tf_static", kLatched);
  Clouds points(late, "rt/byre/points", kLatched);
  Grids grids(late, "rt/map", kLatched);
  Texts events(late, "rt/byre/events", kLatched);
  Paths paths(late, "rt/byre/path", kLatched);
  Graph graph(late, "ros_discovery_info", kLatched);
  const auto pose = poses.first();
  ASSERT_TRUE(pose.has_value());
  EXPECT_EQ(pose->header().frame_id(), "map");
  EXPECT_GT(pose->pose().pose().position().z(), 5.0) << "on the plan";
  const auto transforms = fixed.first();
  ASSERT_TRUE(transforms.has_value());
  ASSERT_EQ(transforms->transforms().size(), 2u);
  EXPECT_EQ(transforms->transforms()[0].child_frame_id(), "left_optical");
  const auto cloud = points.first();
  ASSERT_TRUE(cloud.has_value());
  EXPECT_GT(cloud->width(), 100u);
  ASSERT_EQ(cloud->data().size(), 16u * cloud->width());
  EXPECT_EQ(cloud->fields().at(3).name(), "intensity");
  float z = 0.0f;
  std::memcpy(&z, cloud->data().data() + 8, 4);
  EXPECT_GT(z, 5.0f) << "on the plan";
  const auto grid = grids.first();
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(grid->info().width(), 3u);
  EXPECT_THAT(grid->data(), testing::ElementsAre(255, 0, 100, 0, 100, 0)) << "from the lowest row; 255: unknown";
  EXPECT_DOUBLE_EQ(grid->info().origin().position().x(), -1.0);
  EXPECT_TRUE(
      events.find([](const auto& message) { return message.data().find("\"localised\"") != std::string::npos; }));
  EXPECT_TRUE(paths.find([](const auto& message) { return message.poses().size() > 20; }));
  const auto told = graph.find([](const auto& message) { return !message.node_entities_info_seq().empty(); });
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->node_entities_info_seq()[0].node_name(), "byre");
  EXPECT_EQ(told->node_entities_info_seq()[0].node_namespace(), "/");
  EXPECT_GE(told->node_entities_info_seq()[0].writer_gid_seq().size(), 9u);
  EXPECT_EQ(node.stop(), 0);
}

// Registered on a plan of one row of free pixels.
void register_on_own_plan(const std::string& name, StoredMap stored, const fs::path& folder, int pixels) {
  std::ofstream(folder / (name + ".pgm")) << fmt::format("P5\n{} 1\n255\n", pixels) << std::string(pixels, '\xff');
  std::ofstream(folder / (name + ".yaml")) << "image: " << name << ".pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
  stored.plan = PlanRegistration{name + ".yaml", {}};
  save_map(stored, folder / (name + ".byre"));
}

// The robot is switched off in one building and on in another.
TEST_F(ByreNode, ChangesTheMapOfASiteOnWakingUpElsewhere) {
  const Room& room = Room::shared();
  const Calibration calibration = read_calibration(room.calibration());
  const RenderedFixture elsewhere("byre_ros2_elsewhere", calibration,
                                  figure_eight_trajectory(75, 20.0, 3.0, 0.9, euroc_like_calibration(4).body_from_left),
                                  {.seed = 2});
  const auto recording = open_recording(elsewhere.folder(), {});
  Slam mapping = Slam::mapping(calibration, Room::options());
  for (int i = 0; i < recording->size(); ++i) mapping.process(view_of(*recording->read(i)));
  mapping.finish();
  mapping.save(folder_ / "elsewhere.byre");
  register_on_own_plan("room", load_map(room.map()), folder_, 2);
  register_on_own_plan("elsewhere", load_map(folder_ / "elsewhere.byre"), folder_, 3);
  std::ofstream(folder_ / "farm.yaml") << "name: farm\nmaps:\n"
                                          "  - {name: room, map: room.byre, plan: room.yaml}\n"
                                          "  - {name: elsewhere, map: elsewhere.byre, plan: elsewhere.yaml}\n";
  NodeProcess node(folder_, config("  map: farm.yaml\n"), domain_);
  Grids grids(peer_, "rt/map", kLatched);
  Texts health(peer_, "rt/byre/health", kVolatile);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  // Health of the last frame.
  const auto drive = [&](int frames, const std::function<ImageFrame(int)>& frame_at, Timestamp later) {
    nlohmann::json last;
    for (int i = 0; i < frames; ++i) {
      const ImageFrame frame = frame_at(i);
      feed_.send(frame, later);
      const std::string time = fmt::format("\"time_ns\":{},", (frame.time + later).count());
      const auto answer = health.find([&](const auto& text) { return text.data().find(time) != std::string::npos; });
      if (!answer) return nlohmann::json();
      last = nlohmann::json::parse(answer->data());
    }
    return last;
  };
  const nlohmann::json at_home = drive(40, [&](int i) { return room.frames()[static_cast<std::size_t>(i)]; }, {});
  ASSERT_FALSE(at_home.is_null()) << node.stderr_output();
  EXPECT_EQ(at_home["map"], "room");
  EXPECT_EQ(at_home["health"]["verdict"], "trusted");
  const nlohmann::json away = drive(
      recording->size(), [&](int i) { return *recording->read(i); }, std::chrono::seconds(2));
  ASSERT_FALSE(away.is_null()) << node.stderr_output();
  EXPECT_EQ(away["map"], "elsewhere");
  EXPECT_EQ(away["health"]["verdict"], "trusted");
  EXPECT_TRUE(node.has_logged("map changed to elsewhere"));
  EXPECT_TRUE(grids.find([](const auto& grid) { return grid.info().width() == 3; })) << "of the plan of that map";
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, PublishesTheOccupancyOfEachMapItLoads) {
  StoredMap stored = load_map(Room::shared().map());
  save_map(stored, folder_ / "carried.byre");
  Keyframe driven;  // without images, far from the mapped room
  const Rig& rig = stored.map.rigs()[0];
  driven.frame.features = std::make_shared<Features>(rig.width, rig.height, std::vector<Keypoint>{},
                                                     std::vector<Descriptor>{}, std::vector<Patch>{});
  driven.frame.time = stored.map.keyframe_header(stored.map.keyframe_ids().back())->frame.time;
  driven.parent = stored.map.keyframe_ids().back();
  for (int i = 0; i < 40; ++i) {
    driven.frame.time += 1000ms;
    driven.camera_from_world = inverse(Pose{Eigen::Quaterniond::Identity(), {0.5 * i, 20.0 + 1.0 * (i % 2), 0.0}});
    stored.map.add_keyframe(driven);
  }
  stored.plan = PlanRegistration{"plan.yaml", {1.0, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 10.0}}}};
  save_map(stored, folder_ / "on_plan.byre");
  const auto expected = occupancy_grid(stored.map, stored.plan);
  ASSERT_TRUE(expected);
  NodeProcess node(folder_, config("  map: on_plan.byre\n"), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  Grids grids(peer_, "rt/map", kLatched);
  const auto grid = grids.first();
  ASSERT_TRUE(grid.has_value()) << node.stderr_output();
  EXPECT_EQ(grid->header().frame_id(), "map");
  const int width = expected->plan.width, height = expected->plan.height;
  ASSERT_EQ(static_cast<int>(grid->info().width()), width);
  ASSERT_EQ(static_cast<int>(grid->info().height()), height);
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < width; ++column) {
      const std::size_t sent = static_cast<std::size_t>(row) * width + column;
      const std::size_t drawn = static_cast<std::size_t>(height - 1 - row) * width + column;
      ASSERT_EQ(static_cast<std::int8_t>(grid->data()[sent]), expected->occupancy[drawn]) << row << " " << column;
    }
  }
  const Eigen::Vector2d corner = expected->plan.point_at({-0.5, height - 0.5});
  EXPECT_NEAR(grid->info().origin().position().x(), corner.x(), 1e-6);
  EXPECT_NEAR(grid->info().origin().position().y(), corner.y(), 1e-6);

  command("load carried.byre");
  EXPECT_TRUE(grids.find([](const auto& message) { return message.data() == std::vector<std::uint8_t>{255}; }))
      << "one unknown cell";
  EXPECT_TRUE(node.has_logged("carried.byre: was not driven on a floor")) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ExecutesCommandsAndRejectsOtherFolders) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  ASSERT_TRUE(answer_to(feed_, odometry_, frames[0]));
  const auto answer = [&](const std::string& text) {
    command(text);
    const auto told = events_.find(
        [&](const auto& event) { return event.data().find("\"command\":\"" + text + "\"") != std::string::npos; });
    return told ? nlohmann::json::parse(told->data()) : nlohmann::json();
  };
  EXPECT_EQ(answer("load ../secret").at("done"), false);
  EXPECT_EQ(answer("load absent.byre").at("done"), false);
  EXPECT_EQ(answer("save").at("done"), false);
  EXPECT_EQ(answer("dance").at("done"), false);
  command("save\n<3>fake");
  EXPECT_TRUE(events_.find([](const auto& event) {
    return event.data().find(R"("command":"save\\n<3>fake")") != std::string::npos;
  })) << node.stderr_output();
  EXPECT_EQ(node.stderr_output().find("\n<3>fake"), std::string::npos) << node.stderr_output();
  command(std::string(1 << 20, 'a'));  // longer than the limit of commands
  EXPECT_EQ(answer("load room.byre").at("done"), true);
  EXPECT_EQ(node.stderr_output().find("aaa"), std::string::npos);
  EXPECT_EQ(answer("relocalise").at("done"), true);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i])) << i;
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, KeepsThePreviousMapAndUsesItIfTheMapIsDamaged) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  const fs::path map = folder_ / "room.byre";
  fs::copy_file(Room::shared().map(), map);
  const std::string extend = config("  task: extend\n  map: " + map.string() + "\n  save: " + map.string() + "\n");
  {
    NodeProcess node(folder_, extend, domain_);
    ASSERT_TRUE(is_connected()) << node.stderr_output();
    for (std::size_t i = 0; i < 10; ++i) ASSERT_TRUE(answer_to(feed_, odometry_, frames[i])) << node.stderr_output();
    command("save");
    ASSERT_TRUE(events_.find([](const auto& event) { return event.data().find("\"saved ") != std::string::npos; }));
    EXPECT_EQ(fs::file_size(folder_ / "room.previous.byre"), fs::file_size(Room::shared().map()));
    EXPECT_EQ(node.stop(), 0) << node.stderr_output();
  }
  fs::resize_file(map, fs::file_size(map) / 2);
  const auto kept = fs::file_size(folder_ / "room.previous.byre");
  odometry_.clear();
  events_.clear();
  NodeProcess node(folder_, extend, domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  EXPECT_TRUE(node.has_logged("room.byre: ")) << node.stderr_output();
  EXPECT_THAT(node.stderr_output(),
              HasSubstr("the previous map is used, " + (folder_ / "room.previous.byre").string()));
  EXPECT_TRUE(answer_to(feed_, odometry_, frames[10], std::chrono::seconds(60))) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0) << node.stderr_output();
  EXPECT_EQ(fs::file_size(folder_ / "room.previous.byre"), kept) << "a damaged map does not replace it";
}

// A mission on a map of most of the way.
class ByreNodeAtTheDock : public ByreNode {
 protected:
  ByreNodeAtTheDock() {
    const Room& room = Room::shared();
    Slam slam = Slam::mapping(read_calibration(room.calibration()), Room::options());
    for (std::size_t i = 0; i < room.frames().size() * 7 / 8; ++i) slam.process(view_of(room.frames()[i]));
    slam.finish();
    slam.save(map_);
  }

  // update: value of slam.update.
  std::string mission_with(const std::string& update, const std::string& more = {}) const {
    return config("  map: " + map_.string() + "\n  update: " + update + "\n", more);
  }

  void drive(NodeProcess& node) {
    ASSERT_TRUE(is_connected()) << node.stderr_output();
    for (const ImageFrame& frame : Room::shared().frames()) {
      ASSERT_TRUE(answer_to(feed_, odometry_, frame)) << node.stderr_output();
    }
  }

  int sessions() const {
    return static_cast<int>(std::count_if(fs::directory_iterator(folder_), {}, [](const fs::directory_entry& entry) {
      return entry.path().extension() == ".session";
    }));
  }

  const fs::path map_ = folder_ / "room.byre";
};

TEST_F(ByreNodeAtTheDock, ProposesAnUpdatedMapByTheCommand) {
  const std::uint64_t before = map_id(map_);
  NodeProcess node(folder_, mission_with("propose"), domain_);
  drive(node);
  command("update");
  const std::string answer = "\"answer\":\"proposed " + (folder_ / "room.proposed.byre").string();
  EXPECT_TRUE(events_.find([&](const auto& event) { return event.data().find(answer) != std::string::npos; }))
      << node.stderr_output();
  EXPECT_EQ(node.stop(), 0) << node.stderr_output();
  EXPECT_EQ(map_id(map_), before);
  EXPECT_NE(map_id(folder_ / "room.proposed.byre"), before);
  EXPECT_EQ(sessions(), 1) << "of one mission";
}

TEST_F(ByreNodeAtTheDock, ReplacesItsMapAtTheEndAndKeepsThePreviousOne) {
  const std::uint64_t before = map_id(map_);
  NodeProcess node(folder_, mission_with("automatic"), domain_);
  drive(node);
  EXPECT_EQ(node.stop(), 0) << node.stderr_output();
  EXPECT_THAT(node.stderr_output(), HasSubstr("updated " + map_.string()));
  EXPECT_NE(map_id(map_), before);
  EXPECT_EQ(map_id(folder_ / "room.previous.byre"), before);
  EXPECT_EQ(sessions(), 0);
}

TEST_F(ByreNodeAtTheDock, QueuesItsSessionWithoutANetwork) {
  if (!BYRE_HAS_REGISTRY) GTEST_SKIP() << "byre is built without a PostgreSQL client";
  const std::uint64_t before = map_id(map_);
  NodeProcess node(folder_, mission_with("automatic", "registry:\n  site: barn\n  database: host=/nowhere\n"), domain_);
  drive(node);
  EXPECT_TRUE(node.has_logged("registry: registry /nowhere/")) << node.stderr_output();
  command("update");
  EXPECT_TRUE(events_.find([](const auto& event) {
    return event.data().find("waits for the registry") != std::string::npos;
  })) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0) << node.stderr_output();
  EXPECT_EQ(map_id(map_), before);
  EXPECT_TRUE(fs::exists(folder_ / "room.registry" / "last.session"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "room.registry"), {}), 2);
}

TEST_F(ByreNode, RelocalisesIfAnInitialPoseContradictsItsPose) {
  const Room& room = Room::shared();
  Poses poses(peer_, "rt/byre/pose", kLatched);
  Texts health(peer_, "rt/byre/health", kVolatile);
  auto* const hint = peer_.writer("rt/initialpose",
                                  TypeSupport(new geometry_msgs::msg::PoseWithCovarianceStampedPubSubType), kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected() && FastPeer::has_subscriber(hint)) << node.stderr_output();
  geometry_msgs::msg::PoseWithCovarianceStamped message;
  const auto answer_to_hint = [&](double x, const std::string& frame = "map") {
    events_.clear();
    message.header().frame_id(frame);
    message.pose().pose().position().x(x);
    hint->write(&message);
    const auto told = events_.find(
        [](const auto& event) { return event.data().find("\"command\":\"initial pose\"") != std::string::npos; });
    return told ? told->data() : "";
  };
  EXPECT_THAT(answer_to_hint(0.0), HasSubstr("searching within 3.0 m of it for 10 s, then in the whole map"));
  EXPECT_THAT(answer_to_hint(0.0, "odom"), HasSubstr("publish it in 'map'"));
  for (std::size_t i = 0; i < 20; ++i)
    ASSERT_TRUE(answer_to(feed_, odometry_, room.frames()[i])) << node.stderr_output();
  ASSERT_TRUE(poses.first()) << node.stderr_output();
  EXPECT_THAT(answer_to_hint(0.0), HasSubstr("agrees with the current pose"));
  const auto before = odometry_.all().back();
  message.pose().pose() = poses.all().back().pose().pose();
  EXPECT_THAT(answer_to_hint(message.pose().pose().position().x() + 2.5), HasSubstr("relocalising in"));
  const auto after = answer_to(feed_, odometry_, room.frames()[20]);
  ASSERT_TRUE(after.has_value()) << node.stderr_output();
  EXPECT_LT((vector_of(after->pose().pose().position()) - vector_of(before.pose().pose().position())).norm(), 0.1)
      << "odometry does not jump";
  poses.clear();
  for (std::size_t i = 21; i < 28; ++i)
    ASSERT_TRUE(answer_to(feed_, odometry_, room.frames()[i])) << node.stderr_output();
  EXPECT_TRUE(poses.first()) << "found near the hint";
  EXPECT_THAT(answer_to_hint(50.0), HasSubstr("relocalising in"));
  poses.clear();
  for (std::size_t i = 28; i < 36; ++i) {
    feed_.send(room.frames()[i]);
    const std::string time = "\"time_ns\":" + std::to_string(room.frames()[i].time.count()) + ",";
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time) != std::string::npos; })) << i;
  }
  EXPECT_THAT(poses.all(), testing::IsEmpty()) << "search at a wrong place";
  EXPECT_EQ(node.stop(), 0);
}

double processor_seconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  long ticks = 0;
  for (int field = 1; file >> word && field <= 15; ++field) {
    if (field >= 14) ticks += std::stol(word);
  }
  return static_cast<double>(ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

TEST_F(ByreNode, ProcessesARecordingAtFullSpeed) {
  const auto folder = find_recording("euroc/MH_01_easy");
  if (!folder) GTEST_SKIP() << missing("euroc/MH_01_easy");
  constexpr int kFrames = 60;
  const auto recording = open_recording(*folder, {.last = kFrames});
  std::ofstream(folder_ / "camchain.yaml") << write_calibration(recording->calibration());
  Slam slam = Slam::mapping(read_calibration(folder_ / "camchain.yaml"), Room::options());
  NodeProcess node(folder_,
                   "slam:\n  task: map\n  workers: repeatable\n  save: made.byre\nimages:\n  reliable: true\n"
                   "  pair_wait: 1\ncalibration:\n  file: camchain.yaml\n",
                   domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  std::vector<double> milliseconds;
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = recording->read(i);
    ASSERT_TRUE(frame.has_value());
    const auto begin = std::chrono::steady_clock::now();
    const auto odometry = answer_to(feed_, odometry_, *frame);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    ASSERT_TRUE(odometry.has_value()) << "frame " << i << "\n" << node.stderr_output();
    const FrameReport expected = slam.process(view_of(*frame));
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected.odometry_from_body->translation).norm(), 1e-6) << "frame " << i;
  }
  std::ranges::sort(milliseconds);
  RecordProperty("median_ms", std::to_string(milliseconds[milliseconds.size() / 2]));
  RecordProperty("slowest_ms", std::to_string(milliseconds.back()));
  RecordProperty("processor_ms_a_frame", std::to_string(1e3 * processor_seconds(node.process()) / kFrames));
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
