#pragma once

#include "byre/body_motion.h"
#include "byre/slam/window.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

// The body's motion between two moments in the map's lengths, as wheels and a gyroscope tell it; empty where they do
// not.
using TellMotion = std::function<std::optional<BodyMotion>(Timestamp earlier, Timestamp later)>;

// How far the body can be from where it was, in the map's lengths, by what its wheels turned; empty where that is not
// known.
using TellReach = std::function<std::optional<double>(Timestamp earlier, Timestamp later)>;

// Between two keyframes of the online map that follow each other.
struct KeyframeMotion {
  KeyframeId earlier;
  KeyframeId later;
  BodyMotion motion;
  bool is_unseen = false;  // the two share hardly any points, so that nothing else tells of the way between them
};

// What is told of the ways between these keyframes, of those that one recording brought: from each to the next. A
// motion that contradicts what was seen is left out, as where a wheel spins; and that of a pair of cameras that saw the
// way: it knows metres by itself, and what wheels add there is not more than they err.
std::vector<KeyframeMotion> told_motions(const Map& online, std::vector<KeyframeId> keyframes, int recording,
                                         const TellMotion& tell);

// The same in the lengths that the map has where many are told: wheels that are all too large are to bend nothing.
std::vector<KeyframeMotion> in_lengths_of(const Map& online, std::vector<KeyframeMotion> motions);

// Gives the window those motions both of whose keyframes it has.
void add_motions(MapWindow& window, const std::vector<KeyframeMotion>& motions);

}  // namespace byre
