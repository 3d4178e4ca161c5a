#include "byre/viewer/web/web_map.h"

#include "byre/io/recording/folder_scene.h"
#include "byre/map/plan/floor_plan_scene.h"
#include "byre/viewer/web/web_client_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using Json = nlohmann::json;

// Barn with signs that are map points, and its plan.
class MapViewerTest : public TestFolder {
 protected:
  MapViewerTest() : signs_(scene_.correspondences(6)) {
    write_image("plan.pgm", 84, 28, 255);
    write("plan.yaml", "image: plan.pgm\nresolution: 0.5\norigin: [-1, -7, 0]\n");
    const Camera camera{CameraModel::pinhole, 320, 240, 188.0, 188.0, 158.0, 119.0, {}};
    viewed_.name = "barn.byre";
    viewed_.stored.map = map_with_signs();
    viewed_.stored.recordings = {{"barn_morning", {camera, std::nullopt, {}}, {}, std::chrono::seconds(100)}};
    viewed_.plan = read_floor_plan(folder_ / "plan.yaml");
    viewed_.output = folder_ / "barn-plan.byre";
  }

  // Each sign is the only feature of its own keyframe.
  MapGraph map_with_signs() {
    MapGraph map = scene_.driven_map(scene_.path_in_map());
    for (const PlanCorrespondence& sign : signs_) {
      Keyframe keyframe;
      keyframe.frame.time = std::chrono::seconds(map.keyframe_count());
      keyframe.frame.features = std::make_shared<const Features>(320, 240, std::vector<Keypoint>(1),
                                                                 std::vector<Descriptor>(1), std::vector<Patch>(1));
      keyframe.camera_from_world = map.find_keyframe(map.keyframe_ids().front())->camera_from_world;
      const KeyframeId seen_by = map.add_keyframe(keyframe);
      MapPoint point;
      point.position_in_world = sign.point_in_map;
      point.reference = {seen_by, 0};
      map.add_observation({seen_by, 0}, {map.add_point(point), Eigen::Vector2f(0.0f, 0.0f), 1.0f});
    }
    return map;
  }

  std::string picks(std::size_t count) const {
    Json picks = Json::array();
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d& plan = signs_[i].point_in_plan;
      picks.push_back({{"name", signs_[i].name}, {"point", i}, {"plan", {plan.x(), plan.y()}}});
    }
    return Json{{"picks", picks}}.dump();
  }

  static WebClient client_of(const MapViewer& viewer) {
    return WebClient(std::stoi(viewer.urls().back().substr(viewer.urls().back().rfind(':') + 1)));
  }

  FloorPlanScene scene_;
  std::vector<PlanCorrespondence> signs_;
  ViewedMap viewed_;
  const WebServerOptions any_port_{"127.0.0.1", 0};
};

TEST_F(MapViewerTest, ServesTheMapAndThePlan) {
  const MapViewer viewer(viewed_, any_port_);
  const WebClient client = client_of(viewer);
  const Json scene = client.get("/scene").json();
  EXPECT_EQ(scene.at("mode"), "map");
  EXPECT_EQ(scene.at("plan").at("step_right"), Json({0.5, 0.0}));
  EXPECT_TRUE(scene.at("registration").is_null());
  EXPECT_THAT(client.get("/map/offline").body, SizeIs(8 + 6 * 13 + 86 * 29));
  EXPECT_EQ(client.get("/plan.png").content_type, "image/png");
  EXPECT_EQ(client.get("/nothing").status, 404);
}

TEST_F(MapViewerTest, ServesPicturesOfKeyframesAndGreyValuesOfPoints) {
  const std::vector<std::byte> jpeg(5, std::byte{7});
  viewed_.stored.map.set_picture({Origin::offline, 2}, StoredPicture(jpeg));
  const MapViewer viewer(viewed_, any_port_);
  const WebClient client = client_of(viewer);
  const Json pictures = client.get("/scene").json().at("pictures");
  ASSERT_THAT(pictures, SizeIs(1));
  EXPECT_EQ(pictures[0].at("keyframe"), 2);
  EXPECT_EQ(pictures[0].at("recording"), "barn_morning");
  EXPECT_EQ(client.get("/pictures/2").content_type, "image/jpeg");
  EXPECT_EQ(client.get("/pictures/2").body, std::string(5, 7));
  for (const char* path : {"/pictures/", "/pictures/1", "/pictures/-2", "/pictures/2x", "/pictures/99999999999"}) {
    EXPECT_EQ(client.get(path).status, 404) << path;
  }
  EXPECT_EQ(client.get("/map/greys").body, std::string(6, 0)) << "patches of the scene are black";
}

TEST_F(MapViewerTest, RegistersTheMapOnThePlanByPicks) {
  const MapViewer viewer(viewed_, any_port_);
  const Json fit = client_of(viewer).post("/registration", picks(6)).json();
  EXPECT_LT(fit.at("rms_m"), 0.01);
  EXPECT_THAT(fit.at("residuals"), SizeIs(6));
  EXPECT_THAT(fit.at("doubts"), SizeIs(0));
  const std::vector<double> pose = fit.at("registration").at("pose");
  const Eigen::Vector3d found(pose[0], pose[1], pose[2]);
  EXPECT_LT((found - scene_.plan_from_map.target_from_source.translation).norm(), 0.01);
}

TEST_F(MapViewerTest, SuggestsPicturesAndReportsPixelsOfDifferentPlaces) {
  const MapViewer viewer(viewed_, any_port_);
  const WebClient client = client_of(viewer);
  EXPECT_THAT(client.post("/place", R"({"pixels": [[0, 0.5, 0.5]]})").json().at("views"), SizeIs(0)) << "no points";
  const auto problem = [&client](const char* pixels) {
    return client.post("/place", pixels).json().at("problem").get<std::string>();
  };
  EXPECT_THAT(problem(R"({"pixels": [[0, 0.5, 0.5], [0, 0.5, 0.5]]})"), HasSubstr("from too similar directions"));
  EXPECT_THAT(problem(R"({"pixels": [[0, 0.7, 0.4], [2, 0.9, 0.6]]})"), HasSubstr("is not the same place"));
  EXPECT_THAT(problem(R"({"pixels": [[0, 0.5]]})"), HasSubstr("have an invalid format"));
}

TEST_F(MapViewerTest, ProposesNothingWithoutWalls) {
  const MapViewer viewer(viewed_, any_port_);
  const WebClient::Answer answer = client_of(viewer).post("/proposal", "{}");
  EXPECT_EQ(answer.status, 400);
  EXPECT_THAT(answer.json().at("problem").get<std::string>(), HasSubstr("has no obstacles to match"));
}

TEST_F(MapViewerTest, SavesTheRegisteredMapAndThePicks) {
  const MapViewer viewer(viewed_, any_port_);
  const Json saved = client_of(viewer).post("/save", picks(3)).json();
  EXPECT_EQ(saved.at("written"), Json({folder_ / "barn-plan.byre", folder_ / "barn-plan.picks.csv"}));
  const StoredMap stored = load_map(folder_ / "barn-plan.byre");
  ASSERT_TRUE(stored.plan);
  EXPECT_EQ(stored.plan->plan, "plan.yaml");
  EXPECT_LT(scene_.path_error(stored.plan->plan_from_map), 0.01);
  std::ifstream csv(folder_ / "barn-plan.picks.csv");
  std::string header;
  std::getline(csv, header);
  EXPECT_EQ(header,
            "name,point,time_s,time_ns,u_px,v_px,u_end_px,v_end_px,plan_x_m,plan_y_m,plan_end_x_m,plan_end_y_m");
}

TEST_F(MapViewerTest, SavesLargeResidualsOnlyWhenConfirmed) {
  for (PlanCorrespondence& sign : signs_) sign.point_in_plan *= 1.5;  // simulates a plan with a wrong resolution
  const MapViewer viewer(viewed_, any_port_);
  const WebClient client = client_of(viewer);
  const Json fit = client.post("/registration", picks(6)).json();
  EXPECT_EQ(fit.at("is_far_off"), true);
  const double residual = fit.at("residual_m");
  EXPECT_GT(residual, 1.0);
  const WebClient::Answer refused = client.post("/save", picks(6));
  EXPECT_EQ(refused.status, 400);
  EXPECT_THAT(refused.json().at("problem").get<std::string>(), HasSubstr("have residuals of "));
  Json confirmed = Json::parse(picks(6));
  confirmed["accepted_residual_m"] = 0.9 * residual;
  EXPECT_EQ(client.post("/save", confirmed.dump()).status, 400) << "another residual was confirmed";
  EXPECT_FALSE(std::filesystem::exists(folder_ / "barn-plan.byre"));
  confirmed["accepted_residual_m"] = residual;
  EXPECT_EQ(client.post("/save", confirmed.dump()).status, 200);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "barn-plan.byre"));
}

TEST_F(MapViewerTest, ReportsWhyItCannotRegisterOrSave) {
  viewed_.output.reset();
  const MapViewer viewer(viewed_, any_port_);
  const WebClient client = client_of(viewer);
  const auto problem = [](const WebClient::Answer& answer) { return answer.json().at("problem").get<std::string>(); };
  EXPECT_EQ(client.post("/registration", picks(1)).status, 400);
  EXPECT_THAT(problem(client.post("/registration", picks(1))), HasSubstr("pick three or more distant places"));
  EXPECT_THAT(problem(client.post("/registration", "{")), HasSubstr("have an invalid format"));
  EXPECT_THAT(problem(client.post("/save", picks(3))), HasSubstr("-o FILE"));
}

}  // namespace
}  // namespace byre
