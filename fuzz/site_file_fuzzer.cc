// Reads any bytes as a site file: maps and links must be sound, or the file be refused by an InputError.

#include "byre/input_error.h"
#include "byre/site.h"

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

// Valid start of mutations.
constexpr std::string_view kFile =
    "name: farm\nmaps:\n  - {name: a, map: a.byre, plan: a.yaml, height: 1, building: b}\n  - {name: c, map: c.byre}\n"
    "links:\n  - {kind: lift, from: a, to: c, centre: [1, 2, 3], radius: 1}\n"
    "  - {kind: gate, from: c, to: a, polygon: [[0, 0], [1, 0], [1, 1]]}\n";

bool is_sound(const byre::SiteLink& link, std::size_t maps) {
  const bool has_region = link.polygon.empty() ? link.radius > 0.0 : link.polygon.size() >= 3;
  return has_region && link.from < maps && link.to < maps && link.centre.allFinite() &&
         std::ranges::all_of(link.polygon, [](const auto& corner) { return corner.allFinite(); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("fuzz_site." + std::to_string(getpid()) + ".yaml");
  std::ofstream(path, std::ios::binary) << std::string(reinterpret_cast<const char*>(data), size);
  try {
    const byre::Site site = byre::read_site(path);
    if (site.maps.empty()) std::abort();
    for (const byre::SiteMap& map : site.maps) {
      if (map.name.empty() || !std::isfinite(map.height)) std::abort();
    }
    for (const byre::SiteLink& link : site.links) {
      if (!is_sound(link, site.maps.size())) std::abort();
    }
  } catch (const byre::InputError&) {
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int) {
  constexpr std::size_t kSmallest = 12;
  if (size < kSmallest) {
    size = std::min(kFile.size(), max_size);
    std::memcpy(data, kFile.data(), size);
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
