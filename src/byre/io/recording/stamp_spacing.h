#pragma once

#include "byre/trajectory.h"

#include <vector>

namespace byre {

// Multiple of an interval, rounded to a nanosecond.
Timestamp multiple(double factor, Timestamp interval);

// Median of the positive differences between consecutive stamps; zero without any.
Timestamp typical_interval(const std::vector<Timestamp>& stamps);

// Whether the resolution of the stamps is coarser than their interval: most items have the stamp of a neighbour.
bool is_coarse(const std::vector<Timestamp>& stamps);

// Whether at most a third of the items have the stamp of the item before.
bool are_mostly_distinct(const std::vector<Timestamp>& stamps);

// Whether items of one stamp are received together, because a sender repeats them. Items of a coarse stamp are received
// at the usual rate. False if the numbers of stamps and of receive times differ.
bool are_all_repeated(const std::vector<Timestamp>& stamps, const std::vector<Timestamp>& received);

// Spreads the items of each stamp evenly until the next stamp. The first and the last run may be incomplete.
std::vector<Timestamp> spread_evenly(const std::vector<Timestamp>& stamps);

// Spaces unknown times evenly between known ones; at the usual interval before the first and after the last of them.
void interpolate_gaps(std::vector<Timestamp>& times, const std::vector<bool>& has_time, Timestamp interval);

}  // namespace byre
