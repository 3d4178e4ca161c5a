#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace byre {

// An open device of Linux's Video4Linux, and the calls it takes (linux/videodev2.h).
class VideoDescriptor {
 public:
  // Throws InputError when there is none of that name, or it may not be opened.
  explicit VideoDescriptor(const std::filesystem::path& path);
  ~VideoDescriptor();
  VideoDescriptor(const VideoDescriptor&) = delete;
  VideoDescriptor& operator=(const VideoDescriptor&) = delete;

  int number() const { return number_; }
  // An ioctl, begun anew where a signal interrupts it. False when it failed: errno says why.
  bool call(unsigned long request, void* argument) const;

 private:
  int number_ = -1;  // constant after construction
};

// Waits until one of the devices has something to say, at most so long. Negative numbers are passed over.
void wait_for_any(std::span<const int> descriptors, int milliseconds);

}  // namespace byre
