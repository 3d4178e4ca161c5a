#pragma once

#include "byre/simulation/cowshed/cowshed_recording.h"

namespace byre {

// A day in the life of a barn: visit 1 is the mapping run, by day with the gate closed; a later one is a mission of the
// day after the one before. Feed changes at each visit; things that are moved stay until they are moved again, tools
// more often than the rest; on two days of the week the gate is open and the drive 24 s longer; a third each is by day,
// at dusk, and by night with the headlight. Dirt grows until it is wiped off at the end of the week. The eastern gable
// is painted in week five, a stall is built in week seven. The calibration error grows by half in sixty days. first:
// options of visit 1, whose share of change and calibration error the others follow.
CowshedRecordingOptions visit_of_life(const CowshedRecordingOptions& first, int visit);

}  // namespace byre
