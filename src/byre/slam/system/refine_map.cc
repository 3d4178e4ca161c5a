#include "byre/slam/system/refine_map.h"

#include "byre/base/stopwatch.h"
#include "byre/slam/system/resources.h"
#include "byre/slam/window/online_copy.h"
#include "byre/slam/window/paged_features.h"

#include <utility>

namespace byre {

FinishResult refine_map(StoredMap& stored, const Vocabulary& vocabulary, const FinishHooks& hooks,
                        const FinishOptions& options) {
  const Stopwatch watch;
  MapGraph online = online_copy(stored.map);
  stored.map = MapGraph(Origin::offline);  // frees hundreds of megabytes
  ScratchFile page_file;
  page_out_features(online, page_file);
  FinishResult finishing;
  // Memory freed by reading and by each step does not fit the allocations of the next step.
  const FinishHooks frugal{releasing_pages(page_file, hooks.should_stop), [&hooks](const char* step) {
                             release_free_memory();
                             if (hooks.before_step) hooks.before_step(step);
                           }};
  finishing.report = finish_map(online, index_of(online, vocabulary), options, frugal);
  finishing.cut_short = hooks.should_stop();
  finishing.seconds = watch.seconds();
  stored.map = offline_copy(std::move(online));
  stored.pose_source = PoseSource::slam;
  finishing.faults = find_faults(stored);
  return finishing;
}

}  // namespace byre
