#include "byre/camera/video_descriptor.h"

#include "byre/input_error.h"

#include <cerrno>
#include <cstring>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace byre {
namespace {

const char* remedy_for(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "connect the camera, or give another one, see \"byre camera list\"";
    case EACCES:
    case EPERM:
      return "join the group video: sudo adduser $USER video, then log in again";
    case EBUSY:
      return "stop the other program that uses the camera";
    default:
      return "";
  }
}

}  // namespace

VideoDescriptor::VideoDescriptor(const std::filesystem::path& path)
    : number_(open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)) {
  if (number_ >= 0) return;
  const int error = errno;
  throw InputError(path.string(), std::string("cannot be opened: ") + std::strerror(error), remedy_for(error));
}

VideoDescriptor::~VideoDescriptor() {
  close(number_);
}

bool VideoDescriptor::call(unsigned long request, void* argument) const {
  int result = 0;
  do {
    result = ioctl(number_, request, argument);
  } while (result == -1 && errno == EINTR);
  return result != -1;
}

void wait_for_any(std::span<const int> descriptors, int milliseconds) {
  std::vector<pollfd> waiting;
  for (const int descriptor : descriptors) waiting.push_back({descriptor, POLLIN, 0});
  poll(waiting.data(), waiting.size(), milliseconds);
}

}  // namespace byre
