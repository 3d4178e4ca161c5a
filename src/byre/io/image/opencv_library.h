#pragma once

#include <cstdint>

namespace byre {

// Libraries of OpenCV that are loaded at first use. They depend on decoders and encoders of all kinds (GDAL, FFmpeg,
// two hundred files), which take 50 MB and a tenth of a second. Most runs only read PNG files, which byre decodes
// itself.
enum class OpencvLibrary : std::uint8_t { images, videos };

// Address of a function in that library by its symbol. Throws InputError if the library cannot be loaded or lacks the
// function. Thread-safe.
void* find_function(OpencvLibrary library, const char* symbol);

}  // namespace byre
