#include "byre/slam/frame/dirt_detector.h"

#include "byre/slam/tracking/mission_scene.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Trials of frames: equally many in each cell, with a given share of found points.
class TriedLens {
 public:
  explicit TriedLens(double found) : found_(found) {}

  void soil(std::size_t cell, double found = 0.0) { soiled_.push_back({cell, found}); }
  void wipe() { soiled_.clear(); }

  void take(int frames, DirtMask& mask) {
    for (int frame = 0; frame < frames; ++frame) {
      trials_.clear();
      for (std::size_t cell = 0; cell < ImageMask::kCells; ++cell) {
        for (int i = 0; i < 2; ++i) trials_.push_back({middle_of(cell), any_(random_) < share_in(cell)});
      }
      mask.note(trials_, rig_);
    }
  }

  Eigen::Vector2d middle_of(std::size_t cell) const {
    const int column = static_cast<int>(cell) % ImageMask::kColumns;
    const int row = static_cast<int>(cell) / ImageMask::kColumns;
    return {(column + 0.5) * rig_.width / ImageMask::kColumns, (row + 0.5) * rig_.height / ImageMask::kRows};
  }
  const Rig& rig() const { return rig_; }

 private:
  double share_in(std::size_t cell) const {
    for (const auto& [soiled, found] : soiled_) {
      if (soiled == cell) return found;
    }
    return found_;
  }

  Rig rig_ = simulated_rig();
  double found_;
  std::vector<std::pair<std::size_t, double>> soiled_;
  std::vector<DirtTrial> trials_;
  std::mt19937_64 random_{1};
  std::uniform_real_distribution<double> any_{0.0, 1.0};
};

constexpr std::size_t kCell = 37;

TEST(DirtMask, StaysEmptyOnACleanLens) {
  for (const double found : {0.2, 0.5, 0.9}) {
    DirtMask mask;
    TriedLens camera(found);
    for (int second = 0; second < 200; ++second) {
      camera.take(5, mask);
      ASSERT_FALSE(mask.hidden().any()) << found << ", second " << second;
    }
  }
}

TEST(DirtMask, KeepsACellWithFewerPointsThanTheRest) {
  DirtMask mask;
  TriedLens camera(0.5);
  camera.soil(kCell, 0.3);
  camera.take(1000, mask);
  EXPECT_FALSE(mask.hidden().any());
}

TEST(DirtMask, DetectsOnlyTheDirtyCellWithinSeconds) {
  DirtMask mask;
  TriedLens camera(0.5);
  camera.soil(kCell);
  camera.take(10, mask);
  EXPECT_FALSE(mask.hidden().any());
  camera.take(40, mask);
  EXPECT_TRUE(mask.hidden().hides(camera.middle_of(kCell), camera.rig()));
  EXPECT_DOUBLE_EQ(mask.hidden().share(), 1.0 / ImageMask::kCells);
}

TEST(DirtMask, KeepsTheCellUntilItIsClean) {
  DirtMask mask;
  TriedLens camera(0.5);
  camera.soil(kCell, 0.02);
  camera.take(50, mask);
  for (int frame = 0; frame < 500; ++frame) {
    camera.take(1, mask);
    ASSERT_TRUE(mask.hidden().is_hidden(kCell)) << frame;
  }
  camera.wipe();
  camera.take(30, mask);
  EXPECT_FALSE(mask.hidden().any());
}

TEST(DirtMask, GrowsFasterThanItBegins) {
  DirtMask mask;
  TriedLens camera(0.5);
  camera.soil(kCell);
  camera.take(60, mask);
  camera.soil(kCell + 1);
  camera.soil(kCell + 5);
  camera.take(20, mask);
  EXPECT_TRUE(mask.hidden().is_hidden(kCell + 1));
  EXPECT_FALSE(mask.hidden().is_hidden(kCell + 5));
}

TEST(DirtMask, LearnsNothingWithoutPointsInTheImage) {
  DirtMask mask;
  TriedLens(0.0).take(200, mask);
  EXPECT_FALSE(mask.hidden().any());
}

TEST(DirtMask, DetectsDirtOnHalfOfTheImage) {
  DirtMask mask;
  TriedLens camera(0.5);
  for (std::size_t cell = 0; cell < ImageMask::kCells / 2; ++cell) camera.soil(cell);
  camera.take(100, mask);
  EXPECT_DOUBLE_EQ(mask.hidden().share(), 0.5);
}

TEST(DirtMask, WeightsTrialsOfOneFrameLessThanThoseOfMany) {
  const TriedLens camera(0.5);
  std::vector<DirtTrial> trials;  // an object that briefly hides a cell with many points
  for (int i = 0; i < 100; ++i) trials.push_back({camera.middle_of(kCell), false});
  for (int i = 0; i < 200; ++i) trials.push_back({camera.middle_of(kCell + 2), i % 2 == 0});
  DirtMask mask;
  for (int frame = 0; frame < 3; ++frame) mask.note(trials, camera.rig());
  EXPECT_FALSE(mask.hidden().any());
}

}  // namespace
}  // namespace byre
