#include "byre/features/extract.h"

#include "byre/features/descriptor.h"
#include "byre/features/detect.h"
#include "byre/features/gaussian_blur.h"
#include "byre/features/pyramid.h"
#include "byre/features/rectify.h"
#include "byre/features/stereo.h"
#include "byre/image_condition.h"
#include "byre/input/byte_stream.h"
#include "byre/input_error.h"

#include <chrono>
#include <cmath>
#include <span>
#include <utility>

namespace byre {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

void require_size(int width, int height, std::size_t pixels, const Camera& camera) {
  if (width != camera.width || height != camera.height) {
    throw InputError("image",
                     "is " + std::to_string(width) + " x " + std::to_string(height) + " pixels, the calibration says " +
                         std::to_string(camera.width) + " x " + std::to_string(camera.height),
                     "use the calibration of this camera at this resolution");
  }
  if (pixels != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw InputError("image", "holds " + std::to_string(pixels) + " pixels, not width times height",
                     "give 8-bit grey pixels (of depths: 16 bits), row after row without padding");
  }
}

// A header over the image's own pixels; nothing writes through it.
cv::Mat as_matrix(const Image& image, const Camera& camera) {
  require_size(image.width, image.height, image.pixels.size(), camera);
  return {image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())};
}

// The right image as the left camera would expose it. Images are compared by their grey values, so that a camera that
// is much darker than the other would match nothing; small differences are left to what compares.
cv::Mat exposed_as_left(const cv::Mat& right, const ImageCondition& of_left, const ImageCondition& of_right) {
  constexpr float kMinContrast = 1.0f;       // grey values: below there is nothing to bring out
  constexpr float kAlike = 1.25f;            // ratio of contrasts
  constexpr float kMaxGain = 6.0f;           // beyond, steps between grey values are what would match
  constexpr float kAlikeBrightness = 25.0f;  // grey values
  if (of_left.contrast < kMinContrast || of_right.contrast < kMinContrast) return right;
  const float ratio = of_left.contrast / of_right.contrast;
  const bool is_alike =
      ratio < kAlike && ratio > 1.0f / kAlike && std::abs(of_left.brightness - of_right.brightness) < kAlikeBrightness;
  if (is_alike) return right;
  const float gain = std::clamp(ratio, 1.0f / kMaxGain, kMaxGain);
  cv::Mat exposed;
  right.convertTo(exposed, CV_8U, gain, of_left.brightness - gain * of_right.brightness);
  return exposed;
}

// What was measured of each keypoint, where it was.
template <typename Measured>
void take_over(const std::vector<std::optional<Measured>>& measured, std::vector<Keypoint>& keypoints) {
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i]) continue;
    keypoints[i].disparity = measured[i]->disparity;
    keypoints[i].disparity_sigma = measured[i]->sigma;
  }
}

// How many features each octave gets: in proportion to its side, finer octaves more.
std::array<int, kOctaves> share_out(int max_features) {
  double sum = 0.0;
  for (const float scale : kScaleOfOctave) sum += 1.0 / scale;
  std::array<int, kOctaves> quota{};
  int rest = max_features;
  for (std::size_t octave = 0; octave + 1 < kOctaves; ++octave) {
    quota[octave] = static_cast<int>(std::lround(max_features / (kScaleOfOctave[octave] * sum)));
    rest -= quota[octave];
  }
  quota.back() = std::max(0, rest);
  return quota;
}

Patch cut_patch(const cv::Mat& level, int x, int y) {
  constexpr int kHalf = Patch::kSize / 2;
  Patch patch;
  for (int row = 0; row < Patch::kSize; ++row) {
    const std::uint8_t* const source = level.ptr<std::uint8_t>(y - kHalf + row) + x - kHalf;
    std::copy_n(source, Patch::kSize, patch.pixels.data() + row * Patch::kSize);
  }
  patch.centre = Eigen::Vector2f::Constant(kHalf);
  return patch;
}

struct Described {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;
};

}  // namespace

struct Extractor::State {
  Calibration calibration;
  Rectifier rectifier;
  ExtractOptions options;
  Pyramid left;
  Pyramid right;
  std::array<cv::Mat, kOctaves> blurred;
  std::optional<DepthReader> depth;

  void describe_octave(int octave, int quota, Described& described);
  Described describe_all();
  void match_right(const cv::Mat& rectified, std::vector<Keypoint>& keypoints);
  void read_depths(const DepthImage& image, std::vector<Keypoint>& keypoints) const;
  void time_rows(std::vector<Keypoint>& keypoints) const;
};

void Extractor::State::describe_octave(int octave, int quota, Described& described) {
  const cv::Mat& level = left.levels[static_cast<std::size_t>(octave)];
  DetectOptions detect;
  detect.fast_threshold = options.fast_threshold;
  detect.min_fast_threshold = options.min_fast_threshold;
  detect.border = kDescriptorRadius;
  const std::vector<Corner> corners = detect_corners(level, quota, detect);
  if (corners.empty()) return;
  cv::Mat& smooth = blurred[static_cast<std::size_t>(octave)];
  gaussian_blur(level, smooth);
  for (const Corner& corner : corners) {
    Keypoint keypoint;
    keypoint.pixel = full_from_octave({static_cast<float>(corner.x), static_cast<float>(corner.y)}, octave);
    keypoint.octave = static_cast<std::uint8_t>(octave);
    keypoint.response = corner.response;
    keypoint.angle = orientation(level.ptr<std::uint8_t>(corner.y) + corner.x, static_cast<std::ptrdiff_t>(level.step));
    described.descriptors.push_back(describe(smooth.ptr<std::uint8_t>(corner.y) + corner.x,
                                             static_cast<std::ptrdiff_t>(smooth.step), keypoint.angle));
    if (options.refinement == Refinement::all) described.patches.push_back(cut_patch(level, corner.x, corner.y));
    described.keypoints.push_back(keypoint);
  }
}

Described Extractor::State::describe_all() {
  const std::array<int, kOctaves> quota = share_out(options.max_features);
  Described described;
  described.keypoints.reserve(static_cast<std::size_t>(options.max_features));
  described.descriptors.reserve(static_cast<std::size_t>(options.max_features));
  described.patches.reserve(static_cast<std::size_t>(options.max_features));
  for (int octave = 0; octave < kOctaves; ++octave) {
    describe_octave(octave, quota[static_cast<std::size_t>(octave)], described);
  }
  return described;
}

void Extractor::State::match_right(const cv::Mat& rectified, std::vector<Keypoint>& keypoints) {
  build_pyramid(rectified, right);
  StereoOptions stereo_options;
  stereo_options.refine = options.refinement != Refinement::none;
  const auto matches = match_stereo(left, right, rectifier.rig(), keypoints, stereo_options);
  take_over(matches, keypoints);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i]) keypoints[i].row_offset = matches[i]->row_offset;
  }
}

void Extractor::State::read_depths(const DepthImage& image, std::vector<Keypoint>& keypoints) const {
  require_size(image.width, image.height, image.units.size(), calibration.depth->camera.value_or(calibration.left));
  take_over(depth->read(image, keypoints, options.depth), keypoints);
}

void Extractor::State::time_rows(std::vector<Keypoint>& keypoints) const {
  const auto height = static_cast<float>(calibration.left.height);
  for (Keypoint& keypoint : keypoints) {
    keypoint.row_time = (rectifier.source_row(keypoint.pixel) + 0.5f) / height - 0.5f;
  }
}

std::string_view name_of(Refinement refinement) {
  switch (refinement) {
    case Refinement::none:
      return "none";
    case Refinement::stereo:
      return "stereo";
    case Refinement::all:
      return "all";
  }
  return "";
}

Extractor::Extractor(const Calibration& calibration, const ExtractOptions& options)
    : state_(new State{calibration, Rectifier(calibration), options, {}, {}, {}, {}}) {
  if (calibration.depth) state_->depth.emplace(calibration, rig());
}
Extractor::~Extractor() = default;
Extractor::Extractor(Extractor&&) noexcept = default;
Extractor& Extractor::operator=(Extractor&&) noexcept = default;

const Rig& Extractor::rig() const {
  return state_->rectifier.rig();
}

Extraction Extractor::extract(const ImageFrame& images) {
  const Clock::time_point start = Clock::now();
  const Calibration& calibration = state_->calibration;
  const bool stereo = calibration.right && images.right;
  const cv::Mat left = state_->rectifier.left(as_matrix(images.left, calibration.left));
  const cv::Mat right =
      stereo ? state_->rectifier.right(as_matrix(*images.right, calibration.right->camera)) : cv::Mat();
  const Clock::time_point rectified = Clock::now();

  build_pyramid(left, state_->left);
  Described described = state_->describe_all();
  const Clock::time_point extracted = Clock::now();

  Extraction extraction;
  Frame& frame = extraction.frame;
  frame.time = images.time;
  frame.content = checksum(std::as_bytes(std::span(images.left.pixels)));
  frame.condition = measure_condition(images.left);
  if (stereo) {
    frame.right_condition = measure_condition(*images.right);
    state_->match_right(exposed_as_left(right, *frame.condition, *frame.right_condition), described.keypoints);
  }
  if (calibration.depth && images.depth) state_->read_depths(*images.depth, described.keypoints);
  state_->time_rows(described.keypoints);
  frame.features =
      std::make_shared<const Features>(images.left.width, images.left.height, std::move(described.keypoints),
                                       std::move(described.descriptors), std::move(described.patches));
  extraction.times = {seconds_between(start, rectified), seconds_between(rectified, extracted),
                      seconds_between(extracted, Clock::now())};
  return extraction;
}

}  // namespace byre
