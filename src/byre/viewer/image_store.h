#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace byre {

// Images of a run, as bytes by the number of their frame, in bounded memory: when they become too many, every second
// one of the older half is forgotten.
class ImageStore {
 public:
  explicit ImageStore(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  void add(std::size_t frame, std::string bytes);

  // The image of the frame or, where it has none, of the kept frame nearest to it; nullptr while there is none at all.
  const std::string* find_nearest(std::size_t frame) const;

  std::size_t count() const { return images_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  void thin_out();

  std::size_t max_bytes_;  // constant after construction
  std::map<std::size_t, std::string> images_;
  std::size_t bytes_ = 0;  // size of all images together
};

}  // namespace byre
