#pragma once

#include "byre/image.h"

namespace byre {

bool is_depth(PixelFormat format);

// Whether rows are as long as their pixels, rows and columns as many as the format needs, and numbers of several bytes
// where the processor reads such.
bool is_sound(const ImageView& view);

// Copies somebody's picture, as grey, or somebody's depths; the memory of the result is used again. Preconditions: the
// view is sound and of that kind.
void copy_grey(const ImageView& view, Image& grey);
void copy_depth(const ImageView& view, double units_per_metre, DepthImage& depth);

}  // namespace byre
