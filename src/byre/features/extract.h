#pragma once

#include "byre/calibration.h"
#include "byre/features.h"
#include "byre/features/depth.h"
#include "byre/image.h"

#include <cstdint>
#include <memory>
#include <string_view>

namespace byre {

// Which matches are refined in the image to a fraction of a pixel. Anything less than all is for comparison.
enum class Refinement : std::uint8_t { none, stereo, all };  // stereo: left to right only; all: over time too

std::string_view name_of(Refinement refinement);

struct ExtractOptions {
  int max_features = 1000;
  int fast_threshold = 20;     // grey values
  int min_fast_threshold = 7;  // used where the image is dull
  Refinement refinement = Refinement::all;
  DepthOptions depth{};
  int threads = 2;  // threads at work on one frame, the caller's too; what is extracted does not depend on them
};

// Wall time of the stages of one extraction, seconds.
struct ExtractTimes {
  double rectify = 0.0;  // with the pyramids
  double extract = 0.0;  // corners, descriptors, patches
  double stereo = 0.0;   // matching left to right, or reading depths
};

// Which images of a stereo frame are looked at.
enum class ImagesUsed : std::uint8_t { all, left };

struct Extraction {
  Frame frame;
  ExtractTimes times;
};

// The front end of one camera rig: pixels in, an immutable Frame out. Keeps its working memory and its threads between
// calls; use one from one thread at a time.
class Extractor {
 public:
  // Throws InputError when the calibration cannot be rectified.
  Extractor(const Calibration& calibration, const ExtractOptions& options);
  ~Extractor();
  Extractor(Extractor&&) noexcept;
  Extractor& operator=(Extractor&&) noexcept;

  const Rig& rig() const;  // the ideal rig whose pixels the features are given in

  // Rectifies, detects, describes and, where there is a right image, matches left to right; where there is a depth
  // image, its depths become disparities. A frame of a stereo rig without either has no disparities.
  // used: a right image that is there may be left alone. Throws InputError when an image's size is not the
  // calibration's.
  Extraction extract(const ImageFrame& images, ImagesUsed used = ImagesUsed::all);

  // Lets its working memory go, which the next frame makes again: for when there is none for long.
  void rest();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace byre
