#include "byre/localisation/confirmation.h"

#include <algorithm>

namespace byre {

Confirmation confirmation_of(const FindEvidence& find, const RegistrationOptions& options) {
  constexpr double kSlack = 0.5;  // metres: what poses may err by
  Confirmation needed{options.confirmations, options.confirmations};
  if (!find.seconds_since_believed) return needed;
  if (find.shift > kSlack + options.max_speed * *find.seconds_since_believed) {
    needed.frames_to_believe = kConfirmationsOfJump;
  } else if (find.seconds_since_proven && *find.seconds_since_proven <= kWithoutProof) {
    needed.frames_to_prove = 0;
  }
  return needed;
}

Confirmation confirmed_further(const Confirmation& before, int expected, int inliers,
                               const RegistrationOptions& options) {
  const bool is_proof = inliers >= options.proving_share * expected;
  return {std::max(0, before.frames_to_believe - 1), std::max(0, before.frames_to_prove - (is_proof ? 1 : 0))};
}

}  // namespace byre
