#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace byre {

// Small grey picture of a keyframe as a JPEG file, which stays in its file until read. Copies share it.
class StoredPicture {
 public:
  using Read = std::function<std::vector<std::byte>()>;

  static constexpr std::size_t kMaxBytes = 1 << 16;  // largest picture in a map file
  static constexpr std::size_t kMadeBytes = 12'000;  // largest new picture

  StoredPicture() = default;  // none
  // read: returns `size` bytes, from several threads at once.
  StoredPicture(std::size_t size, Read read) : stored_(std::make_shared<const Stored>(Stored{size, std::move(read)})) {}
  // No picture for empty bytes.
  explicit StoredPicture(std::vector<std::byte> jpeg) {
    if (jpeg.empty()) return;
    const std::size_t size = jpeg.size();
    *this = StoredPicture(size, [jpeg = std::move(jpeg)] { return jpeg; });
  }

  explicit operator bool() const { return stored_ != nullptr; }
  std::size_t size() const { return stored_ ? stored_->size : 0; }  // bytes
  // Empty without a picture. Throws InputError if its map file is damaged.
  std::vector<std::byte> jpeg() const { return stored_ ? stored_->read() : std::vector<std::byte>(); }

 private:
  struct Stored {
    std::size_t size = 0;
    Read read;
  };

  std::shared_ptr<const Stored> stored_;
};

}  // namespace byre
