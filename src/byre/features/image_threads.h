#pragma once

namespace byre {

// Limits the threads of OpenCV in the whole process; 1 runs all work on the calling thread. The stages of a frame are
// too short to distribute, and a thread pool would compete with mapping.
void limit_image_threads(int count);

}  // namespace byre
