#pragma once

#include <filesystem>
#include <span>

namespace byre {

// An open Video4Linux device, and its ioctl calls (linux/videodev2.h).
class VideoDescriptor {
 public:
  // Throws InputError if the device does not exist or cannot be opened.
  explicit VideoDescriptor(const std::filesystem::path& path);
  ~VideoDescriptor();
  VideoDescriptor(const VideoDescriptor&) = delete;
  VideoDescriptor& operator=(const VideoDescriptor&) = delete;

  int number() const { return number_; }
  // An ioctl, repeated if a signal interrupts it. False on failure, with the reason in errno.
  bool call(unsigned long request, void* argument) const;

 private:
  int number_ = -1;  // constant after construction
};

// Waits until one of the devices has data, for at most this long. Ignores negative descriptors.
void wait_for_any(std::span<const int> descriptors, int milliseconds);

}  // namespace byre
