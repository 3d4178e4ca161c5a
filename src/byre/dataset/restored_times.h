#pragma once

#include "byre/recording.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Time stamps of one topic's messages, or of one list's files, in the order in which they were recorded.
struct RecordedStamps {
  std::vector<Timestamp> stamps;
  std::vector<Timestamp> received{};  // by the recorder's clock, one for each stamp; empty: unknown
  bool is_order_certain = false;      // a stamp that goes back is a wrong one, never that of a late item
};

// A step of a clock that several sensors may use.
struct SharedClockStep {
  Timestamp by{};                       // negative: set back
  std::optional<Timestamp> received{};  // when the first item after it was received
};

// The clock of one sensor, in the terms in which another one is compared with it.
struct SensorClock {
  TimeSource source = TimeSource::stamps;
  Timestamp interval{};  // usual time between two items
  std::vector<SharedClockStep> steps{};
};

struct RestoredTimes {
  std::vector<std::size_t> items;       // items that are kept, by their numbers, in the order of their times
  std::vector<Timestamp> times;         // one for each of them, strictly increasing
  std::vector<Timestamp> times_of_all;  // one for each item, also of those that are left out
  TimeCorrections corrections;          // counts all items; steps by places in `items`
  SensorClock clock;
};

// Times of items whose clock may have been set, may not have run, or has too coarse a resolution:
//   set back or forward   Later items follow the earlier ones after the usual interval, or the time between their
//                         reception. A clock set forward by more than a second is found by times of reception alone:
//                         without these it looks like a pause. A step that `other` has too, within a few intervals, or
//                         that shows in times of reception, is taken over from there, so that sensors stay in step.
//   late items            are put in order: their stamps go back for a moment and fill a gap, while the stamps after
//                         them, and the delay of reception, show that the clock goes on.
//   zero or wrong stamps  are replaced by even spacing between their neighbours.
//   coarse stamps         (most have the stamp of a neighbour, as whole seconds do) are replaced by times of reception,
//                         or, where these are unknown or coarse too, by spreading the items of a stamp evenly.
//   repeated stamps       The first item with a stamp is kept.
// Stamps that ascend are returned as they are. A single item is left where all have one stamp and none was received at
// a time of its own. other: clock of the images, where these items are of another sensor.
RestoredTimes restore_times(const RecordedStamps& recorded, const SensorClock& other = {});

// How warnings name items: "image", "message"; and the word that items are counted by: "frame".
struct ItemNames {
  std::string place;
  std::string kind;
  std::string counted;
};

// One line for each kind of correction, with counts.
std::vector<std::string> describe(const TimeCorrections& corrections, const ItemNames& names);

}  // namespace byre
