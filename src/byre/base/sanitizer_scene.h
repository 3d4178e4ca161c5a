#pragma once

namespace byre {

// The thread sanitizer slows code by about ten times. Tests that take seconds are skipped under it, except one per
// folder that covers its threads.
#ifdef BYRE_THREAD_SANITIZED
inline constexpr bool kHasThreadSanitizer = true;
#else
inline constexpr bool kHasThreadSanitizer = false;
#endif
inline constexpr const char* kSlowUnderThreadSanitizer =
    "slow under the thread sanitizer; other tests of the folder cover its threads";

}  // namespace byre
