#include "byre/localisation/confirmation.h"

#include <algorithm>

namespace byre {

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

Confirmation confirmed_further(const Confirmation& before, int expected, int inliers,
                               const RegistrationOptions& options) {
  constexpr double kProofOfHint = 2.0;  // times the share that proves other finds
  const double proving_share = options.proving_share * (before.is_by_hint ? kProofOfHint : 1.0);
  const bool is_proof = inliers >= proving_share * expected;
  const int left_to_prove = std::max(0, before.frames_to_prove - (is_proof ? 1 : 0));
  return {std::max(0, before.frames_to_believe - 1), left_to_prove, before.is_by_hint && left_to_prove > 0};
}

}  // namespace byre
