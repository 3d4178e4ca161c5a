#include "byre/simulation/cowshed/cowshed.h"

#include "byre/features/tag_detector.h"
#include "byre/input_error.h"
#include "byre/simulation/cowshed/cowshed_parts.h"
#include "byre/simulation/cowshed/feeding_robot.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector2f;
using ::testing::SizeIs;

int moved_objects(const Cowshed& first, const Cowshed& second) {
  int moved = 0;
  for (std::size_t i = 0; i < first.objects.size(); ++i) {
    moved += first.objects[i].position != second.objects[i].position ? 1 : 0;
  }
  return moved;
}

TEST(Cowshed, IsDeterministicForSeedAndMission) {
  const Cowshed first = build_cowshed({.seed = 3, .mission = 2});
  const Cowshed second = build_cowshed({.seed = 3, .mission = 2});
  EXPECT_EQ(first.still.vertices, second.still.vertices);
  EXPECT_NE(first.still.vertices, build_cowshed({.seed = 4, .mission = 2}).still.vertices);
}

TEST(Cowshed, ChangesOnlyTheGivenShareOfItsObjects) {
  const Cowshed first = build_cowshed({.mission = 1, .change = 0.5});
  ASSERT_FALSE(first.objects.empty());
  const int all = static_cast<int>(first.objects.size());
  EXPECT_EQ(moved_objects(first, build_cowshed({.mission = 2, .change = 0.0})), 0);
  EXPECT_EQ(moved_objects(first, build_cowshed({.mission = 2, .change = 0.25})), all / 4);
  EXPECT_EQ(moved_objects(first, build_cowshed({.mission = 3, .change = 1.0})), all);
  EXPECT_EQ(moved_objects(first, build_cowshed({.mission = 1, .change = 1.0})), 0);
}

TEST(Cowshed, HangsTagsWithoutChangingAnythingElse) {
  if (!can_detect_tags()) GTEST_SKIP() << "built without libapriltag";
  const Cowshed bare = build_cowshed({.mission = 2});
  const Cowshed tagged = build_cowshed({.mission = 2, .tags = 4, .first_tag = 7});
  EXPECT_THAT(bare.tags, SizeIs(0));
  ASSERT_THAT(tagged.tags, SizeIs(4));
  EXPECT_EQ(tagged.tags[3].id, (TagId{TagFamily::tag36h11, 10}));
  EXPECT_GT(tagged.still.vertices.size(), bare.still.vertices.size());
  EXPECT_EQ(moved_objects(bare, tagged), 0);
}

TEST(Cowshed, ChangesOtherObjectsInOtherMissions) {
  EXPECT_GT(moved_objects(build_cowshed({.mission = 2}), build_cowshed({.mission = 3})), 0);
}

TEST(Cowshed, KeepsThePathOfTheRobotFree) {
  constexpr float kFarthestLane = 1.25f;  // metres from the centre line of the alley, over all missions
  constexpr float kRobot = 0.35f;         // half of the robot's width, metres
  constexpr float kObject = 0.3f;         // half of a usual object's width, metres
  for (const int mission : {1, 2, 3}) {
    for (const MovableObject& object : build_cowshed({.mission = mission, .change = 1.0}).objects) {
      const bool is_in_alley = std::abs(object.position.y()) < kCowshedSize.alley_half_width;
      const bool is_beyond_turns = object.position.x() < 2.0f;
      if (!is_in_alley || is_beyond_turns) continue;
      EXPECT_GT(std::abs(object.position.y()), kFarthestLane + kRobot + kObject)
          << "object at " << object.position.transpose();
    }
  }
}

TEST(Cowshed, HasFootprintsThatContainItsObjects) {
  constexpr float kMargin = 4e-3f;  // metres; a bucket is a polygon, whose box depends on its yaw
  for (const MovableObject& object : build_cowshed({.mission = 1}).objects) {
    const std::array<Vector2f, 4> corners = footprint_of(object);
    QuadMesh mesh;
    add_object(mesh, object);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2f side = (corners[(i + 1) % corners.size()] - corners[i]).normalized();
      const Vector2f inwards(-side.y(), side.x());
      float nearest = 1.0f;
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        nearest = std::min(nearest, inwards.dot(vertex.head<2>() - corners[i]));
      }
      EXPECT_NEAR(nearest, 0.0f, kMargin) << "side " << i << " of kind " << static_cast<int>(object.kind);
    }
  }
}

TEST(Cowshed, HasLampsAndLittleDaylightAtDusk) {
  const Cowshed day = build_cowshed({.mission = 1});
  const Cowshed dusk = build_cowshed({.mission = 2});
  EXPECT_THAT(day.light.lamps, SizeIs(0));
  EXPECT_FALSE(dusk.light.lamps.empty());
  ASSERT_EQ(day.light.windows.size(), dusk.light.windows.size());
  EXPECT_LT(dusk.light.windows.front().radiance, 0.1f * day.light.windows.front().radiance);
  EXPECT_TRUE(build_cowshed({.mission = 2, .time = BarnTime::day}).light.lamps.empty());
}

TEST(Cowshed, HasAClosedGateOnTheFirstVisitOnly) {
  EXPECT_EQ(gate_of({.mission = 1}), BarnGate::closed);
  EXPECT_EQ(gate_of({.mission = 2}), BarnGate::open);
  EXPECT_EQ(gate_of({.mission = 3}), BarnGate::open);
  EXPECT_EQ(gate_of({.mission = 2, .gate = BarnGate::closed}), BarnGate::closed);
}

TEST(Cowshed, HasGablesThatFaceInwards) {
  const QuadMesh mesh = build_cowshed({}).still;
  const auto inward_at = [&](float x, float inward) {
    int facing = 0;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Eigen::Vector3f& vertex = mesh.vertices[i];
      const bool is_wall = vertex.z() > 1.7f && vertex.z() < kCowshedSize.gate_height;  // above fences, below beams
      const bool is_of_gable = vertex.x() == x && is_wall && std::abs(mesh.normals[i].x()) > 0.9f;
      facing += is_of_gable && mesh.normals[i].x() * inward > 0.0f ? 1 : 0;
    }
    return facing;
  };
  for (const auto& [x, inward] : {std::pair(0.0f, 1.0f), {kCowshedSize.length, -1.0f}}) {
    EXPECT_GT(inward_at(x, inward), 50);
    EXPECT_EQ(inward_at(x, -inward), 0);
  }
}

TEST(Cowshed, HasWindowsThatShineInwards) {
  for (const WindowLight& window : build_cowshed({}).light.windows) {
    const Eigen::Vector3f inside(window.centre.x(), 0.0f, 1.0f);
    EXPECT_GT(window.normal.dot(inside - window.centre), 0.0f);
  }
}

TEST(Cowshed, HasUniqueNamesOfMarks) {
  std::vector<std::string> names;
  for (const NamedPoint& mark : build_cowshed({}).marks) names.push_back(mark.name);
  EXPECT_GE(names.size(), 8u);
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

TEST(Cowshed, RejectsInvalidOptions) {
  EXPECT_THROW(build_cowshed({.mission = 0}), InputError);
  EXPECT_THROW(build_cowshed({.change = 1.5}), InputError);
  EXPECT_THROW(build_cowshed({.cows = -1}), InputError);
  EXPECT_THROW(build_cowshed({.dust = -0.1}), InputError);
}

Vector2f middle_of(const QuadMesh& mesh) {
  Vector2f sum = Vector2f::Zero();
  for (const Eigen::Vector3f& vertex : mesh.vertices) sum += vertex.head<2>();
  return sum / static_cast<float>(mesh.vertices.size());
}

TEST(Cows, WalkAtTheirSpeedBehindTheFence) {
  for (const Cow& cow : build_cowshed({.cows = 8}).cows) {
    if (!cow.walks) continue;
    for (float time_s = 0.0f; time_s < 120.0f; time_s += 0.5f) {
      const Vector2f here = middle_of(cows_at({cow}, time_s));
      const Vector2f next = middle_of(cows_at({cow}, time_s + 0.1));
      EXPECT_LT((next - here).norm() / 0.1f, 2.5f * cow.speed + 0.1f) << time_s;
      EXPECT_GT(std::abs(here.y()), kCowshedSize.alley_half_width + 0.5f);
      EXPECT_GT(here.x(), 0.0f);
      EXPECT_LT(here.x(), kCowshedSize.length);
    }
    EXPECT_GT((middle_of(cows_at({cow}, 3.0)) - middle_of(cows_at({cow}, 0.0))).norm(), 0.1f);
  }
}

TEST(Cows, StandAtTheFeedAndMoveTheirHeads) {
  const std::vector<Cow> cows = build_cowshed({.cows = 2}).cows;
  ASSERT_FALSE(cows[1].walks);
  const QuadMesh before = cows_at({cows[1]}, 1.0);
  const QuadMesh after = cows_at({cows[1]}, 2.0);
  EXPECT_EQ(before.vertices.front(), after.vertices.front());  // body
  EXPECT_NE(before.vertices, after.vertices);
}

TEST(BarnTextures, DependOnTheSeedButNotOnTheNumberOfThreads) {
  const BarnTextures one = draw_barn_textures(1, 1);
  const BarnTextures many = draw_barn_textures(1, 4);
  const BarnTextures other = draw_barn_textures(2, 4);
  const Vector2f place(0.31f, 0.62f);
  const float width = 1.0f / 1024.0f;
  int different = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].sample(place, width), many[i].sample(place, width));
    different += one[i].sample(place, width) != other[i].sample(place, width) ? 1 : 0;
  }
  EXPECT_GT(different, kBarnTextures / 2);
}

}  // namespace
}  // namespace byre
