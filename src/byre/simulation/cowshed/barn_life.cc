#include "byre/simulation/cowshed/barn_life.h"

#include "byre/simulation/seeded_draws.h"

#include <cassert>

namespace byre {

CowshedRecordingOptions visit_of_life(const CowshedRecordingOptions& first, int visit) {
  assert(visit >= 1);
  constexpr int kWeek = 7, kPainted = 4 * kWeek, kBuilt = 6 * kWeek;  // days
  constexpr double kLife = 60.0;                                      // days
  constexpr double kInStore = 24.0;                                   // seconds
  CowshedRecordingOptions options = first;
  CowshedOptions& barn = options.barn;
  barn.mission = visit;
  barn.keeps_places = true;
  const int day = visit - 1, weekday = day % kWeek;
  options.camera.calibration_level *= 1.0 + 0.5 * day / kLife;
  barn.time = BarnTime::day;
  barn.gate = BarnGate::closed;
  if (visit == 1) return options;
  SeededDraws draws(hash(barn.seed, static_cast<std::uint64_t>(visit), 2), 41);
  if (weekday == 1 || weekday == 4) {
    barn.gate = BarnGate::open;
    options.duration_s += kInStore;
  }
  barn.cows = 3 + draws.below(8);
  barn.painted = day >= kPainted;
  barn.has_stall = day >= kBuilt;
  options.dirt = 0.1 * weekday;
  switch (draws.below(3)) {
    case 0:
      options.night.light = draws.between(0.6f, 1.2f);
      break;
    case 1:
      barn.time = BarnTime::dusk;
      break;
    default:
      options.night = {.light = 0.05, .headlight = 1.0};
  }
  return options;
}

}  // namespace byre
