#pragma once

#include "byre/slam/upkeep/update_map.h"

#include <string>

namespace byre {

// Reason against replacing a map by another version; empty: none. The frames of a session are localised in both, and no
// place may be worse, see PlaceProof. A version that the map was made of needs no proof: a reviewer returns to it.
// Preconditions: those of update_map().
std::string fault_of_replacement(const MapVersion& map, const MapVersion& next, const StoredSession& session,
                                 const Vocabulary& vocabulary);

}  // namespace byre
