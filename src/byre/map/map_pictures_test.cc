#include "byre/features/jpeg.h"
#include "byre/input_error.h"
#include "byre/map/map_bytes_scene.h"
#include "byre/map/scaled_copy.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr KeyframeId kFirst{Origin::offline, 0};
constexpr KeyframeId kWithout{Origin::offline, 1};
constexpr KeyframeId kThird{Origin::offline, 2};

StoredMap scene() {
  return with_pictures(StoredMapScene().stored());
}

std::vector<std::vector<std::byte>> pictures_of(const MapGraph& map) {
  std::vector<std::vector<std::byte>> pictures;
  for (const KeyframeId id : map.keyframe_ids()) pictures.push_back(map.keyframe_header(id)->picture.jpeg());
  return pictures;
}

StoredMap opened(const MapBytes& bytes) {
  const auto read_at = [&bytes](std::size_t offset, std::span<std::byte> into) {
    std::ranges::copy(std::span(bytes).subspan(offset, into.size()), into.begin());
  };
  return open_map(read_at, bytes.size(), "barn.byre");
}

TEST(MapPictures, AreReadBack) {
  const MapBytes bytes = write_map(scene());
  const StoredMap read = read_map(bytes, "file");
  EXPECT_EQ(pictures_of(read.map), pictures_of(scene().map));
  EXPECT_EQ(read.map.find_keyframe(kThird)->picture.size(), 22u);
  EXPECT_FALSE(read.map.find_keyframe(kWithout)->picture);
  EXPECT_EQ(write_map(read), bytes);
  EXPECT_TRUE(find_faults(read).empty());
}

TEST(MapPictures, AreReadOnAccessFromAnOpenFile) {
  const MapBytes bytes = write_map(scene());
  const StoredMap map = opened(bytes);
  EXPECT_EQ(pictures_of(map.map), pictures_of(scene().map));
  EXPECT_EQ(map.map.find_keyframe(kThird)->picture.jpeg(), scene().map.find_keyframe(kThird)->picture.jpeg());
  EXPECT_EQ(write_map(map), bytes);
}

TEST(MapPictures, MakeFormat8) {
  EXPECT_EQ(value_at<std::uint32_t>(write_map(StoredMapScene().stored()), kFormatAt), 7u);
  const MapBytes bytes = write_map(scene());
  EXPECT_EQ(value_at<std::uint32_t>(bytes, kFormatAt), 8u);
  EXPECT_EQ(table_entry(bytes, kSections).name, "pictures");
  const MapBytes session = write_map(scene(), upkeep_of_session(scene()));
  EXPECT_EQ(sections_in(session), kSections + 2);
  EXPECT_TRUE(read_upkeep(session, "file").session);
  EXPECT_EQ(pictures_of(read_map(session, "file").map), pictures_of(scene().map));
}

TEST(MapPictures, LeaveTheOtherSectionsUnchanged) {
  MapBytes without = write_map(StoredMapScene().stored()), with = write_map(scene());
  for (std::size_t i = 0; i < kSections; ++i) {
    const std::string name = table_entry(without, i).name;
    EXPECT_TRUE(std::ranges::equal(section_bytes(without, name), section_bytes(with, name))) << name;
  }
}

TEST(MapPictures, StayWithTheirKeyframesInCopies) {
  const StoredMap stored = scene();
  const auto pictures = pictures_of(stored.map);
  EXPECT_EQ(pictures_of(scaled_copy(stored, 2.0).map), pictures);
  EXPECT_EQ(pictures_of(transformed_copy(stored, {1.0, {}}).map), pictures);
  EXPECT_EQ(pictures_of(offline_copy(stored.map)), pictures);
  MapGraph thinned = stored.map;
  thinned.remove_keyframe(kWithout);
  const MapGraph copy = offline_copy(std::move(thinned));
  EXPECT_EQ(copy.find_keyframe(kWithout)->picture.jpeg(), pictures[kThird.number]);
}

TEST(MapPictures, ThatWaitAreEncodedByTheOfflineCopy) {
  MapParts parts{StoredMapScene().stored().map.rigs(), {}, {}};
  Keyframe keyframe;
  keyframe.frame.picture = std::make_shared<const Image>(Image{32, 16, std::vector<std::uint8_t>(512, 90)});
  parts.keyframes.push_back(keyframe);
  const MapGraph copy = offline_copy(MapGraph(Origin::online, std::move(parts)));
  const std::optional<Image> decoded = decode_jpeg(copy.find_keyframe(kFirst)->picture.jpeg());
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->width, 32);
  EXPECT_FALSE(copy.find_keyframe(kFirst)->frame.picture);
}

TEST(MapPictures, DamagedOnDiskAreRefusedAndTheOthersAreRead) {
  MapBytes bytes = write_map(scene());
  bytes[section_of(bytes, "pictures").offset + section_of(bytes, "pictures").size - 1] ^= std::byte{1};
  EXPECT_THAT(refusal_of(bytes), HasSubstr("section pictures at byte "));
  const StoredMap map = opened(bytes);
  EXPECT_EQ(map.map.find_keyframe(kFirst)->picture.jpeg(), scene().map.find_keyframe(kFirst)->picture.jpeg());
  std::uint32_t last = 0;
  for (const KeyframeId id : map.map.keyframe_ids()) last = map.map.keyframe_header(id)->picture ? id.number : last;
  const StoredPicture& damaged = map.map.keyframe_header({Origin::offline, last})->picture;
  EXPECT_THROW(damaged.jpeg(), InputError);
  EXPECT_THROW(write_map(map), InputError);
}

TEST(MapPictures, OfInvalidSizesAreRefused) {
  const MapBytes sound = write_map(scene());
  const std::size_t table = section_of(sound, "pictures").offset;
  const auto refusal_with = [&](std::uint32_t size, std::uint64_t sum) {
    MapBytes bytes = sound;
    put_at(bytes, table, size);
    put_at(bytes, table + 4, sum);
    for (std::size_t i = 0; i < sections_in(bytes); ++i) {
      const TableEntry entry = table_entry(bytes, i);
      put_at(bytes, entry.at + 32, checksum(std::span(bytes).subspan(entry.offset, entry.size)));
    }
    put_at(bytes, header_checksum_at(bytes), checksum(std::span(bytes).first(header_checksum_at(bytes))));
    EXPECT_THROW(opened(bytes), InputError) << size;
    return refusal_of(bytes);
  };
  EXPECT_THAT(refusal_with(65537, 1), HasSubstr("more than 64 kB"));
  EXPECT_THAT(refusal_with(0, 1), HasSubstr("checksum of a missing picture"));
  EXPECT_THAT(refusal_with(60000, 1), StartsWith("barn.byre: section pictures at byte "));
  EXPECT_THAT(refusal_with(19, 1), StartsWith("barn.byre: section pictures at byte "));
}

TEST(MapPictures, EveryTruncationAndFlippedBitIsRefused) {
  const MapBytes sound = write_map(with_pictures(StoredMapScene(2, 4).stored()));
  for (std::size_t i = 0; i < sound.size(); ++i) {
    const auto end = sound.begin() + static_cast<std::ptrdiff_t>(i);
    EXPECT_THROW(read_map(MapBytes(sound.begin(), end), "file"), InputError) << i;
    MapBytes flipped = sound;
    flipped[i] ^= std::byte{static_cast<unsigned char>(1U << (i % 8U))};
    EXPECT_THROW(read_map(flipped, "file"), InputError) << i;
  }
}

}  // namespace
}  // namespace byre
