#include "byre/system/refine_map.h"

#include "byre/slam/online_copy.h"
#include "byre/system/stored_map.h"
#include "byre/workers/stopwatch.h"

#include <utility>

namespace byre {

Finishing refine_map(StoredMap& stored, const Vocabulary& vocabulary, const FinishHooks& hooks) {
  const Stopwatch watch;
  Map online = online_copy(stored.map);
  stored.map = Map(Origin::offline);  // hundreds of megabytes
  Finishing finishing;
  finishing.report = finish_map(online, index_of(online, vocabulary), {}, hooks);
  finishing.cut_short = hooks.should_stop();
  finishing.seconds = watch.seconds();
  stored.map = offline_copy(std::move(online));
  stored.pose_source = PoseSource::slam;
  finishing.faults = find_faults(stored);
  return finishing;
}

}  // namespace byre
