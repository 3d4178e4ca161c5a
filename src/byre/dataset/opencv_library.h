#pragma once

#include <cstdint>

namespace byre {

// Libraries of OpenCV that the first use of them loads, at any time of the run. Decoders and encoders of all kinds come
// with them (GDAL, FFmpeg, two hundred files), which take 50 MB and a tenth of a second, while most runs read PNG files
// alone, which byre decodes itself.
enum class OpencvLibrary : std::uint8_t { images, videos };

// Address of a function by its name for the linker, in that library. Throws InputError where the library cannot be
// loaded or lacks it. Thread-safe.
void* find_function(OpencvLibrary library, const char* symbol);

}  // namespace byre
