#include "byre/map/packed_steps.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <span>
#include <vector>

namespace byre {
namespace {

constexpr std::size_t kWidth = Patch::kSize;
constexpr std::size_t kPixels = kWidth * kWidth;
constexpr std::size_t kWholeBytes = sizeof(PatchSteps);
constexpr std::size_t kPlaneBytes = kPixels / 8;
constexpr std::uint8_t kMiddle = 8;  // half the steps; value assumed outside the patch
constexpr unsigned kPackings = 3;    // numbers of low-bit planes, 0 to 2; more never help
constexpr unsigned kLargest = 15;    // largest step and largest residual code

using Pixels = std::array<std::uint8_t, kPixels>;

// Prediction of a step from its left, upper and upper left neighbours: a plane through them, or one side of an edge.
std::uint8_t expected(std::uint8_t left, std::uint8_t above, std::uint8_t above_left) {
  const std::uint8_t low = std::min(left, above), high = std::max(left, above);
  return static_cast<std::uint8_t>(low + high - std::min(std::max(above_left, low), high));
}

// Residual modulo 16 as a non-negative code: d as 2 d, negative d as -2 d - 1; and its inverse.
std::uint8_t folded(std::uint8_t step, std::uint8_t from) {
  const auto difference = static_cast<unsigned>(step - from) & kLargest;
  return static_cast<std::uint8_t>(difference < kMiddle ? 2 * difference : 2 * (kLargest - difference) + 1);
}
std::uint8_t unfolded(std::uint8_t number, std::uint8_t from) {
  const auto difference = static_cast<std::uint8_t>((number >> 1) ^ -(number & 1));
  return static_cast<std::uint8_t>((from + difference) & kLargest);
}

Pixels numbers_of(const PatchSteps& steps) {
  constexpr std::size_t kFramed = kWidth + 1;  // with a border above and to the left of the patch
  std::array<std::uint8_t, kFramed * kFramed> framed;
  framed.fill(kMiddle);
  Pixels numbers;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const std::size_t at = (i / kWidth + 1) * kFramed + i % kWidth + 1;
    framed[at] = static_cast<std::uint8_t>(steps[i / 2] >> (4 * (i % 2)) & kLargest);
    numbers[i] = folded(framed[at], expected(framed[at - 1], framed[at - kFramed], framed[at - kFramed - 1]));
  }
  return numbers;
}

// Works along anti-diagonals, whose pixels depend on the two previous ones only, so that the loops are vectorised.
PatchSteps steps_of(const Pixels& numbers) {
  constexpr std::size_t kDiagonals = 2 * kWidth - 1;
  using Diagonal = std::array<std::uint8_t, kWidth + 1>;  // by row, with a first entry above the patch
  std::array<Diagonal, kDiagonals + 2> diagonals;
  for (Diagonal& diagonal : diagonals) diagonal.fill(kMiddle);
  for (std::size_t i = 0; i < kPixels; ++i) diagonals[2 + i / kWidth + i % kWidth][1 + i / kWidth] = numbers[i];
  for (std::size_t i = 2; i < diagonals.size(); ++i) {
    const Diagonal& before = diagonals[i - 1];
    const Diagonal& first = diagonals[i - 2];
    Diagonal steps;
    for (std::size_t row = 1; row <= kWidth; ++row) {
      steps[row] = unfolded(diagonals[i][row], expected(before[row], before[row - 1], first[row - 1]));
    }
    const std::size_t column = i - 2;  // column at which the diagonal meets the first row
    for (std::size_t row = 1 + (column < kWidth ? 0 : column + 1 - kWidth); row <= std::min(kWidth, 1 + column);
         ++row) {
      diagonals[i][row] = steps[row];
    }
  }
  PatchSteps steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t row = 2 * i / kWidth, column = 2 * i % kWidth;
    steps[i] =
        static_cast<std::uint8_t>(diagonals[2 + row + column][1 + row] | diagonals[3 + row + column][1 + row] << 4);
  }
  return steps;
}

// The shortest code of the residuals: a number of low-bit planes, and the high bits in unary code.
struct Packing {
  unsigned planes = 0;
  std::size_t bytes = 0;
  bool gains() const { return bytes < kWholeBytes; }
};

Packing best_packing(const Pixels& numbers) {
  Packing best;
  for (unsigned planes = 0; planes < kPackings; ++planes) {
    unsigned bits = kPixels;
    for (const std::uint8_t number : numbers) bits += static_cast<unsigned>(number >> planes);
    const std::size_t bytes = 1 + planes * kPlaneBytes + (bits + 7) / 8;
    if (planes == 0 || bytes < best.bytes) best = {planes, bytes};
  }
  return best;
}

using Plane = std::array<std::uint8_t, kPlaneBytes>;

Plane plane_of(const Pixels& numbers, unsigned bit) {
  Plane plane{};
  for (std::size_t i = 0; i < kPixels; ++i) {
    plane[i / 8] = static_cast<std::uint8_t>(plane[i / 8] | (numbers[i] >> bit & 1u) << (i % 8));
  }
  return plane;
}

void add_plane(const Plane& plane, unsigned bit, Pixels& numbers) {
  for (std::size_t i = 0; i < kPixels; ++i) {
    numbers[i] = static_cast<std::uint8_t>(numbers[i] | (plane[i / 8] >> (i % 8) & 1u) << bit);
  }
}

// Reads the high bits of each residual, as zeros followed by a one. Fails for invalid bytes.
void add_counted(std::span<const std::byte> bytes, unsigned low_bits, const ByteReader& reader, Pixels& numbers) {
  std::size_t pixel = 0, next = 0, largest = 0;
  for (std::size_t begin = 0; begin < bytes.size(); begin += sizeof(std::uint64_t)) {
    std::uint64_t rest = 0;
    std::memcpy(&rest, bytes.data() + begin, std::min(sizeof(rest), bytes.size() - begin));
    for (; rest != 0 && pixel < kPixels; rest &= rest - 1) {
      const std::size_t one = 8 * begin + static_cast<std::size_t>(std::countr_zero(rest));
      const std::size_t zeros = one - next;
      largest = std::max(largest, zeros);
      numbers[pixel] = static_cast<std::uint8_t>(numbers[pixel] | zeros << low_bits);
      next = one + 1;
      ++pixel;
    }
    if (rest != 0) reader.fail("has a patch with too many pixels");
  }
  if (pixel < kPixels || largest > kLargest >> low_bits) reader.fail("has an invalid patch");
}

PatchSteps unpacked(std::span<const std::byte> packed, const ByteReader& reader) {
  const unsigned planes = packed.empty() ? kPackings : std::to_integer<unsigned>(packed[0]);
  const std::size_t counted_from = 1 + planes * kPlaneBytes;
  if (planes >= kPackings || packed.size() <= counted_from) reader.fail("has an invalid patch");
  Pixels numbers{};
  for (unsigned bit = 0; bit < planes; ++bit) {
    Plane plane;
    std::memcpy(plane.data(), packed.data() + 1 + bit * kPlaneBytes, kPlaneBytes);
    add_plane(plane, bit, numbers);
  }
  add_counted(packed.subspan(counted_from), planes, reader, numbers);
  if (best_packing(numbers).planes != planes || packed.back() == std::byte{0}) {
    reader.fail("has a patch that is not in canonical encoding");
  }
  return steps_of(numbers);
}

std::vector<std::byte> counted(const Pixels& numbers, unsigned low_bits, std::size_t bytes) {
  std::vector<std::byte> result(bytes);
  std::size_t bit = 0;
  for (const std::uint8_t number : numbers) {
    bit += static_cast<std::size_t>(number >> low_bits);
    result[bit / 8] |= static_cast<std::byte>(1u << (bit % 8));
    ++bit;
  }
  return result;
}

}  // namespace

void write_packed_steps(const PatchSteps& steps, ByteWriter& writer) {
  const Pixels numbers = numbers_of(steps);
  const Packing packing = best_packing(numbers);
  if (!packing.gains()) {
    writer.write(static_cast<std::uint8_t>(kWholeBytes));
    writer.write_all<std::uint8_t>(steps);
    return;
  }
  writer.write(static_cast<std::uint8_t>(packing.bytes));
  writer.write(static_cast<std::uint8_t>(packing.planes));
  for (unsigned bit = 0; bit < packing.planes; ++bit) writer.write_all<std::uint8_t>(plane_of(numbers, bit));
  writer.write_bytes(counted(numbers, packing.planes, packing.bytes - 1 - packing.planes * kPlaneBytes));
}

PatchSteps read_packed_steps(ByteReader& reader) {
  const auto bytes = std::size_t{reader.read<std::uint8_t>()};
  if (bytes > kWholeBytes) reader.fail("has a patch with more bytes than its steps");
  const std::span<const std::byte> packed = reader.take(bytes);
  if (bytes < kWholeBytes) return unpacked(packed, reader);
  PatchSteps steps;
  std::memcpy(steps.data(), packed.data(), kWholeBytes);
  if (best_packing(numbers_of(steps)).gains()) reader.fail("has a patch that is not in canonical encoding");
  return steps;
}

void skip_packed_steps(ByteReader& reader) {
  reader.take(reader.read<std::uint8_t>());
}

}  // namespace byre
