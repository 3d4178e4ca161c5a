// Replacements of the system calls that access cameras, which add simulated devices to the real ones. For LD_PRELOAD.

#include "stand_in_device.h"

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

namespace byre::stand_in {
namespace {

// An open simulated device: a memory file, mapped by the program, and its Device.
struct Opened {
  Device* device = nullptr;
  std::uint8_t* memory = nullptr;
};

constexpr std::uint32_t kFlags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;

std::mutex mutex;
std::map<int, Opened> opened;  // by file descriptor

template <typename Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

std::size_t length_of(const Device& device) {
  constexpr std::size_t kPage = 4096;
  return (device.bytes() + kPage - 1) / kPage * kPage;
}

int failed(int error) {
  errno = error;
  return -1;
}

int open_device(Device& device) {
  if (device.is_unplugged()) return failed(ENOENT);
  if (!device.open()) return failed(EBUSY);
  const int number = memfd_create("stand-in", MFD_CLOEXEC);
  const std::size_t size = Device::kBuffers * length_of(device);
  if (number < 0 || ftruncate(number, static_cast<off_t>(size)) != 0) return -1;
  void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, number, 0);
  opened[number] = {&device, static_cast<std::uint8_t*>(memory)};
  return number;
}

int fill_format(const Device& device, v4l2_format& format) {
  v4l2_pix_format& pixels = format.fmt.pix;
  pixels.width = static_cast<std::uint32_t>(device.width());
  pixels.height = static_cast<std::uint32_t>(device.height());
  pixels.pixelformat = device.format();
  pixels.bytesperline = pixels.width * (device.format() == V4L2_PIX_FMT_YUYV ? 2 : 1);
  pixels.sizeimage = static_cast<std::uint32_t>(device.bytes());
  return 0;
}

int describe_device(const Device& device, unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto& capability = *static_cast<v4l2_capability*>(argument);
      std::strcpy(reinterpret_cast<char*>(capability.card), "Stand-in");
      std::strcpy(reinterpret_cast<char*>(capability.bus_info), "made up");
      capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      return 0;
    }
    case VIDIOC_ENUM_FMT: {
      auto& format = *static_cast<v4l2_fmtdesc*>(argument);
      format.pixelformat = format.index == 0 ? device.format() : V4L2_PIX_FMT_H264;
      std::strcpy(reinterpret_cast<char*>(format.description), format.index == 0 ? "As recorded" : "H.264");
      return format.index < 2 ? 0 : failed(EINVAL);
    }
    case VIDIOC_ENUM_FRAMESIZES: {
      auto& size = *static_cast<v4l2_frmsizeenum*>(argument);
      size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
      size.discrete = {static_cast<std::uint32_t>(device.width()), static_cast<std::uint32_t>(device.height())};
      return size.index == 0 ? 0 : failed(EINVAL);
    }
    case VIDIOC_ENUM_FRAMEINTERVALS: {
      auto& interval = *static_cast<v4l2_frmivalenum*>(argument);
      interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
      interval.discrete = {1000, static_cast<std::uint32_t>(device.rate_hz() * 1000 + 0.5)};
      return interval.index == 0 ? 0 : failed(EINVAL);
    }
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
      return fill_format(device, *static_cast<v4l2_format*>(argument));
    default: {
      auto& interval = static_cast<v4l2_streamparm*>(argument)->parm.capture.timeperframe;
      interval = {1000, static_cast<std::uint32_t>(device.rate_hz() * 1000 + 0.5)};
      return 0;
    }
  }
}

int control(Device& device, unsigned long request, void* argument) {
  if (request == VIDIOC_QUERYCTRL) {
    auto& query = *static_cast<v4l2_queryctrl*>(argument);
    if (!device.controls.contains(query.id)) return failed(EINVAL);
    query.minimum = query.id == V4L2_CID_EXPOSURE_ABSOLUTE ? 1 : 0;
    query.maximum = query.id == V4L2_CID_EXPOSURE_ABSOLUTE ? 10000 : 255;
    query.step = 1;
    query.flags = 0;
    return 0;
  }
  auto& setting = *static_cast<v4l2_control*>(argument);
  if (!device.controls.contains(setting.id)) return failed(EINVAL);
  int& value = device.controls[setting.id];
  (request == VIDIOC_S_CTRL ? value : setting.value) = request == VIDIOC_S_CTRL ? setting.value : value;
  return 0;
}

int stream(const Opened& open, unsigned long request, void* argument) {
  Device& device = *open.device;
  if (request == VIDIOC_STREAMON) return device.start(), 0;
  if (request == VIDIOC_STREAMOFF) return device.stop(), 0;
  if (request == VIDIOC_REQBUFS) {
    auto& count = static_cast<v4l2_requestbuffers*>(argument)->count;
    count = std::min(count, static_cast<std::uint32_t>(Device::kBuffers));
    return 0;
  }
  auto& buffer = *static_cast<v4l2_buffer*>(argument);
  const std::size_t length = length_of(device);
  if (request == VIDIOC_QUERYBUF) {
    buffer.length = static_cast<std::uint32_t>(length);
    buffer.m.offset = static_cast<std::uint32_t>(length * buffer.index);
    buffer.flags = kFlags;
    return 0;
  }
  if (request == VIDIOC_QBUF) return device.queue(buffer.index), 0;
  std::vector<std::uint8_t> image(device.bytes());
  const auto filled = device.take(image.data());
  if (!filled) return failed(device.is_unplugged() ? ENODEV : EAGAIN);
  std::memcpy(open.memory + length * filled->buffer, image.data(), image.size());
  buffer.index = filled->buffer;
  buffer.sequence = filled->sequence;
  buffer.bytesused = static_cast<std::uint32_t>(filled->bytes);
  buffer.flags = kFlags;
  if (filled->is_damaged) buffer.flags |= V4L2_BUF_FLAG_ERROR;
  buffer.timestamp = {filled->stamp_us / 1'000'000, filled->stamp_us % 1'000'000};
  return 0;
}

int call(const Opened& open, unsigned long request, void* argument) {
  if (open.device->is_unplugged()) return failed(ENODEV);
  switch (request) {
    case VIDIOC_QUERYCAP:
    case VIDIOC_ENUM_FMT:
    case VIDIOC_ENUM_FRAMESIZES:
    case VIDIOC_ENUM_FRAMEINTERVALS:
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return describe_device(*open.device, request, argument);
    case VIDIOC_QUERYCTRL:
    case VIDIOC_G_CTRL:
    case VIDIOC_S_CTRL:
      return control(*open.device, request, argument);
    case VIDIOC_REQBUFS:
    case VIDIOC_QUERYBUF:
    case VIDIOC_QBUF:
    case VIDIOC_DQBUF:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return stream(open, request, argument);
    default:
      return failed(ENOTTY);
  }
}

// Number of polled simulated devices with an event.
int ready_among(pollfd* waiting, nfds_t count) {
  const std::lock_guard lock(mutex);
  int ready = 0;
  for (nfds_t i = 0; i < count; ++i) {
    waiting[i].revents = 0;
    const auto found = opened.find(waiting[i].fd);
    if (found == opened.end() || !found->second.device->is_ready()) continue;
    waiting[i].revents = found->second.device->is_unplugged() ? POLLERR : POLLIN;
    ++ready;
  }
  return ready;
}

bool is_any_ours(const pollfd* waiting, nfds_t count) {
  const std::lock_guard lock(mutex);
  for (nfds_t i = 0; i < count; ++i) {
    if (opened.contains(waiting[i].fd)) return true;
  }
  return false;
}

}  // namespace
}  // namespace byre::stand_in

using namespace byre::stand_in;

extern "C" int open(const char* path, int flags, ...) {
  if (Device* const device = Device::find(path)) {
    const std::lock_guard lock(byre::stand_in::mutex);
    return open_device(*device);
  }
  va_list more;
  va_start(more, flags);
  const int mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, int) : 0;
  va_end(more);
  return real<int(const char*, int, ...)>("open")(path, flags, mode);
}

extern "C" int ioctl(int number, unsigned long request, ...) {
  va_list more;
  va_start(more, request);
  void* const argument = va_arg(more, void*);
  va_end(more);
  {
    const std::lock_guard lock(byre::stand_in::mutex);
    const auto found = opened.find(number);
    if (found != opened.end()) return call(found->second, request, argument);
  }
  return real<int(int, unsigned long, ...)>("ioctl")(number, request, argument);
}

extern "C" int poll(pollfd* waiting, nfds_t count, int milliseconds) {
  if (!is_any_ours(waiting, count)) return real<int(pollfd*, nfds_t, int)>("poll")(waiting, count, milliseconds);
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(milliseconds);
  for (;;) {
    if (const int ready = ready_among(waiting, count); ready > 0) return ready;
    if (milliseconds >= 0 && std::chrono::steady_clock::now() >= end) return 0;
    const timespec pause{0, 1'000'000};
    nanosleep(&pause, nullptr);
  }
}

extern "C" int close(int number) {
  {
    const std::lock_guard lock(byre::stand_in::mutex);
    const auto found = opened.find(number);
    if (found != opened.end()) {
      munmap(found->second.memory, Device::kBuffers * length_of(*found->second.device));
      found->second.device->close();
      opened.erase(found);
    }
  }
  return real<int(int)>("close")(number);
}
