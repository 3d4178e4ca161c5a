#pragma once

#include "byre/recording.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Time stamps of the messages of a topic, or of the files of a list, in the order of recording.
struct RecordedStamps {
  std::vector<Timestamp> stamps;
  std::vector<Timestamp> received{};  // receive times by the recorder's clock, one per stamp; empty: unknown
  bool is_order_certain = false;      // a stamp out of order is wrong, never that of a late item
};

// Step of a clock that several sensors may share.
struct SharedClockStep {
  Timestamp by{};                       // negative: set back
  std::optional<Timestamp> received{};  // receive time of the first item after the step
};

// The clock of one sensor, for comparison with that of another.
struct SensorClock {
  TimeSource source = TimeSource::stamps;
  Timestamp interval{};  // median time between two items
  std::vector<SharedClockStep> steps{};
};

struct RestoredTimes {
  std::vector<std::size_t> items;       // indices of the items that are kept, in order of time
  std::vector<Timestamp> times;         // times of these, strictly increasing
  std::vector<Timestamp> times_of_all;  // times of all items, including those that are left out
  TimeCorrections corrections;          // counts all items; steps by index into `items`
  SensorClock clock;
};

// Corrects the times of items whose clock was set, did not run, or has a coarse resolution:
//   clock steps           Later items follow the earlier ones after the usual interval, or after the time between their
//                         receive times. A clock set forward, by more than a second, is detected by receive times only;
//                         without these it looks like a pause. A step of `other` with about the same size and receive
//                         time, or one that shows in reception delays, is adopted, so that sensors stay in step.
//   late items            Their stamps go back for a moment and fill a gap, while later stamps and the reception delay
//                         continue. They are put in order.
//   zero or wrong stamps  They are replaced by even spacing between their neighbours.
//   coarse stamps         Most items have the stamp of a neighbour, as with whole seconds. They are replaced by receive
//                         times. If these are unknown or coarse too, the items of a stamp are spread evenly.
//   repeated stamps       The first item with a stamp is kept.
// Ascending stamps are returned unchanged. If all items have one stamp and receive times are unusable, one item is
// kept. other: clock of the images, if the items are of another sensor.
RestoredTimes restore_times(const RecordedStamps& recorded, const SensorClock& other = {});

// Words of warnings: the place, the kind of item ("image", "message"), and the word for its number ("frame").
struct ItemNames {
  std::string place;
  std::string kind;
  std::string counted;
};

// Warnings, one line per kind of correction, with counts.
std::vector<std::string> describe(const TimeCorrections& corrections, const ItemNames& names);

}  // namespace byre
