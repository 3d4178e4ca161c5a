#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <zlib.h>

namespace byre {

// The MCAP container, version 0: https://mcap.dev/spec. Numbers are little-endian.
inline constexpr std::array kMcapMagic = {std::byte{0x89}, std::byte{'M'}, std::byte{'C'},  std::byte{'A'},
                                          std::byte{'P'},  std::byte{'0'}, std::byte{'\r'}, std::byte{'\n'}};

enum class McapRecord : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::size_t kMcapRecordHead = 1 + 8;           // kind, length
inline constexpr std::size_t kMcapMessageHead = 2 + 4 + 8 + 8;  // channel, number, log time, publish time
inline constexpr std::size_t kMcapChunkHead = 8 + 8 + 8 + 4;    // start, end, size, checksum; compression follows
inline constexpr std::size_t kMcapFooter = 8 + 8 + 4;           // summary, summary offsets, checksum

inline std::uint32_t mcap_checksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace byre
