#include "byre/camera/video_device.h"

#include "byre/input_error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <linux/videodev2.h>
#include <sys/mman.h>

namespace byre {
namespace {

constexpr std::uint32_t kBuffers = 8;  // images that the driver can buffer

v4l2_buffer buffer_at(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

Timestamp stamp_of(const v4l2_buffer& buffer) {
  return std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
}

[[noreturn]] void refuse(const std::filesystem::path& path, const char* what) {
  const int error = errno;
  throw InputError(
      path.string(), std::string(what) + ": " + std::strerror(error),
      error == EBUSY ? "stop the other program that uses the camera" : "disconnect and reconnect the camera");
}

}  // namespace

VideoDevice::VideoDevice(const std::filesystem::path& path, const VideoRequest& request)
    : path_(path), descriptor_(path), mode_(set_mode(descriptor_, request, path.string())) {
  try {
    map_buffers();
    start();
  } catch (const InputError&) {
    stop();
    throw;
  }
}

VideoDevice::~VideoDevice() {
  stop();
}

void VideoDevice::map_buffers() {
  v4l2_requestbuffers wanted{};
  wanted.count = kBuffers;
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = V4L2_MEMORY_MMAP;
  if (!descriptor_.call(VIDIOC_REQBUFS, &wanted)) refuse(path_, "provides no image buffers");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    v4l2_buffer buffer = buffer_at(i);
    if (!descriptor_.call(VIDIOC_QUERYBUF, &buffer)) refuse(path_, "provides no image buffers");
    void* const memory =
        mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_.number(), buffer.m.offset);
    if (memory == MAP_FAILED) refuse(path_, "provides no image buffers");
    buffers_.emplace_back(static_cast<std::uint8_t*>(memory), buffer.length);
  }
}

void VideoDevice::start() {
  for (std::uint32_t i = 0; i < buffers_.size(); ++i) {
    v4l2_buffer buffer = buffer_at(i);
    if (!descriptor_.call(VIDIOC_QBUF, &buffer)) refuse(path_, "does not accept a buffer");
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (!descriptor_.call(VIDIOC_STREAMON, &type)) refuse(path_, "does not start streaming");
}

void VideoDevice::stop() {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  descriptor_.call(VIDIOC_STREAMOFF, &type);  // fails for an unplugged device, which has stopped
  for (const std::span<std::uint8_t> buffer : buffers_) munmap(buffer.data(), buffer.size());
  buffers_.clear();
}

VideoDevice::Taken VideoDevice::take() {
  v4l2_buffer buffer = buffer_at(0);
  if (!descriptor_.call(VIDIOC_DQBUF, &buffer)) return {errno == EAGAIN ? Outcome::nothing : Outcome::gone};
  Taken taken{Outcome::damaged, buffer.sequence, moment_of(buffer.flags)};
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.index < buffers_.size()) {
    const std::span<const std::uint8_t> memory = buffers_[buffer.index];
    if (auto grey = grey_of(mode_.layout, memory.first(std::min<std::size_t>(buffer.bytesused, memory.size())))) {
      taken.outcome = Outcome::image;
      taken.image = {stamp_of(buffer), std::move(*grey)};
    }
  }
  if (!descriptor_.call(VIDIOC_QBUF, &buffer) && taken.outcome == Outcome::damaged) taken.outcome = Outcome::gone;
  return taken;
}

}  // namespace byre
