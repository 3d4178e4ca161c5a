#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct LensBlurOptions {
  float corner_sigma = 0.0f;             // pixels, as far from the sharpest place as a corner is from the middle
  Eigen::Vector2f sharpest{0.0f, 0.0f};  // off the image's middle, in widths of the image
};

// A lens that draws sharply in one place and ever softer away from it, as a curved field of focus does: the sigma of
// the blur, which is about normal, grows with the square of the distance.
class LensBlur {
 public:
  LensBlur(int width, int height, const LensBlurOptions& options);

  bool is_sharp() const { return steps_ == 0; }  // everywhere
  float sigma_at(int column, int row) const;     // pixels

  // image: of each pixel, row-major. The same image gives the same numbers, whatever the number of threads (0: as many
  // as the machine has).
  std::vector<float> blurred(const std::vector<float>& image, int threads) const;

 private:
  std::size_t index(int column, int row) const;
  std::vector<float> step_further(const std::vector<float>& image, int threads) const;

  int width_;
  int height_;
  int steps_ = 0;                 // number of blurs of equal variance up to the largest
  float step_variance_ = 0.0f;    // pixels squared
  std::vector<float> variances_;  // variance of each pixel, in steps; empty where all is sharp
};

}  // namespace byre
