#pragma once

namespace byre {

// In how many threads OpenCV may work on one image, in the whole process; 1 leaves all work to the calling thread.
// A frame's stages are too short to be worth handing out, and a pool of threads would compete with mapping.
void limit_image_threads(int count);

}  // namespace byre
