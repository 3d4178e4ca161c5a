// Reads any bytes as a bag or a message, chosen by the first byte: damage must be reported in the bag's content or by
// an InputError.

#include "byre/input_error.h"
#include "byre/io/bag/bag_scene.h"
#include "byre/io/bag/mcap_bag.h"
#include "byre/io/bag/ros1_bag.h"

#include <cstdint>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace byre {
namespace {

constexpr unsigned kKinds = 4;  // MCAP, ROS 1 bag, ROS 2 messages, ROS 1 messages

// A source of bytes that it does not own.
class BorrowedSource final : public ByteSource {
 public:
  explicit BorrowedSource(std::span<const std::byte> bytes) : size_(bytes.size()), source_(bytes) {}
  std::uint64_t size() const override { return size_; }
  void read(std::uint64_t begin, std::span<std::byte> piece) override { source_.read(begin, piece); }

 private:
  std::uint64_t size_;
  MemorySource source_;
};

// All messages listed in the content must be readable.
template <typename AnyBag>
void read_bag(std::span<const std::byte> bytes) {
  AnyBag bag(std::make_unique<BorrowedSource>(bytes), "fuzz", every_type);
  for (const BagMessage& message : bag.content().messages) bag.read(message);
}

template <ros::Message... Messages>
void read_as_every_message(std::span<const std::byte> bytes, ros::Encoding encoding) {
  const auto read = [&]<ros::Message M>(std::type_identity<M>) {
    try {
      const M message = ros::read_message<M>(bytes, encoding, "fuzz");
      ros::write_message(message, encoding);
    } catch (const InputError&) {
    }
  };
  (read(std::type_identity<Messages>()), ...);
}

void read_as(unsigned kind, std::span<const std::byte> bytes) {
  if (kind == 0) return read_bag<McapBag>(bytes);
  if (kind == 1) return read_bag<Ros1Bag>(bytes);
  read_as_every_message<ros::Image, ros::CompressedImage, ros::CameraInfo, ros::TFMessage, ros::Imu, ros::PointCloud2,
                        ros::Odometry, ros::TwistStamped, ros::TwistWithCovarianceStamped, ros::Path,
                        ros::OccupancyGrid, ros::DiagnosticArray>(bytes,
                                                                  kind == 2 ? ros::Encoding::cdr : ros::Encoding::ros1);
}

// Valid start of mutations, because random bytes never become a bag.
BagBytes original(unsigned seed) {
  const std::vector<SceneMessage> messages = scene_messages();
  const unsigned kind = seed % kKinds;
  const unsigned variant = seed / kKinds % 4;
  BagBytes bytes = {std::byte(kind)};
  const auto append = [&bytes](const BagBytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
  constexpr std::array kCompressions = {"-", "", "lz4", "zstd"};
  if (kind == 0) append(mcap_bytes(messages, kCompressions[variant]));
  if (kind == 1) append(ros1_bytes(messages, variant % 2 == 0 ? "none" : "lz4"));
  const ros::TFMessage transforms{{{{}, "a", {}}, {{}, "b", {}}}};
  const ros::Encoding encoding = kind == 2 ? ros::Encoding::cdr : ros::Encoding::ros1;
  if (kind >= 2) append(variant % 2 == 0 ? messages[0].bytes(encoding) : ros::write_message(transforms, encoding));
  return bytes;
}

}  // namespace
}  // namespace byre

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  try {
    byre::read_as(data[0] % byre::kKinds, std::as_bytes(std::span(data + 1, size - 1)));
  } catch (const byre::InputError&) {
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  constexpr std::size_t kSmallest = 24;
  if (size < kSmallest) {
    const byre::BagBytes bytes = byre::original(seed);
    size = std::min(bytes.size(), max_size);
    std::memcpy(data, bytes.data(), size);
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
