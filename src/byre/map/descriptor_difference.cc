#include "byre/map/descriptor_difference.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>

namespace byre {
namespace {

constexpr int kBits = 256;
constexpr unsigned kSkip = 15;  // this many equal bits without a differing one
constexpr std::uint8_t kWhole = 255;
constexpr std::size_t kMostHalves = 2 * sizeof(Descriptor);

// Half bytes, packed in pairs.
struct Halves {
  std::array<std::uint8_t, kMostHalves / 2> bytes{};
  std::size_t count = 0;
  bool is_full = false;

  void push(unsigned half) {
    if (count == kMostHalves) {
      is_full = true;
      return;
    }
    bytes[count / 2] = static_cast<std::uint8_t>(bytes[count / 2] | half << (count % 2 == 0 ? 0 : 4));
    ++count;
  }
};

Halves halves_of(const Descriptor& difference) {
  Halves halves;
  int next = 0;  // first bit not yet coded
  for (std::size_t word = 0; word < difference.size(); ++word) {
    for (std::uint64_t rest = difference[word]; rest != 0 && !halves.is_full; rest &= rest - 1) {
      const int bit = static_cast<int>(64 * word) + std::countr_zero(rest);
      for (; bit - next >= static_cast<int>(kSkip); next += kSkip) halves.push(kSkip);
      halves.push(static_cast<unsigned>(bit - next));
      next = bit + 1;
    }
  }
  return halves;
}

// Decodes half bytes, sixteen at a time, and takes their bytes from the reader at the end.
class HalfReader {
 public:
  explicit HalfReader(ByteReader& reader) : reader_(reader), bytes_(reader.rest()) {}

  unsigned next() {
    if (count_ == known_) look_further();
    const auto half = static_cast<unsigned>(ahead_ & 15u);
    ahead_ >>= 4;
    ++count_;
    return half;
  }
  std::size_t count() const { return count_; }
  bool leaves_something() const { return count_ % 2 == 1 && (ahead_ & 15u) != 0; }

  void take() { reader_.take((count_ + 1) / 2); }

 private:
  // Fails at the end of the bytes.
  void look_further() {
    const std::size_t size = std::min(sizeof(ahead_), bytes_.size() - known_ / 2);
    if (size == 0) {
      take();
      reader_.take(1);
    }
    ahead_ = 0;
    std::memcpy(&ahead_, bytes_.data() + known_ / 2, size);
    known_ += 2 * size;
  }

  ByteReader& reader_;
  std::span<const std::byte> bytes_;
  std::uint64_t ahead_ = 0;  // decoded half bytes not yet returned, the next one lowest
  std::size_t known_ = 0;
  std::size_t count_ = 0;
};

// Whether the half bytes exceed a descriptor, as they always do if more bits differ than half bytes fit.
bool is_stored_whole(const Descriptor& difference) {
  std::size_t differing = 0;
  for (const std::uint64_t word : difference) differing += static_cast<std::size_t>(std::popcount(word));
  return differing > kMostHalves || halves_of(difference).is_full;
}

}  // namespace

void write_difference(const Descriptor& descriptor, const Descriptor& from, ByteWriter& writer) {
  Descriptor difference;
  int differing = 0;
  for (std::size_t i = 0; i < difference.size(); ++i) {
    difference[i] = descriptor[i] ^ from[i];
    differing += std::popcount(difference[i]);
  }
  const Halves halves = halves_of(difference);
  if (halves.is_full) {
    writer.write(kWhole);
    writer.write_all<std::uint64_t>(descriptor);
    return;
  }
  writer.write(static_cast<std::uint8_t>(differing));
  writer.write_all(std::span<const std::uint8_t>(halves.bytes).first((halves.count + 1) / 2));
}

Descriptor read_difference(ByteReader& reader, const Descriptor& from) {
  const auto differing = reader.read<std::uint8_t>();
  Descriptor descriptor = from;
  if (differing == kWhole) {
    reader.read_all<std::uint64_t>(descriptor);
    Descriptor difference;
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = descriptor[i] ^ from[i];
    if (!is_stored_whole(difference)) reader.fail("has a descriptor stored in full although its difference is shorter");
    return descriptor;
  }
  HalfReader halves(reader);
  int bit = -1;
  for (int i = 0; i < differing; ++i) {
    unsigned skipped = 0;
    do {
      skipped = halves.next();
      bit += static_cast<int>(skipped);
    } while (skipped == kSkip && bit < kBits);
    if (++bit >= kBits) {
      halves.take();
      reader.fail("has a descriptor with more than " + std::to_string(kBits) + " bits");
    }
    descriptor[static_cast<std::size_t>(bit) / 64] ^= std::uint64_t{1} << (bit % 64);
  }
  halves.take();
  if (halves.leaves_something() || halves.count() > kMostHalves)
    reader.fail("has a descriptor that is not in canonical encoding");
  return descriptor;
}

}  // namespace byre
