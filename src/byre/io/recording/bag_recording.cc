#include "byre/io/recording/bag_recording.h"

#include "byre/calibration_file.h"
#include "byre/geometry/baseline.h"
#include "byre/input_error.h"
#include "byre/io/bag/bag.h"
#include "byre/io/recording/bag_image.h"
#include "byre/io/recording/bag_motion.h"
#include "byre/io/recording/bag_topics.h"
#include "byre/io/recording/camera_info.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/io/recording/restored_times.h"
#include "byre/io/recording/timed_files.h"
#include "byre/io/recording/timed_messages.h"
#include "byre/io/ros/message_bytes.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

bool is_wanted(std::string_view type) {
  const BagTopic topic{"", std::string(type), ""};
  return holds<ros::Image>(topic) || holds<ros::CompressedImage>(topic) || holds<ros::CameraInfo>(topic) ||
         is_transform_topic(topic);
}

struct BagFrame {
  Timestamp time{};
  BagMessage left;
  std::optional<BagMessage> right{};
  std::optional<BagMessage> depth{};
};

struct BagFrames {
  std::vector<BagFrame> frames;
  TimeCorrections corrections;        // corrections of the left images
  SensorClock clock;                  // clock of the left images
  std::vector<std::string> warnings;  // with counts of corrections, and of images without a partner
};

std::vector<Timestamp> times_of(const std::vector<TimedMessage>& messages) {
  std::vector<Timestamp> times;
  for (const TimedMessage& each : messages) times.push_back(each.time);
  return times;
}

// Adds right images to the frames. Returns warnings of images without a partner. Preconditions: frames have left images
// only, and there are right ones.
std::vector<std::string> add_right(std::vector<BagFrame>& frames, const std::vector<TimedMessage>& right,
                                   Timestamp tolerance, const std::string& place) {
  std::vector<Timestamp> times;
  for (const BagFrame& frame : frames) times.push_back(frame.time);
  const std::vector<Timestamp> right_times = times_of(right);
  const auto partners = match_by_time(times, right_times, tolerance);
  std::vector<bool> is_used(right.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!partners[i]) continue;
    frames[i].right = right[*partners[i]].message;
    is_used[*partners[i]] = true;
  }
  const auto alone = static_cast<std::size_t>(std::ranges::count(partners, std::optional<std::size_t>()));
  const auto unused = static_cast<std::size_t>(std::ranges::count(is_used, false));
  if (alone == frames.size()) throw no_pairs_error(place, times, right_times, tolerance);
  if (alone + unused == 0) return {};
  return {fmt::format(
      "{}: {} of {} left images have no right image within {:g} ms, {} of {} right images have no left image", place,
      alone, frames.size(), 1e3 * to_seconds(tolerance), unused, right.size())};
}

// Frames of the left images in order of time (timed_messages), each with the right image whose time differs by at most
// the tolerance. place: name of the bag in warnings. Throws InputError if no right image has a left partner, and if all
// left images have one time stamp.
BagFrames bag_frames(const BagContent& content, const ImageTopics& topics, const std::string& place,
                     Timestamp tolerance) {
  constexpr double kSameFrame = 0.4;  // largest difference between the receive times of a pair, intervals
  const TimedMessages left = timed_messages(content, topics.left, {place, "image", "frame"});
  BagFrames result{{}, left.corrections, left.clock, left.warnings};
  const std::string left_place = place + ": " + content.topics[topics.left].name;
  require_times(left.messages.size(), left.corrections.repeated, left_place);
  for (const TimedMessage& each : left.messages) result.frames.push_back({each.time, each.message});
  if (!topics.right) return result;
  const TimedMessages right = timed_messages(content, *topics.right, {place, "image", "frame"}, left.clock);
  result.warnings.insert(result.warnings.end(), right.warnings.begin(), right.warnings.end());
  if (left.clock.source == TimeSource::receive_times) {
    tolerance = std::max(tolerance, from_seconds(kSameFrame * to_seconds(left.clock.interval)));
  }
  const std::vector<std::string> alone = add_right(result.frames, right.messages, tolerance, place);
  result.warnings.insert(result.warnings.end(), alone.begin(), alone.end());
  return result;
}

// Adds depth images to the frames: each belongs to the nearest frame within 20 ms, and a frame takes the nearest.
void add_depth(std::vector<BagFrame>& frames, const std::vector<TimedMessage>& depth) {
  std::vector<Timestamp> times;
  for (const BagFrame& frame : frames) times.push_back(frame.time);
  const auto owners = match_by_time(times_of(depth), times, kDepthTolerance);
  std::vector<Timestamp> gaps(frames.size(), Timestamp::max());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!owners[i]) continue;
    const Timestamp gap = std::chrono::abs(depth[i].time - times[*owners[i]]);
    if (gap >= gaps[*owners[i]]) continue;
    gaps[*owners[i]] = gap;
    frames[*owners[i]].depth = depth[i].message;
  }
}

class BagRecording final : public Recording {
 public:
  BagRecording(std::unique_ptr<Bag> bag, CalibrationWithSource calibration, std::vector<BagFrame> frames,
               MotionSamples motion, TimeCorrections corrections, std::string place, std::vector<std::string> warnings,
               int bits)
      : bag_(std::move(bag)),
        calibration_(std::move(calibration)),
        frames_(std::move(frames)),
        motion_(std::move(motion)),
        corrections_(std::move(corrections)),
        place_(std::move(place)),
        warnings_(std::move(warnings)),
        bits_(bits) {
    for (const BagFrame& frame : frames_) times_.push_back(frame.time);
  }

  const Calibration& calibration() const override { return calibration_.cameras; }
  const std::vector<Timestamp>& times() const override { return times_; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  std::optional<ImageFrame> read(int index) override;
  const MotionSamples& motion() const override { return motion_; }
  const TimeCorrections& time_corrections() const override { return corrections_; }

 private:
  std::optional<Image> read_image(const BagFrame& frame, const BagMessage& message, const Camera& camera);
  std::optional<DepthImage> read_depth(const BagFrame& frame);
  void warn(const BagFrame& frame, const BagMessage& message, const std::string& what);

  std::unique_ptr<Bag> bag_;
  CalibrationWithSource calibration_;  // constant after construction
  std::vector<BagFrame> frames_;       // constant after construction
  std::vector<Timestamp> times_;       // constant after construction
  MotionSamples motion_;               // constant after construction
  TimeCorrections corrections_;        // constant after construction
  std::string place_;                  // constant after construction
  std::vector<std::string> warnings_;  // grows with read
  int bits_;                           // bits in use of 16-bit images, constant after construction
};

void BagRecording::warn(const BagFrame& frame, const BagMessage& message, const std::string& what) {
  warnings_.push_back(place_ + ": " + bag_->content().topics[message.topic].name + " at " +
                      std::to_string(frame.time.count()) + ": " + what);
}

std::optional<Image> BagRecording::read_image(const BagFrame& frame, const BagMessage& message, const Camera& camera) {
  ImageReading<Image> read = image_of(*bag_, message, bits_);
  if (!read.image) {
    warn(frame, message, read.failure);
    return std::nullopt;
  }
  if (read.image->width == camera.width && read.image->height == camera.height) return std::move(read.image);
  warn(frame, message,
       "is " + std::to_string(read.image->width) + "x" + std::to_string(read.image->height) + " instead of " +
           std::to_string(camera.width) + "x" + std::to_string(camera.height));
  return std::nullopt;
}

std::optional<DepthImage> BagRecording::read_depth(const BagFrame& frame) {
  if (!calibration().depth || !frame.depth) return std::nullopt;
  ImageReading<DepthImage> read = depth_of(*bag_, *frame.depth).reading;
  const Camera& camera = calibration().depth->camera.value_or(calibration().left);
  if (read.image && (read.image->width != camera.width || read.image->height != camera.height)) {
    read.failure =
        fmt::format("is {}x{} instead of {}x{}", read.image->width, read.image->height, camera.width, camera.height);
    read.image.reset();
  }
  if (!read.image) warn(frame, *frame.depth, read.failure);
  return std::move(read.image);
}

std::optional<ImageFrame> BagRecording::read(int index) {
  assert(index >= 0 && index < size());
  const BagFrame& frame = frames_[static_cast<std::size_t>(index)];
  std::optional<Image> left = read_image(frame, frame.left, calibration().left);
  if (!left) return std::nullopt;
  ImageFrame images{frame.time, std::move(*left), std::nullopt, read_depth(frame)};
  if (!calibration().right) return images;
  if (frame.right) {
    images.right = read_image(frame, *frame.right, calibration().right->camera);
  } else {
    warn(frame, frame.left, "has no right image with the same time stamp");
  }
  return images;
}

// Calibration of the cameras from a bag.
class BagCalibration {
 public:
  BagCalibration(Bag& bag, std::string place) : bag_(bag), place_(std::move(place)) {}

  // Empty without camera info for the left images.
  std::optional<CalibrationWithSource> read(const ImageTopics& topics, std::vector<std::string>& warnings) const {
    const std::optional<CameraInfoWithSource> left = info_of(topics.left);
    if (!left) return std::nullopt;
    const StaticFrames frames = tree();
    CalibrationWithSource calibration{
        {camera_of(*left), std::nullopt, body_from_camera(left->info.header.frame_id, frames)}, left->place, ""};
    if (!topics.right) return calibration;
    const std::optional<CameraInfoWithSource> right = info_of(*topics.right);
    if (!right) {
      throw InputError(place_, "has no camera info for " + bag_.content().topics[*topics.right].name,
                       "give a stereo calibration with --calibration FILE, or use one camera with --camera left");
    }
    calibration.cameras.right = partner_of(*left, *right, frames);
    calibration.right_size = right->place;
    if (has_positive_baseline(*left, *right)) {
      warnings.push_back(right->place +
                         ": the baseline in P is positive, but a right camera has a negative one; the "
                         "sign is ignored. If left and right images then do not fit, exchange them with "
                         "--left and --right");
    }
    return calibration;
  }

  // The depth camera: registered to the left camera without camera info of its own, else by depth_camera_of. Throws
  // InputError if the tree does not connect the frames.
  DepthCamera read_depth(const ImageTopics& topics, const Camera& left_camera) const {
    const std::optional<CameraInfoWithSource> own = info_of(*topics.depth);
    if (!own) return {};
    const std::optional<CameraInfoWithSource> left = info_of(topics.left);
    const std::string left_frame = left ? left->info.header.frame_id : "";
    const bool is_named_registered = is_registered(bag_.content().topics[*topics.depth]);
    const auto depth = depth_camera_of(*own, is_named_registered, left_camera, left_frame, tree());
    if (!depth) {
      throw InputError(own->place,
                       "has the frame \"" + own->info.header.frame_id +
                           "\", which /tf_static does not connect to that of the left camera, \"" + left_frame + "\"",
                       "record depth registered to the left camera, give the extrinsics with --calibration FILE "
                       "(depth_camera), or use the camera alone: --camera left");
    }
    return *depth;
  }

 private:
  // Empty if it is damaged.
  template <ros::Message M>
  std::optional<M> message(const BagMessage& message) const {
    const BagTopic& topic = bag_.content().topics[message.topic];
    try {
      return ros::read_message<M>(bag_.read(message), *encoding_of(topic), place_ + ": " + topic.name);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  // The first camera info for the topic of images.
  std::optional<CameraInfoWithSource> info_of(std::size_t images) const {
    const BagContent& content = bag_.content();
    const std::string wanted = camera_info_topic(content.topics[images].name);
    for (const BagMessage& each : content.messages) {
      const BagTopic& topic = content.topics[each.topic];
      if (topic.name != wanted || !holds<ros::CameraInfo>(topic) || !encoding_of(topic)) continue;
      if (auto info = message<ros::CameraInfo>(each)) {
        return CameraInfoWithSource{std::move(*info), place_ + ": " + wanted, is_rectified(content.topics[images])};
      }
    }
    return std::nullopt;
  }

  StaticFrames tree() const {
    StaticFrames frames;
    const BagContent& content = bag_.content();
    for (const BagMessage& each : content.messages) {
      const BagTopic& topic = content.topics[each.topic];
      if (!topic.name.ends_with("tf_static") || !is_transform_topic(topic) || !encoding_of(topic)) continue;
      if (const auto transforms = message<ros::TFMessage>(each)) frames.take(*transforms);
    }
    return frames;
  }

  Bag& bag_;
  std::string place_;
};

CalibrationWithSource calibration_of(Bag& bag, const fs::path& path, const ImageTopics& topics,
                                     const OpenOptions& options, std::vector<std::string>& warnings) {
  const fs::path folder = fs::is_directory(path) ? path : path.parent_path();
  if (options.calibration) return calibration_for(folder, options);
  if (auto calibration = BagCalibration(bag, path.string()).read(topics, warnings)) return std::move(*calibration);
  if (find_calibration(folder)) return calibration_for(folder, options);
  throw InputError(path.string(),
                   "has no camera info on topic " + camera_info_topic(bag.content().topics[topics.left].name) +
                       ", and its folder contains no calibration file",
                   "give one with --calibration FILE");
}

// Adds the depth camera: of the given calibration file if that has one, else of the bag. The unit is that of the first
// readable depth image. Without one, or without a pose of the depth camera, depth is left out.
void add_depth_camera(Bag& bag, const std::vector<BagFrame>& frames, const ImageTopics& topics, const fs::path& path,
                      const OpenOptions& options, CalibrationWithSource& calibration,
                      std::vector<std::string>& warnings) {
  const std::string place = path.string() + ": " + bag.content().topics[*topics.depth].name;
  std::string failure = "no depth image is within 20 ms of a frame";
  std::optional<DepthMessage> first;
  for (const BagFrame& frame : frames) {
    if (!frame.depth) continue;
    first = depth_of(bag, *frame.depth);
    if (first->reading.image) break;
    failure = first->reading.failure;
    first.reset();
  }
  try {
    if (!first) throw InputError(place, failure, "select another topic with --depth TOPIC");
    const bool has_file = options.calibration && has_depth_camera_fields(*options.calibration);
    DepthCamera depth = has_file ? read_depth_camera(*options.calibration)
                                 : BagCalibration(bag, path.string()).read_depth(topics, calibration.cameras.left);
    if (first->is_in_metres) depth.units_per_metre = kUnitsOfMetres;
    if (!first->is_in_metres && !has_file) depth.units_per_metre = kUnitsOfMillimetres;
    const Camera& camera = depth.camera.value_or(calibration.cameras.left);
    require_calibrated_size(first->reading.image->width, first->reading.image->height, camera, place);
    calibration.cameras.depth = depth;
    calibration.depth_size = place;
  } catch (const InputError& error) {
    if (options.camera == CameraChoice::rgbd || options.depth_topic) throw;
    warnings.push_back(std::string(error.what()) + "; depth is ignored");
  }
}

// Completes sizes that the calibration file does not have from the first readable images.
void complete_sizes(Bag& bag, const std::vector<BagFrame>& frames, CalibrationWithSource& calibration) {
  const auto is_complete = [&cameras = calibration.cameras] {
    return cameras.left.width != 0 && (!cameras.right || cameras.right->camera.width != 0);
  };
  if (is_complete()) return;
  const auto complete = [&](Camera& camera, const BagMessage& message, const std::string& place) {
    const ImageReading<Image> read = image_of(bag, message);
    if (read.image) complete_size(camera, read.image->width, read.image->height, place);
  };
  for (const BagFrame& frame : frames) {
    complete(calibration.cameras.left, frame.left, calibration.left_size);
    if (calibration.cameras.right) {
      complete(calibration.cameras.right->camera, frame.right.value_or(frame.left), calibration.right_size);
    }
    if (is_complete()) return;
  }
}

// Bits in use of 16-bit images, by the largest value of images spread over the recording.
int bits_in_use(Bag& bag, const std::vector<BagFrame>& frames) {
  constexpr std::size_t kSamples = 9;
  std::uint16_t largest = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const BagFrame& frame = frames[i * (frames.size() - 1) / (kSamples - 1)];
    const auto left = largest_value(bag, frame.left);
    if (!left && i == 0) return kWordBits;
    const auto right = frame.right ? largest_value(bag, *frame.right) : std::nullopt;
    largest = std::max({largest, left.value_or(0), right.value_or(0)});
  }
  return bits_of(largest);
}

// Throws InputError if the size of the first readable image differs from the calibration, or none is readable.
void require_calibrated_size(Bag& bag, const std::vector<BagMessage>& messages, const Camera& camera,
                             const std::string& size, const fs::path& path) {
  std::string first_failure;
  for (const BagMessage& message : messages) {
    const ImageReading<Image> read = image_of(bag, message);
    if (read.image) return require_calibrated_size(read.image->width, read.image->height, camera, size);
    if (first_failure.empty()) first_failure = bag.content().topics[message.topic].name + " " + read.failure;
  }
  throw InputError(path.string(), "no image can be read: " + first_failure, "select another topic with --left TOPIC");
}

void require_calibrated_sizes(Bag& bag, const std::vector<BagFrame>& frames, const CalibrationWithSource& calibration,
                              const fs::path& path) {
  std::vector<BagMessage> left, right;
  for (const BagFrame& frame : frames) {
    left.push_back(frame.left);
    if (frame.right) right.push_back(*frame.right);
  }
  const auto& [cameras, left_size, right_size, depth_size, warnings] = calibration;
  require_calibrated_size(bag, left, cameras.left, left_size, path);
  if (cameras.right) require_calibrated_size(bag, right, cameras.right->camera, right_size, path);
}

// Frames with the images of the chosen cameras.
std::vector<BagFrame> frames_of_choice(std::vector<BagFrame> frames, const CalibrationWithSource& calibration,
                                       const std::optional<CameraChoice>& choice) {
  if (calibration.cameras.right) return frames;
  if (choice == CameraChoice::right) {
    std::erase_if(frames, [](const BagFrame& frame) { return !frame.right; });
    for (BagFrame& frame : frames) frame.left = *frame.right;
  }
  for (BagFrame& frame : frames) frame.right.reset();
  return frames;
}

}  // namespace

std::unique_ptr<Recording> open_bag_recording(const fs::path& path, const FrameRange& range,
                                              const OpenOptions& options) {
  std::unique_ptr<Bag> bag =
      open_bag(path, [&](std::string_view type) { return is_wanted(type) || is_motion_type(type, options); });
  const BagContent& content = bag->content();
  const std::string place = path.string();
  std::vector<std::string> warnings = content.damage;
  ImageTopics topics = choose_image_topics(content, options, path);
  if (options.camera == CameraChoice::left) topics.right.reset();
  auto [frames, corrections, clock, frame_warnings] = bag_frames(content, topics, place, pair_tolerance(options));
  warnings.insert(warnings.end(), frame_warnings.begin(), frame_warnings.end());

  CalibrationWithSource calibration = calibration_of(*bag, path, topics, options, warnings);
  warnings.insert(warnings.end(), calibration.warnings.begin(), calibration.warnings.end());
  complete_sizes(*bag, frames, calibration);
  if (topics.depth) {
    const TimedMessages depth = timed_messages(content, *topics.depth, {place, "image", "frame"}, clock);
    warnings.insert(warnings.end(), depth.warnings.begin(), depth.warnings.end());
    add_depth(frames, depth.messages);
    add_depth_camera(*bag, frames, topics, path, options, calibration, warnings);
  }
  if (topics.right && !calibration.cameras.right && !options.camera) {
    warnings.push_back(place + ": the calibration has one camera only; right images are ignored");
  }
  const ExtraImages extra{.right = topics.right.has_value(), .depth = calibration.cameras.depth.has_value()};
  calibration = choose_calibration(calibration, extra, options.camera, path);
  calibration.cameras =
      with_checked_baseline(calibration.cameras, options.baseline, place_of_calibration(path, options), "--baseline ");
  frames = frames_of_choice(std::move(frames), calibration, options.camera);
  require_calibrated_sizes(*bag, frames, calibration, path);
  auto [motion, motion_warnings] = read_bag_motion(*bag, options, place, clock);
  warnings.insert(warnings.end(), motion_warnings.begin(), motion_warnings.end());

  const int bits = frames.empty() ? kWordBits : bits_in_use(*bag, frames);
  std::vector<Timestamp> times;
  for (const BagFrame& frame : frames) times.push_back(frame.time);
  std::vector<BagFrame> selected;
  for (const std::size_t i : frames_in_range(times, range, path)) selected.push_back(frames[i]);
  return std::make_unique<BagRecording>(std::move(bag), std::move(calibration), std::move(selected), std::move(motion),
                                        std::move(corrections), place, std::move(warnings), bits);
}

}  // namespace byre
