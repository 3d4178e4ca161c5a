#pragma once

#include "byre/base/lazy_array.h"
#include "byre/base/scratch_memory.h"
#include "byre/map/map_sections.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Reads keyframes and blocks of points from a map file on first access, with the checks of read_map, and keeps them.
class MapFileSource : public MapSource {
 public:
  struct File {
    ReadAt read_at;
    std::string name;                                // for messages
    std::array<std::size_t, kViewSections> views{};  // offsets of the sections
    std::size_t words_size = 0;                      // bytes
    std::uint64_t words_checksum = 0;
    std::size_t points = 0, observers = 0, lookup = 0;  // offsets of the sections
    std::uint32_t point_count = 0;
    std::vector<Rig> rigs;
    WordsHead words;
  };

  MapFileSource(File file, Lookup lookup);

  const Keyframe& keyframe(std::uint32_t number, const Keyframe& header) const override;
  const ObservedPoint& point(std::uint32_t number) const override;
  ScratchVector<Covisible> covisible(std::uint32_t number) const override;
  void visit_words(const WordVisitor& visit) const override;
  const InputError* damage() const override { return damage_.find(0); }

 private:
  using Block = std::vector<ObservedPoint>;
  struct Part {
    std::size_t section;  // offset of the section in the file
    ByteRange place;
    std::string_view name;  // name of the section
  };

  // Reads the concatenated bytes of the parts. Fails if their checksum is not the expected one.
  ScratchVector<std::byte> read_parts(std::span<const Part> parts, std::uint64_t expected) const;
  std::string place_of(std::string_view section) const;
  Keyframe read_keyframe(std::uint32_t number, const Keyframe& header) const;
  Block read_block(std::uint32_t number) const;
  // The result of read(); if that throws InputError, records the damage and returns the substitute.
  template <typename Read, typename Substitute>
  auto read_or(Read read, Substitute substitute) const;

  File file_;
  Lookup lookup_;
  LazyArray<Keyframe> keyframes_;
  LazyArray<Block> blocks_;
  LazyArray<InputError> damage_{1};
};

}  // namespace byre
