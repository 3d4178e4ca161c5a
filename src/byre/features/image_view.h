#pragma once

#include "byre/image.h"

#include <cstddef>
#include <vector>

namespace byre {

bool is_depth(PixelFormat format);

// Whether rows are long enough for their pixels, width and height fit the format, and multi-byte numbers are aligned.
bool is_sound(const ImageView& view);

// Copies the image of a caller as grey, or depths of a caller; the memory of the result is reused. Preconditions: the
// view is sound and of that kind.
void copy_grey(const ImageView& view, Image& grey);
void copy_depth(const ImageView& view, double units_per_metre, DepthImage& depth);

// Images of a caller, copied. Unsound views keep their format and size, without pixels.
class CopiedImages {
 public:
  explicit CopiedImages(const CameraImages& images);
  CopiedImages(const CopiedImages&) = delete;
  CopiedImages& operator=(const CopiedImages&) = delete;
  const CameraImages& views() const { return views_; }

 private:
  CameraImages views_;
  std::vector<std::vector<std::byte>> pixels_;
};

}  // namespace byre
