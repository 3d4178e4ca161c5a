#include "byre/slam/upkeep/replacement.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace byre {

std::string fault_of_replacement(const MapVersion& map, const MapVersion& next, const StoredSession& session,
                                 const Vocabulary& vocabulary) {
  std::vector<std::uint64_t> versions = {map.id};
  for (const MapHistory& entry : history_of(map.stored)) versions.push_back(entry.parent);
  if (std::ranges::count(versions, next.id) > 0) return "";
  std::string fault = fault_of(session, map.stored, versions);
  const std::vector<ReplayFrame> frames = frames_to_replay(session.stored.map);
  std::vector<Replayed> before;
  if (fault.empty()) {
    before = replay(frames, map.stored.map, index_of(map.stored.map, vocabulary));
    fault = place_of(frames, before, map.stored.map).fault;
  }
  if (!fault.empty()) return "it is not proved, as session " + session.name + " " + fault;
  const std::vector<PlaceProof> places =
      compare_places(frames, before, replay(frames, next.stored.map, index_of(next.stored.map, vocabulary)));
  const auto worse = std::ranges::count_if(places, [](const PlaceProof& place) { return !place.fault.empty(); });
  return worse == 0 ? "" : fmt::format("{} of {} places would be worse than before", worse, places.size());
}

}  // namespace byre
