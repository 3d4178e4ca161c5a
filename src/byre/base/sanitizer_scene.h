#pragma once

namespace byre {

// The thread sanitizer makes code some ten times slower. A test of seconds skips itself if kHasThreadSanitizer, with
// this message, unless it is the one of its folder that covers the threads.
#ifdef BYRE_THREAD_SANITIZED
inline constexpr bool kHasThreadSanitizer = true;
#else
inline constexpr bool kHasThreadSanitizer = false;
#endif
inline constexpr const char* kSlowUnderThreadSanitizer =
    "slow under the thread sanitizer; other tests of the folder cover its threads";

}  // namespace byre
