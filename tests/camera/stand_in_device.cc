#include "stand_in_device.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <linux/videodev2.h>
#include <opencv2/imgcodecs.hpp>

namespace byre::stand_in {
namespace {

std::string setting(const char* name) {
  const char* const value = std::getenv((std::string("BYRE_STAND_IN_") + name).c_str());
  return value != nullptr ? value : "";
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

// Numbers after a device's name in a list "left:3,right:5".
std::vector<std::vector<int>> numbers_for(const std::string& device, const char* name) {
  std::vector<std::vector<int>> found;
  for (const std::string& entry : split(setting(name), ',')) {
    const std::vector<std::string> parts = split(entry, ':');
    if (parts.empty() || parts.front() != device) continue;
    std::vector<int> numbers;
    for (std::size_t i = 1; i < parts.size(); ++i) numbers.push_back(std::stoi(parts[i]));
    found.push_back(numbers);
  }
  return found;
}

std::vector<std::pair<std::int64_t, std::string>> listed(const std::string& camera_folder) {
  std::vector<std::pair<std::int64_t, std::string>> files;
  std::ifstream list(camera_folder + "/data.csv");
  for (std::string line; std::getline(list, line);) {
    if (line.empty() || line.front() == '#') continue;
    const std::size_t comma = line.find(',');
    std::string name = line.substr(comma + 1);
    while (!name.empty() && (name.back() == '\r' || name.back() == ' ')) name.pop_back();
    files.emplace_back(std::stoll(line.substr(0, comma)), camera_folder + "/data/" + name);
  }
  return files;
}

}  // namespace

Device* Device::find(const std::string& path) {
  static std::map<std::string, Device> devices;
  const std::string prefix = "/dev/video-stand-in-";
  if (path.compare(0, prefix.size(), prefix) != 0 || setting("RECORDING").empty()) return nullptr;
  const std::string name = path.substr(prefix.size());
  if (name != "left" && name != "right" && name != "both") return nullptr;
  return &devices.try_emplace(name, name).first->second;
}

Device::Device(const std::string& name) : name_(name) {
  const std::string mav = setting("RECORDING") + "/mav0/";
  const auto left = listed(mav + "cam0"), right = listed(mav + "cam1");
  for (std::size_t i = 0; i < left.size(); ++i) {
    frames_.push_back({left[i].first, left[i].second, i < right.size() ? right[i].second : ""});
  }
  if (const auto range = split(setting("FRAMES"), ':'); range.size() == 2) {
    const auto first = static_cast<std::size_t>(std::stoi(range[0])),
               count = static_cast<std::size_t>(std::stoi(range[1]));
    frames_ = {frames_.begin() + static_cast<std::ptrdiff_t>(first),
               frames_.begin() + static_cast<std::ptrdiff_t>(std::min(first + count, frames_.size()))};
  }
  for (const auto& numbers : numbers_for(name, "LOSE")) lost_.insert(numbers.at(0));
  for (const auto& numbers : numbers_for(name, "DAMAGE")) damaged_.insert(numbers.at(0));
  for (const auto& numbers : numbers_for(name, "SKEW")) skew_us_ = numbers.at(0);
  for (const auto& numbers : numbers_for(name, "UNPLUG")) unplugging_ = {numbers.at(0), numbers.at(1)};
  if (!setting("SPEED").empty()) speed_ = std::stod(setting("SPEED"));
  has_monotonic_stamps_ = setting("STAMPS") == "monotonic";
  const std::string format = setting("FORMAT");
  format_ = format == "YUYV" ? V4L2_PIX_FMT_YUYV : format == "MJPG" ? V4L2_PIX_FMT_MJPEG : V4L2_PIX_FMT_GREY;
  const cv::Mat first = image_of(frames_.front());
  width_ = first.cols;
  height_ = first.rows;
  if (frames_.size() > 1) {
    rate_hz_ = 1e9 * static_cast<double>(frames_.size() - 1) /
               static_cast<double>(frames_.back().time_ns - frames_.front().time_ns);
  }
  controls = {
      {V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_APERTURE_PRIORITY}, {V4L2_CID_EXPOSURE_ABSOLUTE, 200}, {V4L2_CID_GAIN, 0}};
}

cv::Mat Device::image_of(const Frame& frame) const {
  const cv::Mat left = cv::imread(frame.left, cv::IMREAD_GRAYSCALE);
  if (name_ == "left") return left;
  const cv::Mat right = cv::imread(frame.right, cv::IMREAD_GRAYSCALE);
  if (name_ == "right") return right;
  cv::Mat both;
  cv::hconcat(left, right, both);
  return both;
}

std::size_t Device::bytes() const {
  return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 2;
}

bool Device::is_unplugged() {
  if (!unplugged_until_) return false;
  if (Clock::now() < *unplugged_until_) return true;
  unplugged_until_.reset();
  return false;
}

bool Device::open() {
  if (is_open_) return false;
  is_open_ = true;
  opened_at_ = static_cast<std::uint32_t>(next_);
  return true;
}

// State of a closed device; its recording continues.
Device Device::stopped() const {
  Device device = *this;
  device.is_open_ = device.is_streaming_ = false;
  device.queued_.clear();
  device.done_.clear();
  return device;
}

void Device::start() {
  is_streaming_ = true;
  if (!start_) start_ = Clock::now();
  opened_at_ = static_cast<std::uint32_t>(next_);
}

void Device::stop() {
  is_streaming_ = false;
  queued_.clear();
  done_.clear();
}

// Brings the state up to date: due frames go into buffers, or are lost without one.
void Device::advance() {
  while (start_ && next_ < frames_.size() && !is_unplugged()) {
    const bool is_paced = speed_ > 0.0;
    if (is_paced) {
      const double seconds = 1e-9 * static_cast<double>(frames_[next_].time_ns - frames_.front().time_ns) / speed_;
      if (Clock::now() < *start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)))
        return;
    }
    if (unplugging_ && static_cast<int>(next_) >= unplugging_->first) {
      unplugged_until_ = Clock::now() + std::chrono::milliseconds(unplugging_->second);
      unplugging_.reset();
      stop();
      return;
    }
    if (lost_.contains(static_cast<int>(next_))) {
      ++next_;
      continue;
    }
    const bool has_room = is_streaming_ && !queued_.empty();
    if (!has_room && !is_paced) return;
    if (has_room) {
      done_.emplace_back(queued_.front(), next_);
      queued_.pop_front();
    }
    ++next_;
  }
}

bool Device::is_ready() {
  advance();
  return is_unplugged() || !done_.empty();
}

std::optional<Device::Filled> Device::take(std::uint8_t* memory) {
  advance();
  if (done_.empty()) return std::nullopt;
  const auto [buffer, number] = done_.front();
  done_.pop_front();
  const Frame& frame = frames_[number];
  cv::Mat image = image_of(frame);
  if (controls[V4L2_CID_EXPOSURE_AUTO] == V4L2_EXPOSURE_MANUAL) {
    constexpr double kRight = 100.0;  // exposure at which the images were taken
    image.convertTo(image, CV_8U, controls[V4L2_CID_EXPOSURE_ABSOLUTE] / kRight);
  }
  std::vector<std::uint8_t> bytes(image.data, image.data + image.total());
  if (format_ == V4L2_PIX_FMT_MJPEG) cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, 95});
  if (format_ == V4L2_PIX_FMT_YUYV) {
    bytes.assign(2 * image.total(), 128);
    for (std::size_t i = 0; i < image.total(); ++i) bytes[2 * i] = image.data[i];
  }
  std::memcpy(memory, bytes.data(), std::min(bytes.size(), this->bytes()));
  Filled filled{buffer, static_cast<std::uint32_t>(number) - opened_at_, frame.time_ns / 1000 + skew_us_,
                damaged_.contains(static_cast<int>(number)), bytes.size()};
  if (has_monotonic_stamps_) {
    const auto start_us = std::chrono::duration_cast<std::chrono::microseconds>(start_->time_since_epoch()).count();
    const double since = 1e-3 * static_cast<double>(frame.time_ns - frames_.front().time_ns);
    filled.stamp_us = start_us + static_cast<std::int64_t>(speed_ > 0.0 ? since / speed_ : since) + skew_us_;
  }
  return filled;
}

}  // namespace byre::stand_in
