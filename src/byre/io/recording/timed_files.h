#pragma once

#include "byre/input_error.h"
#include "byre/io/recording/recording_index.h"
#include "byre/io/recording/restored_times.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// Existing files that belong to an input of several files, so that outputs do not overwrite them. Never throw; for an
// invalid input they list the files that it seems to have.

// Files of a recording of any format: images, lists, calibrations and truth.
std::vector<std::filesystem::path> files_of_recording(const std::filesystem::path& recording);

// Files of a floor plan in the sense of read_floor_plan: with its image, and the world file of the image.
std::vector<std::filesystem::path> files_of_floor_plan(const std::filesystem::path& plan);

// Files of a COLMAP model in its folder.
std::vector<std::filesystem::path> files_of_colmap_model(const std::filesystem::path& folder);

// Image files in a folder and its subfolders; for a file, the file itself.
std::vector<std::filesystem::path> images_below(const std::filesystem::path& folder);

// Path of the picks by which a map was registered: next to the map, with the extension ".picks.csv".
std::filesystem::path picks_path(const std::filesystem::path& map);

struct TimedFile {
  Timestamp time{};
  std::filesystem::path path;
};

inline constexpr Timestamp kDefaultPairTolerance = std::chrono::milliseconds(2);
inline constexpr Timestamp kDepthTolerance = std::chrono::milliseconds(20);  // between a depth image and its frame

// Largest time between the stamps of a pair.
Timestamp pair_tolerance(const OpenOptions& options);

// Files of a list with corrected times (restore_times).
struct RestoredFiles {
  std::vector<TimedFile> files;  // strictly increasing in time
  TimeCorrections corrections;
  SensorClock clock;
  std::vector<std::string> warnings;
};

// place: name of the list in warnings. other: clock of the left images, if the files are others. A duplicate line
// counts as a repeated stamp. Throws InputError if all files have one time.
RestoredFiles restore_files(const std::vector<TimedFile>& listed, const std::string& place,
                            const SensorClock& other = {});

// Throws InputError if more than one item was recorded, but all have one time. kept: number of items with a time.
void require_times(std::size_t kept, int repeated, const std::string& place);

// For each time the index of the nearest other one, if that is within the tolerance. Precondition: both ascend.
std::vector<std::optional<std::size_t>> match_by_time(const std::vector<Timestamp>& times,
                                                      const std::vector<Timestamp>& others, Timestamp tolerance);

// Frames of the left images, each with the right image within the tolerance, if any. Precondition: both ascend in time.
std::vector<FrameFiles> frames_of(const std::vector<TimedFile>& left, const std::vector<TimedFile>& right,
                                  Timestamp tolerance);

// Adds depth images to the frames: each image belongs to the nearest frame within 20 ms, and a frame takes the nearest
// of its images. Precondition: both ascend in time.
void add_depth(std::vector<FrameFiles>& frames, const std::vector<TimedFile>& depth);

// Throws InputError with this place if no frame has a right image.
void require_pairs(const std::vector<FrameFiles>& frames, const std::vector<TimedFile>& right, Timestamp tolerance,
                   const std::string& place);

// Error for a recording without any pair. Precondition: both ascend and are not empty.
InputError no_pairs_error(const std::string& place, const std::vector<Timestamp>& left,
                          const std::vector<Timestamp>& right, Timestamp tolerance);

}  // namespace byre
