#pragma once

#include "byre/image_condition.h"
#include "byre/map/map_file.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Data for keeping a map up to date, in the section `upkeep` that a map file may have. Read and written by upkeep only:
// a map that is loaded and saved loses it, so it never describes other points than those of its file.

// What the frames of a mission showed of a point of its offline map.
struct PointRecord {
  std::uint32_t expected = 0;   // frames in which it should have been seen
  std::uint32_t seen = 0;       // frames that showed its patch there
  std::uint32_t elsewhere = 0;  // frames that showed it away from its position
  // Sightings to expect if the point exists: sum of the share of points seen, over the frames in which it was expected.
  float due = 0.0f;
  bool operator==(const PointRecord&) const = default;
};

// Pose of a mission, as published.
struct PoseRecord {
  Timestamp time{};
  Pose map_from_body;
  std::array<float, 21> covariance{};  // upper triangle, row by row, of FrameReport::covariance
  std::uint8_t verdict = 0;            // number of the Verdict
  ImageCondition image;
};

// What a mission learned on its offline map, besides its online map. Offline points that online keyframes see are the
// last points of that map: copies with equal positions.
struct SessionRecord {
  std::uint64_t map_id = 0;         // id of the offline map
  std::uint32_t frames = 0;         // frames of the mission
  std::uint32_t trusted = 0;        // trusted frames
  std::uint32_t copied_points = 0;  // number of copies
  std::vector<PointRecord> points;  // by number of the offline point
  std::vector<PoseRecord> poses;    // by time
};

// Log-odds that a point still exists, in 16ths.
using Survival = std::int8_t;

struct MapUpkeep {
  std::vector<Survival> survival;        // by point of the file's own map; empty: unknown
  std::optional<SessionRecord> session;  // the file is a session: its map is the online map of a mission
};

// Content hash of a map file: the checksum of its header, which holds those of all sections. 16 hexadecimal digits as
// text. Throw InputError for a file that is no map.
std::uint64_t map_id(const std::filesystem::path& path);
std::uint64_t map_id(std::span<const std::byte> bytes, const std::string& name);
std::string to_text(std::uint64_t map_id);

// As write_map, with a section `upkeep`.
std::vector<std::byte> write_map(const StoredMap& stored, const MapUpkeep& upkeep);
// Empty without the section. Throws InputError like read_map.
MapUpkeep read_upkeep(std::span<const std::byte> bytes, const std::string& name);
// Saves as save_map does.
void save_map(const StoredMap& stored, const MapUpkeep& upkeep, const std::filesystem::path& path);

}  // namespace byre
