#include "imperfection.h"

#include "byre/simulation/camera_imperfection.h"

#include <algorithm>
#include <memory>

namespace byre {
namespace {

// One camera of a pair; initialised with the first image's size.
class ImperfectCamera {
 public:
  ImperfectCamera(const CameraImperfection& imperfection, StereoSide side) : imperfection_(imperfection), side_(side) {}

  Image seen(const Image& image) {
    if (!blur_) blur_.emplace(image.width, image.height, lens_blur_of(imperfection_, side_));
    const bool is_right = side_ == StereoSide::right;
    const auto gain = static_cast<float>(is_right ? imperfection_.gain : 1.0);
    const auto offset = static_cast<float>(is_right ? imperfection_.offset : 0.0);
    const std::vector<float> light = blur_->blurred({image.pixels.begin(), image.pixels.end()}, 1);
    Image seen{image.width, image.height, std::vector<std::uint8_t>(light.size())};
    std::ranges::transform(light, seen.pixels.begin(), [&](float grey) {
      return static_cast<std::uint8_t>(std::clamp(gain * grey + offset + 0.5f, 0.0f, 255.0f));
    });
    return imperfection_.jpeg_quality > 0 ? jpeg_compressed(seen, imperfection_.jpeg_quality) : seen;
  }

 private:
  CameraImperfection imperfection_;
  StereoSide side_;
  std::optional<LensBlur> blur_;
};

struct ImperfectPair {
  explicit ImperfectPair(const CameraImperfection& imperfection)
      : left(imperfection, StereoSide::left), right(imperfection, StereoSide::right) {}

  ImperfectCamera left, right;
};

}  // namespace

std::string name_of(const Imperfection& imperfection) {
  std::string name(to_string(imperfection.condition));
  if (imperfection.condition != CameraCondition::exact) name += "_" + std::to_string(imperfection.calibration_seed);
  return name;
}

Calibration nominal_calibration(const Calibration& calibration, const Imperfection& imperfection) {
  Calibration nominal =
      perturbed(calibration, imperfection_of(imperfection.condition).calibration_level, imperfection.calibration_seed);
  const auto stretch = [&](Camera& camera) {
    camera.fx *= imperfection.focal_factor;
    camera.fy *= imperfection.focal_factor;
  };
  stretch(nominal.left);
  if (nominal.right) stretch(nominal.right->camera);
  return nominal;
}

Degradation imperfect_cameras(const Imperfection& imperfection) {
  if (imperfection.condition == CameraCondition::exact) return [](const ImageFrame& images, int) { return images; };
  const auto pair = std::make_shared<ImperfectPair>(imperfection_of(imperfection.condition));
  return [pair](const ImageFrame& images, int) {
    ImageFrame seen{images.time, pair->left.seen(images.left), std::nullopt};
    if (images.right) seen.right = pair->right.seen(*images.right);
    return seen;
  };
}

}  // namespace byre
