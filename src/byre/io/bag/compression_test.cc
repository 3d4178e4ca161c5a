#include "byre/io/bag/compression.h"

#include "byre/input_error.h"
#include "byre/io/bag/bag_scene.h"

#include <bzlib.h>
#include <gmock/gmock.h>

namespace byre {
namespace {

BagBytes pattern(std::size_t size) {
  BagBytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = std::byte(i * i >> 8);
  return bytes;
}

BagBytes bz2_of(BagBytes bytes) {
  auto size = static_cast<unsigned>(bytes.size() + 1000);
  bytes.reserve(1);  // avoids a null pointer
  BagBytes packed(size);
  BZ2_bzBuffToBuffCompress(reinterpret_cast<char*>(packed.data()), &size, reinterpret_cast<char*>(bytes.data()),
                           static_cast<unsigned>(bytes.size()), 9, 0, 0);
  packed.resize(size);
  return packed;
}

struct Packed {
  Compression compression;
  BagBytes bytes;
};

std::vector<Packed> packed(const BagBytes& bytes) {
  return {{Compression::none, bytes},
          {Compression::zstd, compress_zstd(bytes)},
          {Compression::lz4, lz4_frame(bytes)},
          {Compression::bz2, bz2_of(bytes)}};
}

TEST(Compression, DecompressesWhatWasCompressed) {
  for (const std::size_t size : {0u, 1u, 1000u, 300'000u}) {
    const BagBytes bytes = pattern(size);
    for (const auto& [compression, packed_bytes] : packed(bytes)) {
      const Decompressed result = decompress(compression, packed_bytes, size);
      EXPECT_EQ(result.bytes, bytes) << to_string(compression) << " " << size;
      EXPECT_TRUE(result.is_whole) << to_string(compression) << " " << size;
    }
  }
}

TEST(Compression, ReturnsAtMostTheRequestedBytes) {
  const BagBytes bytes = pattern(100'000);
  for (const auto& [compression, packed_bytes] : packed(bytes)) {
    const Decompressed result = decompress(compression, packed_bytes, 1000);
    EXPECT_EQ(result.bytes, BagBytes(bytes.begin(), bytes.begin() + 1000)) << to_string(compression);
    EXPECT_FALSE(result.is_whole) << to_string(compression);
  }
}

TEST(Compression, DistinguishesTruncatedFromCompleteData) {
  const BagBytes bytes = pattern(300'000);
  for (const auto& [compression, packed_bytes] : packed(bytes)) {
    if (compression == Compression::none) continue;
    const BagBytes cut(packed_bytes.begin(), packed_bytes.end() - 9);
    const Decompressed result = decompress(compression, cut, bytes.size());
    EXPECT_FALSE(result.is_whole) << to_string(compression);
    EXPECT_TRUE(std::equal(result.bytes.begin(), result.bytes.end(), bytes.begin())) << to_string(compression);
  }
}

TEST(Compression, UsesTheCompressionNamesOfBags) {
  EXPECT_EQ(parse_compression(""), Compression::none);
  EXPECT_EQ(parse_compression("none"), Compression::none);
  EXPECT_EQ(parse_compression("bz2"), Compression::bz2);
  EXPECT_EQ(parse_compression("rar"), std::nullopt);
}

class CompressedFile : public BagFolderTest {};

TEST_F(CompressedFile, DecompressesIntoAnotherFile) {
  const BagBytes bytes = pattern(5'000'000);
  BagBytes packed_bytes = compress_zstd(bytes);
  EXPECT_TRUE(decompress_zstd_file(write("file.zstd", packed_bytes), folder_ / "file", bytes.size()));
  EXPECT_EQ(std::filesystem::file_size(folder_ / "file"), bytes.size());
  packed_bytes.resize(packed_bytes.size() / 2);
  EXPECT_FALSE(decompress_zstd_file(write("cut.zstd", packed_bytes), folder_ / "cut", bytes.size()));
  EXPECT_LT(std::filesystem::file_size(folder_ / "cut"), bytes.size());
  EXPECT_THROW(decompress_zstd_file(folder_ / "file.zstd", folder_ / "absent" / "file", bytes.size()), InputError);
}

TEST_F(CompressedFile, RejectsContentBeyondTheLimit) {
  const BagBytes bytes(5'000'000);  // compressed to some hundred bytes
  const std::filesystem::path packed = write("file.zstd", compress_zstd(bytes));
  try {
    decompress_zstd_file(packed, folder_ / "file", bytes.size() - 1);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), packed.string());
    EXPECT_EQ(error.reason(), "exceeds 4 MB when decompressed");
  }
  EXPECT_TRUE(decompress_zstd_file(packed, folder_ / "file", bytes.size()));
}

}  // namespace
}  // namespace byre
