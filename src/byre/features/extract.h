#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/features/depth.h"
#include "byre/image.h"

#include <cstdint>
#include <memory>
#include <span>

namespace byre {

struct ExtractOptions {
  int max_features = 1000;
  int fast_threshold = 20;     // grey values
  int min_fast_threshold = 7;  // used in dull parts of the image
  DepthOptions depth{};
  bool picture = false;  // whether frames have a picture, see Frame
  int threads = 2;       // threads per frame, including the caller's; does not affect the result
};

// Wall time of the stages of one extraction, seconds.
struct ExtractTimes {
  double rectify = 0.0;  // includes the pyramids
  double extract = 0.0;  // corners, descriptors, patches
  double stereo = 0.0;   // stereo matching, or reading depths
};

// Images of a stereo frame to use.
enum class ImagesUsed : std::uint8_t { all, left };

struct Extraction {
  Frame frame;
  ExtractTimes times;
};

// Front end of one camera rig: turns images into an immutable Frame. Keeps working memory and threads between calls.
// Not thread-safe.
class Extractor {
 public:
  // Detects AprilTags of these families in the left image, unless it did within tag_interval before. Throws InputError
  // if the calibration cannot be rectified.
  Extractor(const Calibration& calibration, const ExtractOptions& options, std::span<const TagFamily> tag_families = {},
            Timestamp tag_interval = {});
  ~Extractor();
  Extractor(Extractor&&) noexcept;
  Extractor& operator=(Extractor&&) noexcept;

  const Rig& rig() const;  // the ideal rig of the features' pixels

  // Rectifies, detects and describes. A right image yields disparities by stereo matching, a depth image by its depths.
  // Without either, a frame has no disparities.
  // used: left ignores the right image. Throws InputError if the size of an image differs from the calibration.
  Extraction extract(const ImageFrame& images, ImagesUsed used = ImagesUsed::all);

  // Frees the working memory before a long pause; the next frame allocates it again.
  void rest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace byre
