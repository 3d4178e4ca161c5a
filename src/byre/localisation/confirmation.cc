#include "byre/localisation/confirmation.h"

#include <algorithm>

namespace byre {
namespace {

// Whether most regions of the image where much should be seen show some of it.
bool is_seen_all_over(const ByImageRegion<PointsInView>& regions, double least_share) {
  constexpr int kMuch = 20;      // points
  constexpr int kSome = 2;       // points
  constexpr double kMost = 0.6;  // share of such regions
  int telling = 0, agreeing = 0;
  for (const PointsInView& region : regions) {
    if (region.expected < kMuch) continue;
    ++telling;
    if (region.seen >= std::max<double>(kSome, least_share * region.expected)) ++agreeing;
  }
  return agreeing >= kMost * telling;
}

bool is_proof(const Confirmation& before, const ByImageRegion<PointsInView>& regions,
              const RegistrationOptions& options) {
  constexpr double kProofOfHint = 2.0;    // times the share that proves other finds
  constexpr double kShareOfRegion = 0.5;  // least share in single regions, over the share that proves
  PointsInView all;
  for (const PointsInView& region : regions) {
    all.expected += region.expected;
    all.seen += region.seen;
  }
  const double proving_share = options.proving_share * (before.is_by_hint ? kProofOfHint : 1.0);
  return all.seen > 0 && all.seen >= proving_share * all.expected &&
         is_seen_all_over(regions, kShareOfRegion * options.proving_share);
}

}  // namespace

Confirmation confirmation_of(const FindEvidence& find, const RegistrationOptions& options) {
  constexpr double kSlack = 0.5;  // metres: what poses may err by
  Confirmation needed{options.confirmations, options.confirmations, find.is_by_hint};
  if (!find.seconds_since_believed) return needed;
  if (find.shift > kSlack + options.max_speed * *find.seconds_since_believed) {
    needed.frames_to_believe = kConfirmationsOfJump;
  } else if (find.seconds_since_proven && *find.seconds_since_proven <= kWithoutProof) {
    needed.frames_to_prove = 0;
    needed.is_by_hint = false;
  }
  return needed;
}

Confirmation confirmed_further(const Confirmation& before, const ByImageRegion<PointsInView>& offline,
                               const RegistrationOptions& options) {
  Confirmation after = before;
  after.frames_to_believe = std::max(0, before.frames_to_believe - 1);
  if (!before.is_proven()) {
    after.frames_to_prove = is_proof(before, offline, options)
                                ? before.frames_to_prove - 1
                                : std::min(before.frames_to_prove + 1, options.confirmations);
  }
  after.is_by_hint = before.is_by_hint && !after.is_proven();
  return after;
}

}  // namespace byre
