#include "byre/map/plan/path_cells.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(PathCells, FindAllNearbyPositions) {
  constexpr double kReach = 2.0;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> anywhere(-10.0, 10.0);
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < 2000; ++i) places.emplace_back(anywhere(random), anywhere(random), 0.3 * anywhere(random));
  const PathCells cells(places, kReach);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d place(anywhere(random), anywhere(random), 0.3 * anywhere(random));
    const std::vector<std::uint32_t> near = cells.near(place);
    EXPECT_TRUE(std::ranges::is_sorted(near));
    EXPECT_LT(near.size(), places.size() / 4);
    for (std::uint32_t other = 0; other < places.size(); ++other) {
      if ((places[other] - place).norm() <= kReach) {
        EXPECT_THAT(near, Contains(other));
      }
    }
  }
}

TEST(PathCells, FindPositionsOnTheEdgeOfACell) {
  const PathCells cells({{0.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {1.0, 1.0, 1.0}}, 1.0);
  EXPECT_THAT(cells.near({0.0, 0.0, 0.0}), ElementsAre(0u, 1u, 2u));
  EXPECT_THAT(cells.near({-1.0, 0.0, 0.0}), ElementsAre(0u, 1u));
}

TEST(PathCells, FindNothingFarAway) {
  const PathCells cells({{0.0, 0.0, 0.0}}, 1.0);
  EXPECT_THAT(cells.near({0.0, 5.0, 0.0}), IsEmpty());
  EXPECT_THAT(cells.near({1e300, 0.0, 0.0}), IsEmpty());
  EXPECT_THAT(cells.near({std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}), IsEmpty());
  EXPECT_THAT(PathCells({}, 1.0).near({0.0, 0.0, 0.0}), IsEmpty());
}

}  // namespace
}  // namespace byre
