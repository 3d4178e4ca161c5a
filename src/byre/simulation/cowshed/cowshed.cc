#include "byre/simulation/cowshed/cowshed.h"

#include "byre/features/tag_detector.h"
#include "byre/input_error.h"
#include "byre/simulation/cowshed/cowshed_parts.h"

namespace byre {
namespace {

void check(const CowshedOptions& options) {
  const auto require = [](bool holds, const char* reason) {
    if (!holds) throw InputError("simulated cowshed", reason);
  };
  require(options.mission >= 1, "the mission number must be at least 1");
  require(options.change >= 0.0 && options.change <= 1.0, "the share of change must be from 0 to 1");
  require(options.dust >= 0.0 && options.dust <= 4.0, "dust must be from 0 to 4");
  require(options.tags >= 0 && options.tags <= 12, "the number of tags must be from 0 to 12");
  require(options.first_tag >= 0 && options.first_tag <= 500, "the number of the first tag must be from 0 to 500");
  require(options.tags == 0 || can_detect_tags(), "has no tags, as byre was built without libapriltag");
  require(options.cows.value_or(0) >= 0 && options.cows.value_or(0) <= 40, "the number of cows must be from 0 to 40");
}

}  // namespace

BarnTime time_of(const CowshedOptions& options) {
  return options.time.value_or(options.mission % 2 == 0 ? BarnTime::dusk : BarnTime::day);
}

BarnGate gate_of(const CowshedOptions& options) {
  return options.gate.value_or(options.mission == 1 ? BarnGate::closed : BarnGate::open);
}

Cowshed build_cowshed(const CowshedOptions& options) {
  check(options);
  const BarnTime time = time_of(options);
  Cowshed barn;
  barn.light.ambient = time == BarnTime::day ? 0.35f : 0.045f;
  barn.air = {0.05f * static_cast<float>(options.dust), time == BarnTime::day ? 0.35f : 0.06f};
  add_shell(barn, options);
  add_gates(barn, gate_of(options));
  add_store(barn, time, options.seed);
  add_frame(barn, options.seed);
  add_fences(barn, options.seed);
  add_cubicles(barn, options.seed);
  if (options.has_stall) add_stall(barn, options.seed);
  add_fittings(barn, options.seed);
  add_tags(barn, options);
  add_lamps(barn, time);
  add_feed(barn, options);
  barn.objects = make_objects(options);
  for (const MovableObject& object : barn.objects) add_object(barn.still, object);
  barn.cows = cows_of(options, options.cows.value_or(options.mission == 1 ? 3 : 8));
  return barn;
}

}  // namespace byre
