#pragma once

#include "byre/map/map_sections.h"
#include "byre/workers/made_once.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Reads a keyframe or a block of points from a map file when it is first looked at, and keeps it. Each is checked as
// when all of a map is read, with a checksum of its own.
class MapFileSource : public MapSource {
 public:
  struct File {
    ReadAt read_at;
    std::string name;                                // for messages
    std::array<std::size_t, kViewSections> views{};  // where sections begin
    std::size_t words_size = 0;                      // bytes
    std::uint64_t words_checksum = 0;
    std::size_t points = 0, observers = 0, lookup = 0;  // where sections begin
    std::uint32_t point_count = 0;
    std::vector<Rig> rigs;
    WordsHead words;
    bool has_packed_patches = true;  // from format 7 on
  };

  MapFileSource(File file, Lookup lookup);

  const Keyframe& keyframe(std::uint32_t number, const Keyframe& bare) const override;
  const ObservedPoint& point(std::uint32_t number) const override;
  ReusedVector<Covisible> covisible(std::uint32_t number) const override;
  void visit_words(const WordVisitor& visit) const override;
  const InputError* damage() const override { return damage_.find(0); }

 private:
  using Block = std::vector<ObservedPoint>;
  struct Part {
    std::size_t section;  // where it begins in the file
    PartPlace place;
    std::string_view name;  // the section's
  };

  // Fills in the bytes of the parts, one behind the other. Fails where they have another checksum.
  void read_parts(std::span<const Part> parts, std::uint64_t expected, std::vector<std::byte>& bytes) const;
  std::string place_of(std::string_view section) const;
  Keyframe read_keyframe(std::uint32_t number, const Keyframe& bare) const;
  Block read_block(std::uint32_t number) const;
  // The result of read(); if that throws InputError, notes the damage and returns the substitute.
  template <typename Read, typename Substitute>
  auto read_or(Read read, Substitute substitute) const;

  File file_;
  Lookup lookup_;
  MadeOnce<Keyframe> keyframes_;
  MadeOnce<Block> blocks_;
  MadeOnce<InputError> damage_{1};
};

}  // namespace byre
