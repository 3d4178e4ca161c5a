#pragma once

// Descriptors in given clusters, for the tests of this room.

#include "byre/features.h"

#include <random>
#include <vector>

namespace byre {

inline Descriptor random_descriptor(std::mt19937_64& random) {
  return {random(), random(), random(), random()};
}

// The descriptor with flipped_bits different bits flipped.
inline Descriptor with_noise(Descriptor descriptor, int flipped_bits, std::mt19937_64& random) {
  Descriptor flips{};
  for (int flipped = 0; flipped < flipped_bits;) {
    const std::uint64_t bit = random() % 256;
    std::uint64_t& part = flips[bit / 64];
    const std::uint64_t mask = std::uint64_t{1} << bit % 64;
    if ((part & mask) != 0) continue;
    part |= mask;
    ++flipped;
  }
  for (std::size_t i = 0; i < descriptor.size(); ++i) descriptor[i] ^= flips[i];
  return descriptor;
}

inline std::vector<Descriptor> random_descriptors(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < count; ++i) descriptors.push_back(random_descriptor(random));
  return descriptors;
}

// Families of consecutive descriptors that differ in less than 40 bits; different families differ in about 128.
inline std::vector<Descriptor> descriptor_families(int families, int members, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors;
  for (int family = 0; family < families; ++family) {
    const Descriptor head = random_descriptor(random);
    for (int i = 0; i < members; ++i) descriptors.push_back(with_noise(head, 19, random));
  }
  return descriptors;
}

// Each image contains every centre `copies` times, with flipped_bits random bits flipped.
inline std::vector<std::vector<Descriptor>> noisy_images(const std::vector<Descriptor>& centres, int image_count,
                                                         int copies, int flipped_bits, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::vector<Descriptor>> images(static_cast<std::size_t>(image_count));
  for (std::vector<Descriptor>& image : images) {
    for (const Descriptor& centre : centres) {
      for (int i = 0; i < copies; ++i) image.push_back(with_noise(centre, flipped_bits, random));
    }
  }
  return images;
}

}  // namespace byre
