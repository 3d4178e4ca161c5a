#pragma once

#include "byre/slam/hybrid_tracking.h"
#include "byre/slam/registration.h"

#include <optional>

namespace byre {

// How far a pose found from nothing may be relied on. It is believed once the frames that follow have been tracked on
// it; the more of them, the less the robot can have come there by itself. It is trusted once enough frames have seen
// much of what should be there, all over the image: a thing that was moved, or a roof that is the same in each bay,
// fits a pose of its own. The more, where it was looked for near a hint alone, for a hint may name a place that looks
// alike.
struct Confirmation {
  int frames_to_believe = 0;
  int frames_to_prove = 0;
  bool is_by_hint = false;  // nobody looked for it elsewhere yet

  bool is_believed() const { return frames_to_believe == 0; }
  bool is_proven() const { return frames_to_prove == 0; }
  bool operator==(const Confirmation&) const = default;
};

// A pose found from nothing, against the poses before.
struct FindEvidence {
  std::optional<double> seconds_since_believed;  // since the last believed pose; empty: there was none
  std::optional<double> seconds_since_proven;    // since the last one beyond doubt
  double shift = 0.0;                            // metres from the last pose
  bool is_by_hint = false;                       // it was looked for near a hint alone
};

// What a find needs:
//   find                                        frames to believe      frames to prove
//   the first                                   confirmations          confirmations
//   farther off than the robot can have moved   kConfirmationsOfJump   confirmations
//   nearer, not long after a proven pose        confirmations          none
//   nearer                                      confirmations          confirmations
Confirmation confirmation_of(const FindEvidence& find, const RegistrationOptions& options);

// After one more frame was tracked on the pose, which saw so many points of the offline map. A frame that saw too few
// to prove takes back what one before it proved: among many frames, some see enough in a wrong place by chance.
Confirmation confirmed_further(const Confirmation& before, const ByImageRegion<PointsInView>& offline,
                               const RegistrationOptions& options);

}  // namespace byre
