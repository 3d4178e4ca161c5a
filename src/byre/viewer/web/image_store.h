#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace byre {

// Encoded images of a run by frame number, in bounded memory: when full, every second image of the older half is
// dropped.
class ImageStore {
 public:
  explicit ImageStore(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void add(std::size_t frame, std::string bytes);

  // Image of the frame, else of the nearest stored frame; nullptr if empty.
  const std::string* find_nearest(std::size_t frame) const;

  std::size_t count() const { return images_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  void thin_out();

  std::size_t max_bytes_;  // constant after construction
  std::map<std::size_t, std::string> images_;
  std::size_t bytes_ = 0;  // total size of all images
};

}  // namespace byre
