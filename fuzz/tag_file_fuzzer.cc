// Reads any bytes as a file of AprilTags and as notes of a map: the tags must be sound, or the file be refused by an
// InputError and the note ignored.

#include "byre/input_error.h"
#include "byre/map/mapped_tag.h"
#include "byre/tag_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <unistd.h>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

// Valid starts of mutations.
constexpr std::string_view kFile =
    "size: 0.16\nfamily: tag25h9\ntags:\n  - id: 3\n"
    "  - {id: 4, family: tag36h11, size: 0.3, position: [1, 2.5, 1e-1], heading_deg: 90, sigma_m: 0.1}\n";
constexpr std::string_view kNote = "size_m 0.2; map_from_tag_wxyz 1 0 0 0; position_m 1 -2.5 3e-1; sigma_m 0.01";

void read_file(const std::string& text) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_tags." + std::to_string(getpid()) + ".yaml");
  std::ofstream(path, std::ios::binary) << text;
  try {
    for (const byre::Tag& tag : byre::read_tags(path)) {
      if (!(tag.size > 0.0) || (tag.survey && !tag.survey->position.allFinite())) std::abort();
    }
  } catch (const byre::InputError&) {
  }
}

void read_note(const std::string& text) {
  for (const byre::MappedTag& tag : byre::stored_tags(std::map<std::string, std::string>{{"tag tag36h11 3", text}})) {
    const byre::Pose& pose = tag.map_from_tag;
    const bool is_rigid = pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1.0) < 1e-9;
    if (!is_rigid || !(tag.size > 0.0) || !(tag.sigma >= 0.0)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  read_file(text);
  read_note(text);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  constexpr std::size_t kSmallest = 12;
  if (size < kSmallest) {
    const std::string_view start = seed % 2 == 0 ? kFile : kNote;
    size = std::min(start.size(), max_size);
    std::memcpy(data, start.data(), size);
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
