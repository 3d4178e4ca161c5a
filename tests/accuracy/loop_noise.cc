// Searches loops in a saved map as mapping does, with disturbed place recognition, and compares each with the truth.
// Usage: byre_loop_noise MAP TRUTH [SEEDS]
// MAP was made with "byre map --no-loops -o MAP"; TRUTH is the trajectory of its recording, or the recording itself.
// Seed 0 is undisturbed; with the others candidates come in random order and 30 % of them are missing.
// Exit code: 0 no false loop, 1 some, 2 wrong usage.

#include "mapped_recording.h"

#include "byre/io/recording/trajectory_input.h"
#include "byre/map/map_file.h"
#include "byre/place/map_words.h"
#include "byre/slam/loops/finishing.h"
#include "byre/slam/window/online_copy.h"
#include "byre/trajectory_file.h"

#include <cstdio>
#include <cstdlib>

namespace byre {
namespace {

// Largest error of a loop's relative pose; a larger one makes it false.
constexpr double kMaxShift = 0.2;  // metres
constexpr double kMaxTurn = 0.05;  // radians

std::optional<Pose> true_camera_from_world(const Map& map, KeyframeId id, const Trajectory& truth) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  const auto world_from_body = pose_at(truth, keyframe.frame.time, std::chrono::milliseconds(60));
  if (!world_from_body) return std::nullopt;
  return inverse(*world_from_body * map.rigs()[static_cast<std::size_t>(keyframe.rig)].body_from_camera);
}

// Error of a loop's relative pose between its keyframes.
std::optional<Pose> error_of(const LoopEdge& loop, const Map& map, const Trajectory& truth) {
  const auto keyframe = true_camera_from_world(map, loop.keyframe, truth);
  const auto place = true_camera_from_world(map, loop.place, truth);
  if (!keyframe || !place) return std::nullopt;
  return loop.keyframe_from_place * inverse(*keyframe * inverse(*place));
}

int count_false_loops(const Map& map, const PlaceIndex& places, const Trajectory& truth, std::uint64_t seed) {
  FinishOptions options;
  options.noise = {0.3, seed};
  int loops = 0, wrong = 0;
  double worst = 0.0;
  for (const LoopHypothesis& loop : search_loops(map, places, options, {})) {
    const std::optional<LoopEdge> edge = edge_of(loop, map);
    const std::optional<Pose> error = edge ? error_of(*edge, map, truth) : std::nullopt;
    if (!error) continue;
    ++loops;
    wrong += error->translation.norm() > kMaxShift || rotation_log(error->rotation).norm() > kMaxTurn;
    worst = std::max(worst, error->translation.norm());
  }
  std::printf("seed %llu: %d loops, %d false, largest error %.3f m\n", static_cast<unsigned long long>(seed), loops,
              wrong, worst);
  return wrong;
}

int run(const char* map_file, const char* truth_file, int seeds) {
  StoredMap stored = load_map(map_file);
  const Vocabulary vocabulary = Vocabulary::load(default_vocabulary_path());
  add_words(stored, vocabulary);
  const Map map = online_copy(stored.map);
  const PlaceIndex places = index_of(map, vocabulary);
  const std::filesystem::path path(truth_file);
  const Trajectory truth = load_truth(path);
  int wrong = 0;
  for (int seed = 0; seed <= seeds; ++seed) {
    wrong += count_false_loops(map, places, truth, static_cast<std::uint64_t>(seed));
  }
  return wrong == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: byre_loop_noise MAP TRUTH [SEEDS]\n");
    return 2;
  }
  return byre::run(argv[1], argv[2], argc == 4 ? std::atoi(argv[3]) : 5);
}
