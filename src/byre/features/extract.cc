#include "byre/features/extract.h"

#include "byre/base/byte_stream.h"
#include "byre/base/object_pool.h"
#include "byre/base/task_threads.h"
#include "byre/features/descriptor.h"
#include "byre/features/detect.h"
#include "byre/features/enhance.h"
#include "byre/features/gaussian_blur.h"
#include "byre/features/pyramid.h"
#include "byre/features/rectify.h"
#include "byre/features/stereo.h"
#include "byre/features/tag_detector.h"
#include "byre/image_condition.h"
#include "byre/input_error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace byre {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

void require_size(int width, int height, std::size_t pixels, const Camera& camera) {
  if (width != camera.width || height != camera.height) {
    throw InputError("image",
                     "is " + std::to_string(width) + " x " + std::to_string(height) +
                         " pixels; the calibration is for " + std::to_string(camera.width) + " x " +
                         std::to_string(camera.height),
                     "use the calibration of this camera at this resolution");
  }
  if (pixels != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw InputError("image", "has " + std::to_string(pixels) + " pixels instead of width times height",
                     "give 8-bit grey pixels (depth: 16 bits), row by row without padding");
  }
}

// Header over the image's own pixels; nothing writes through it.
cv::Mat as_matrix(const Image& image, const Camera& camera) {
  require_size(image.width, image.height, image.pixels.size(), camera);
  return {image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())};
}

// Adapts the exposure of the right image to the left one, because stereo matching compares grey values. Small
// differences are left to the matching.
cv::Mat match_exposure(const cv::Mat& right, const ImageCondition& of_left, const ImageCondition& of_right) {
  constexpr float kMinContrast = 1.0f;         // grey values: lower contrast has no signal to amplify
  constexpr float kSimilarContrast = 1.25f;    // ratio of contrasts
  constexpr float kMaxGain = 6.0f;             // a larger gain would amplify quantisation steps, which would match
  constexpr float kSimilarBrightness = 25.0f;  // grey values
  if (of_left.contrast < kMinContrast || of_right.contrast < kMinContrast) return right;
  const float ratio = of_left.contrast / of_right.contrast;
  const bool is_similar = ratio < kSimilarContrast && ratio > 1.0f / kSimilarContrast &&
                          std::abs(of_left.brightness - of_right.brightness) < kSimilarBrightness;
  if (is_similar) return right;
  const float gain = std::clamp(ratio, 1.0f / kMaxGain, kMaxGain);
  cv::Mat exposed;
  right.convertTo(exposed, CV_8U, gain, of_left.brightness - gain * of_right.brightness);
  return exposed;
}

// Stores the measured disparities in the keypoints.
template <typename Measured>
void store_disparities(std::span<const std::optional<Measured>> measured, std::span<Keypoint> keypoints) {
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!measured[i]) continue;
    keypoints[i].disparity = measured[i]->disparity;
    keypoints[i].disparity_sigma = measured[i]->sigma;
  }
}

// Number of features of each octave, proportional to its side length.
std::array<int, kOctaves> octave_quotas(int max_features) {
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

// Octave that is small enough, further reduced if none is.
void fill_picture(const Pyramid& pyramid, Image& picture) {
  constexpr int kSide = 376;  // pixels, longer side; up to a half more if it is not reduced further
  const auto side = [](const cv::Mat& level) { return std::max(level.cols, level.rows); };
  std::size_t octave = 0;
  while (octave + 1 < kOctaves && side(pyramid.levels[octave]) > kSide && !pyramid.levels[octave + 1].empty()) ++octave;
  const cv::Mat& level = pyramid.levels[octave];
  const int step = std::max(1, static_cast<int>(std::lround(static_cast<double>(side(level)) / kSide)));
  picture.width = std::max(1, level.cols / step);
  picture.height = std::max(1, level.rows / step);
  picture.pixels.clear();
  for (int row = 0; row < picture.height; ++row) {
    const std::uint8_t* const source = level.ptr<std::uint8_t>(std::min(row * step, level.rows - 1));
    if (step == 1) {
      picture.pixels.insert(picture.pixels.end(), source, source + picture.width);
    } else {
      for (int column = 0; column < picture.width; ++column) picture.pixels.push_back(source[column * step]);
    }
  }
}

}  // namespace

struct Described {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;

  // Keeps the memory for the next frame.
  void clear() {
    keypoints.clear();
    descriptors.clear();
    patches.clear();
  }
};

// Predicted condition of the enhanced image.
ImageCondition enhanced_condition(const ImageCondition& of_original) {
  return condition_after_enhancement(choose_enhancement(of_original), of_original);
}

// An image prepared for feature detection.
struct EnhancedImage {
  cv::Mat image;
  ImageCondition condition;

  void take(const cv::Mat& rectified, const ImageCondition& of_original) {
    const Enhancement enhancement = choose_enhancement(of_original);
    condition = condition_after_enhancement(enhancement, of_original);
    if (enhancement.is_active()) {
      enhance(enhancement, rectified, fine_, own_);
      image = own_;
    } else {
      image = rectified;
    }
  }

 private:
  cv::Mat fine_;  // working memory, see enhance()
  cv::Mat own_;   // own memory, because the caller may own the rectified image
};

struct Extractor::State {
  State(const Calibration& used, const ExtractOptions& extract_options, std::span<const TagFamily> tag_families,
        Timestamp tag_interval)
      : calibration(used),
        rectifier(used),
        options(extract_options),
        tag_detector(tag_families),
        interval_of_tags(tag_interval),
        threads(std::max(1, options.threads) - 1) {
    if (calibration.depth) depth.emplace(calibration, rectifier.rig());
  }

  Calibration calibration;
  Rectifier rectifier;
  ExtractOptions options;
  std::optional<DepthReader> depth;
  TagDetector tag_detector;
  Timestamp interval_of_tags;
  std::optional<Timestamp> last_tags;  // last frame in which tags were detected
  // Working memory, see rest().
  Pyramid left;
  Pyramid right;
  EnhancedImage left_enhanced;
  EnhancedImage right_enhanced;
  std::array<cv::Mat, kOctaves> blurred;
  std::array<Described, kOctaves> described;
  std::vector<Keypoint> keypoints;  // all octaves, the finest first; working memory as the next members
  std::vector<Descriptor> descriptors;
  ObjectPool<std::vector<Patch>> patches_of_frames;
  ObjectPool<Features> features_of_frames;
  ObjectPool<Image> pictures_of_frames;
  std::vector<std::optional<StereoMatch>> stereo_matches;
  TaskThreads threads;

  void prepare(const ImageFrame& images, bool stereo, Frame& frame);
  void describe_octave(int octave, int quota);
  std::shared_ptr<const std::vector<Patch>> describe_all(Frame& frame);
  void match_right();
  void read_depths(const DepthImage& image);
  void time_rows();
};

// Rectified and enhanced pyramids of both images, and the condition of the original images. The exposure of the right
// image follows the left one, so it needs the conditions of both.
void Extractor::State::prepare(const ImageFrame& images, bool stereo, Frame& frame) {
  const cv::Mat left_image = as_matrix(images.left, calibration.left);
  const cv::Mat right_image = stereo ? as_matrix(*images.right, calibration.right->camera) : cv::Mat();
  threads.run(stereo ? 3 : 2, [&](int i) {
    if (i == 0) frame.condition = measure_condition(images.left);
    if (i == 1) frame.content = checksum(std::as_bytes(std::span(images.left.pixels)));
    if (i == 2) frame.right_condition = measure_condition(*images.right);
  });
  const auto prepare_left = [&] {
    left_enhanced.take(rectifier.left(left_image), *frame.condition);
    build_pyramid(left_enhanced.image, left);
  };
  const auto prepare_right = [&] {
    right_enhanced.take(rectifier.right(right_image), *frame.right_condition);
    build_pyramid(match_exposure(right_enhanced.image, enhanced_condition(*frame.condition), right_enhanced.condition),
                  right);
  };
  threads.run(stereo ? 2 : 1, [&](int i) { i == 0 ? prepare_left() : prepare_right(); });
}

void Extractor::State::describe_octave(int octave, int quota) {
  const auto slot = static_cast<std::size_t>(octave);
  Described& found = described[slot];
  found.clear();
  const cv::Mat& level = left.levels[slot];
  DetectOptions detect;
  detect.fast_threshold = options.fast_threshold;
  detect.min_fast_threshold = options.min_fast_threshold;
  detect.border = kDescriptorRadius;
  cv::Mat& smooth = blurred[slot];
  const ScratchVector<Corner> corners = detect_corners(level, quota, detect, smooth);
  if (corners.empty()) return;
  found.keypoints.reserve(corners.size());
  found.descriptors.reserve(corners.size());
  found.patches.reserve(corners.size());
  gaussian_blur(level, smooth);
  for (const Corner& corner : corners) {
    Keypoint keypoint;
    keypoint.pixel = full_from_octave({static_cast<float>(corner.x), static_cast<float>(corner.y)}, octave);
    keypoint.octave = static_cast<std::uint8_t>(octave);
    keypoint.response = corner.response;
    keypoint.angle = orientation(level.ptr<std::uint8_t>(corner.y) + corner.x, static_cast<std::ptrdiff_t>(level.step));
    found.descriptors.push_back(describe(smooth.ptr<std::uint8_t>(corner.y) + corner.x,
                                         static_cast<std::ptrdiff_t>(smooth.step), keypoint.angle));
    found.patches.push_back(cut_patch(level, corner.x, corner.y));
    found.keypoints.push_back(keypoint);
  }
}

// Describes all octaves, and beside them detects the frame's tags if they are due. Returns the patches.
std::shared_ptr<const std::vector<Patch>> Extractor::State::describe_all(Frame& frame) {
  const std::array<int, kOctaves> quota = octave_quotas(options.max_features);
  const bool is_due = tag_detector.has_families() && !(last_tags && frame.time - *last_tags < interval_of_tags);
  if (is_due) last_tags = frame.time;
  const int before = is_due ? 1 : 0;  // tags first, as they take longest
  threads.run(before + kOctaves, [&](int task) {
    if (task < before) {
      const cv::Mat& image = left_enhanced.image;
      frame.tags =
          tag_detector.detect({.data = image.data, .width = image.cols, .height = image.rows, .stride = image.step});
    } else {
      describe_octave(task - before, quota[static_cast<std::size_t>(task - before)]);
    }
  });
  const std::shared_ptr<std::vector<Patch>>& patches = patches_of_frames.take();
  keypoints.clear();
  descriptors.clear();
  patches->clear();
  patches->reserve(static_cast<std::size_t>(options.max_features));
  for (const Described& found : described) {
    keypoints.insert(keypoints.end(), found.keypoints.begin(), found.keypoints.end());
    descriptors.insert(descriptors.end(), found.descriptors.begin(), found.descriptors.end());
    patches->insert(patches->end(), found.patches.begin(), found.patches.end());
  }
  return patches;
}

void Extractor::State::match_right() {
  constexpr std::size_t kAtOnce = 64;  // keypoints a task
  const std::span<Keypoint> all = keypoints;
  stereo_matches.resize(all.size());
  threads.run(static_cast<int>((all.size() + kAtOnce - 1) / kAtOnce), [&](int task) {
    const std::size_t first = static_cast<std::size_t>(task) * kAtOnce;
    const std::span<Keypoint> some = all.subspan(first, std::min(kAtOnce, all.size() - first));
    const std::span matches = std::span(stereo_matches).subspan(first, some.size());
    match_stereo(left, right, rectifier.rig(), some, {}, matches);
    store_disparities<StereoMatch>(matches, some);
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (matches[i]) some[i].row_offset = matches[i]->row_offset;
    }
  });
}

void Extractor::State::read_depths(const DepthImage& image) {
  require_size(image.width, image.height, image.units.size(), calibration.depth->camera.value_or(calibration.left));
  store_disparities<DepthReading>(depth->read(image, keypoints, options.depth), keypoints);
}

void Extractor::State::time_rows() {
  const auto height = static_cast<float>(calibration.left.height);
  for (Keypoint& keypoint : keypoints) {
    keypoint.row_time = (rectifier.source_row(keypoint.pixel) + 0.5f) / height - 0.5f;
  }
}

Extractor::Extractor(const Calibration& calibration, const ExtractOptions& options,
                     std::span<const TagFamily> tag_families, Timestamp tag_interval)
    : state_(new State(calibration, options, tag_families, tag_interval)) {}
Extractor::~Extractor() = default;
Extractor::Extractor(Extractor&&) noexcept = default;
Extractor& Extractor::operator=(Extractor&&) noexcept = default;

const Rig& Extractor::rig() const {
  return state_->rectifier.rig();
}

void Extractor::rest() {
  state_->left = {};
  state_->right = {};
  state_->left_enhanced = {};
  state_->right_enhanced = {};
  state_->blurred = {};
  state_->described = {};
  state_->keypoints = {};
  state_->descriptors = {};
  state_->patches_of_frames = {};
  state_->features_of_frames = {};
  state_->pictures_of_frames = {};
  state_->stereo_matches = {};
}

Extraction Extractor::extract(const ImageFrame& images, ImagesUsed used) {
  const Clock::time_point start = Clock::now();
  const TaskThreads::SpinScope shift(state_->threads);
  const Calibration& calibration = state_->calibration;
  const bool stereo = calibration.right && images.right && used == ImagesUsed::all;
  Extraction extraction;
  Frame& frame = extraction.frame;
  frame.time = images.time;
  state_->prepare(images, stereo, frame);
  const Clock::time_point rectified = Clock::now();
  const std::shared_ptr<const std::vector<Patch>> patches = state_->describe_all(frame);
  const Clock::time_point extracted = Clock::now();
  if (stereo) state_->match_right();
  if (calibration.depth && images.depth) state_->read_depths(*images.depth);
  state_->time_rows();
  const std::shared_ptr<Features>& features = state_->features_of_frames.take();
  features->refill(rig().width, rig().height, state_->keypoints, state_->descriptors, patches);
  frame.features = features;
  if (state_->options.picture) {
    const std::shared_ptr<Image>& picture = state_->pictures_of_frames.take();
    fill_picture(state_->left, *picture);
    frame.picture = picture;
  }
  extraction.times = {seconds_between(start, rectified), seconds_between(rectified, extracted),
                      seconds_between(extracted, Clock::now())};
  return extraction;
}

}  // namespace byre
