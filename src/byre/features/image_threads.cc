#include "byre/features/image_threads.h"

#include <opencv2/core/utility.hpp>

namespace byre {

void limit_image_threads(int count) {
  cv::setNumThreads(count);
}

}  // namespace byre
