#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace byre {

struct LensBlurOptions {
  float corner_sigma = 0.0f;  // pixels, at the distance from the sharpest point that a corner has from the centre
  Eigen::Vector2f sharpest{0.0f, 0.0f};  // offset from the image centre, in image widths
};

// Lens blur from field curvature: approximately Gaussian, with a sigma that grows with the square of the distance from
// the sharpest point.
class LensBlur {
 public:
  LensBlur(int width, int height, const LensBlurOptions& options);

  bool is_sharp() const { return steps_ == 0; }  // everywhere
  float sigma_at(int column, int row) const;     // pixels

  // image: one value per pixel, row-major. Deterministic for any number of threads (0: one per core).
  std::vector<float> blurred(const std::vector<float>& image, int threads) const;

 private:
  std::size_t index(int column, int row) const;
  std::vector<float> step_further(const std::vector<float>& image, int threads) const;

  int width_;
  int height_;
  int steps_ = 0;                 // number of equal variance steps up to the largest blur
  float step_variance_ = 0.0f;    // pixels squared
  std::vector<float> variances_;  // variance of each pixel, in steps; empty when is_sharp()
};

}  // namespace byre
