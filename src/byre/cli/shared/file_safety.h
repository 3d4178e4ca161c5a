#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace byre::cli {

// What a command line reads and writes, and the checks by which no command destroys what it reads or what is of another
// kind than it writes.

enum class Input : std::uint8_t {
  file,
  recording,  // recording, truth of one, or trajectory
  plan,       // floor plan with its image
  colmap_model,
  images,  // image files, or folders of them
  folder,  // folder of other things, which are named elsewhere
};

enum class Output : std::uint8_t {
  map,
  refined_map,  // the map that was read is replaced by it, unless another file is named
  updated_map,  // may be the map that was read
  viewed_map,   // map that may be the one that was read, and picks beside it
  trajectory,
  json,
  picture,  // as its name ends: .svg or .png
  video,
  point_cloud,
  mcap,
  calibration,
  vocabulary,
  colmap_model,
  recording,  // as its name ends: an .mcap file, else a folder
  folder,
};

struct Read {
  Input input{};
  std::string argument;
  std::filesystem::path path;  // as given
};

struct Written {
  Output output{};
  std::string argument;
  std::filesystem::path path;  // as given
};

struct Arguments {
  std::vector<Read> inputs;
  std::vector<Written> outputs;
};

// Each throws CLI::ValidationError: when an output is, by any name for it, something that is read; when two outputs are
// one file; when an output would replace what is of another kind; and when there is something that it would replace.
void require_not_read(const Arguments& arguments);
void require_distinct(const std::vector<Written>& outputs);
void require_same_kinds(const std::vector<Written>& outputs);
void require_absent(const std::vector<Written>& outputs);

// The last for a file or folder of an argument.
void require_absent(const std::string& argument, const std::filesystem::path& file);

}  // namespace byre::cli
