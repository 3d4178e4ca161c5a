// Truncated or modified bags: sound parts are read, the rest is reported or refused with an InputError. Seeds are
// fixed.

#include "byre/input_error.h"
#include "byre/io/bag/bag.h"
#include "byre/io/bag/bag_scene.h"
#include "byre/io/bag/mcap_bag.h"
#include "byre/io/bag/ros1_bag.h"

#include <fstream>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Byte source that owns its bytes.
class OwnedSource final : public ByteSource {
 public:
  explicit OwnedSource(BagBytes bytes) : bytes_(std::move(bytes)), source_(bytes_) {}
  std::uint64_t size() const override { return bytes_.size(); }
  void read(std::uint64_t begin, std::span<std::byte> piece) override { source_.read(begin, piece); }

 private:
  BagBytes bytes_;
  MemorySource source_;
};

using Open = std::function<std::unique_ptr<Bag>(const BagBytes&)>;

std::unique_ptr<Bag> open_mcap(const BagBytes& bytes) {
  return std::make_unique<McapBag>(std::make_unique<OwnedSource>(bytes), "test", every_type);
}

std::unique_ptr<Bag> open_ros1(const BagBytes& bytes) {
  return std::make_unique<Ros1Bag>(std::make_unique<OwnedSource>(bytes), "test", every_type);
}

struct Kind {
  const char* name;
  BagBytes bytes;
  Open open;
};

std::vector<Kind> kinds() {
  return {{"mcap without chunks", mcap_bytes(scene_messages(), "-"), open_mcap},
          {"mcap, chunks as they are", mcap_bytes(scene_messages(), ""), open_mcap},
          {"mcap, lz4", mcap_bytes(scene_messages(), "lz4"), open_mcap},
          {"mcap, zstd", mcap_bytes(scene_messages(), "zstd"), open_mcap},
          {"rosbag", ros1_bytes(scene_messages()), open_ros1},
          {"rosbag, lz4", ros1_bytes(scene_messages(), "lz4"), open_ros1}};
}

// Number of readable messages; empty if the bag was refused.
std::optional<std::size_t> read_all(const Open& open, const BagBytes& bytes) {
  try {
    return readable_messages(*open(bytes)).size();
  } catch (const InputError&) {
    return std::nullopt;
  }
}

// Changes a few bytes, to random values or to values typical of lengths.
BagBytes mutant_of(BagBytes bytes, std::mt19937& random) {
  const auto below = [&random](std::size_t end) { return random() % end; };
  constexpr std::array<unsigned, 6> kSpecial = {0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF};
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    std::byte& changed = bytes[below(bytes.size())];
    changed = below(2) == 0 ? std::byte(kSpecial[below(kSpecial.size())]) : std::byte(random());
  }
  if (below(4) == 0) bytes.resize(below(bytes.size()));
  return bytes;
}

TEST(DamagedBag, ReadsATruncatedBagUpToTheCut) {
  for (const Kind& kind : kinds()) {
    std::size_t before = 0;
    for (std::size_t size = 16; size <= kind.bytes.size(); ++size) {
      const std::optional<std::size_t> messages =
          read_all(kind.open, {kind.bytes.begin(), kind.bytes.begin() + static_cast<std::ptrdiff_t>(size)});
      ASSERT_TRUE(messages.has_value()) << kind.name << " cut to " << size;
      ASSERT_GE(*messages, before) << kind.name << " cut to " << size;
      before = *messages;
    }
    EXPECT_EQ(before, 18u) << kind.name;
  }
}

TEST(DamagedBag, ReturnsTheMessagesBeforeTheCut) {
  // Without compression each message is readable once its last byte is present.
  const BagBytes bytes = mcap_bytes(scene_messages(), "-");
  EXPECT_EQ(read_all(open_mcap, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() * 3 / 4)}),
            std::optional<std::size_t>(12));
}

TEST(DamagedBag, ReadsOrRejectsRandomDamageSafely) {
  std::mt19937 random(7);
  std::size_t read = 0, refused = 0;
  for (const Kind& kind : kinds()) {
    for (int i = 0; i < 1500; ++i) ++(read_all(kind.open, mutant_of(kind.bytes, random)) ? read : refused);
  }
  EXPECT_GT(read, 1000u);
  EXPECT_LT(refused, 2000u);
}

class DamagedDatabase : public BagFolderTest {};

TEST_F(DamagedDatabase, ReadsOrRejectsRandomDamageSafely) {
  write_db3(folder_ / "scene.db3", scene_messages());
  std::ifstream file(folder_ / "scene.db3", std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  std::mt19937 random(11);
  const Open open = [this](const BagBytes& mutant) { return open_bag(write("mutant.db3", mutant), every_type); };
  std::size_t read = 0;
  for (int i = 0; i < 250; ++i) read += read_all(open, mutant_of({bytes.begin(), bytes.end()}, random)) ? 1 : 0;
  EXPECT_GT(read, 25u);
  EXPECT_LT(read, 250u);
}

TEST_F(DamagedDatabase, ReportsTruncation) {
  std::vector<SceneMessage> messages;
  for (int i = 0; i < 60; ++i) {
    for (SceneMessage& message : scene_messages()) messages.push_back(std::move(message));
  }
  write_db3(folder_ / "scene.db3", messages);
  fs::resize_file(folder_ / "scene.db3", fs::file_size(folder_ / "scene.db3") / 2);
  try {
    const auto bag = open_bag(folder_ / "scene.db3", every_type);
    EXPECT_LT(bag->content().message_count, messages.size());
    EXPECT_THAT(bag->content().damage, testing::ElementsAre(testing::HasSubstr("is damaged")));
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("scene.db3"));
  }
}

}  // namespace
}  // namespace byre
