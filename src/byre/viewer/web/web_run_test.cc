#include "byre/viewer/web/web_run.h"

#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/viewer/web/web_client_scene.h"

#include <cstring>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Json = nlohmann::json;

constexpr int kFrames = 6;

std::uint32_t number_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

// Short run shown to a connected page.
class RunViewerTest : public testing::Test {
 protected:
  RunViewerTest()
      : calibration_(euroc_like_calibration(4)),
        mission_(simulate_mission(simulated_rig(robot_from_camera()),
                                  circling_trajectory(kFrames, 15.0, 2.0, 0.05, robot_from_camera()), {})),
        session_(mission_.rig, {}, make_inline_executor()) {}

  RunViewer view() {
    RunDescription description;
    description.name = "evening \"round\"";
    description.calibration = calibration_;
    description.frames = kFrames;
    description.last_time = mission_.frames.back().time;
    description.map_name = "barn.byre";
    description.offline.points = {{{1.0f, 2.0f, 3.0f}, Origin::offline}};
    RunViewerOptions options;
    options.server.port = 0;
    return {std::move(description), options};
  }

  void show_all(RunViewer& viewer) {
    const Camera& camera = calibration_.left;
    const Image grey{camera.width, camera.height,
                     std::vector<std::uint8_t>(static_cast<std::size_t>(camera.width * camera.height), 128)};
    for (const Frame& frame : mission_.frames) viewer.show(grey, session_.process(frame), session_);
    viewer.end_run();
  }

  static int port_of(const RunViewer& viewer) {
    return std::stoi(viewer.urls().back().substr(viewer.urls().back().rfind(':') + 1));
  }

  Calibration calibration_;
  SimulatedMission mission_;
  Session session_;
};

// Messages up to the end of the run.
struct Received {
  Json frames = Json::array();
  std::string last_image;
  bool has_map = false;
};

Received receive_until_end(LiveClient& client) {
  Received received;
  for (;;) {
    const LiveClient::Message message = client.next();
    if (message.is_binary) {
      received.last_image = message.bytes;
      continue;
    }
    const Json fields = message.json();
    if (fields.contains("frames"))
      received.frames.insert(received.frames.end(), fields["frames"].begin(), fields["frames"].end());
    received.has_map = received.has_map || fields.contains("online_map");
    if (fields.contains("ended")) return received;
  }
}

TEST_F(RunViewerTest, SendsEveryFrameTheNewestImageAndTheMap) {
  RunViewer viewer = view();
  LiveClient client(port_of(viewer));
  show_all(viewer);
  const Received received = receive_until_end(client);
  ASSERT_THAT(received.frames, SizeIs(kFrames));
  EXPECT_EQ(received.frames.back().at("state"), "tracking");
  EXPECT_THAT(received.frames.back().at("pose"), SizeIs(7));
  EXPECT_THAT(received.frames.front().at("events"), Contains(Json(to_string(SessionEvent::initialised))));
  EXPECT_GT(received.frames.back().at("online_points"), 100);
  EXPECT_TRUE(received.has_map);
  EXPECT_EQ(number_at(received.last_image, 0), static_cast<std::uint32_t>(kFrames - 1));
}

TEST_F(RunViewerTest, SendsTheWholeRunToALatePage) {
  RunViewer viewer = view();
  show_all(viewer);
  LiveClient late(port_of(viewer));
  EXPECT_THAT(receive_until_end(late).frames, SizeIs(kFrames));
}

TEST_F(RunViewerTest, SendsImagesAsRectifiedJpegWithTheirPoints) {
  RunViewer viewer = view();
  LiveClient client(port_of(viewer));
  show_all(viewer);
  receive_until_end(client);
  const std::string bytes = WebClient(port_of(viewer)).get("/images/99").body;
  const std::size_t seen = number_at(bytes, 4);
  EXPECT_EQ(seen, session_.seen_points().size());
  const std::vector<unsigned char> jpeg(bytes.begin() + static_cast<std::ptrdiff_t>(8 + 9 * seen), bytes.end());
  const cv::Mat image = cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE);
  const Json camera = WebClient(port_of(viewer)).get("/scene").json().at("camera");
  EXPECT_EQ(image.cols, camera.at("width"));
  EXPECT_EQ(image.rows, camera.at("height"));
  EXPECT_NEAR(image.at<std::uint8_t>(image.rows / 2, image.cols / 2), 128, 2);
}

TEST_F(RunViewerTest, ServesThePageTheSceneAndTheMaps) {
  RunViewer viewer = view();
  LiveClient client(port_of(viewer));
  show_all(viewer);
  receive_until_end(client);
  const WebClient web(port_of(viewer));
  EXPECT_THAT(web.get("/").body, StartsWith("<!doctype html>"));
  EXPECT_EQ(web.get("/scene").json().at("name"), "evening \"round\"");
  EXPECT_EQ(number_at(web.get("/map/offline").body, 0), 1u);
  EXPECT_EQ(number_at(web.get("/map/online").body, 0),
            static_cast<std::uint32_t>(session_.map().online().point_count()));
  for (const char* path : {"/images/", "/images/-1", "/images/x", "/plan.png", "/../etc/passwd", "/save"}) {
    EXPECT_EQ(web.get(path).status, 404) << path;
  }
}

}  // namespace
}  // namespace byre
