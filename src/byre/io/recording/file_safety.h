#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Inputs and outputs of a command, and checks that no output overwrites an input or a file of another kind.

enum class InputKind : std::uint8_t {
  file,
  recording,  // recording, truth of one, or trajectory
  plan,       // floor plan with its image
  colmap_model,
  images,  // image files, or folders of them
  folder,  // folder of other things, which other arguments name
};

enum class OutputKind : std::uint8_t {
  map,
  refined_map,  // replaces the map that was read, unless another file is named
  updated_map,  // may replace the map that was read
  viewed_map,   // same as updated_map, with picks next to it
  trajectory,
  json,
  picture,  // format by extension: .svg or .png
  grid,     // PGM image with its description next to it
  video,
  point_cloud,
  mcap,
  calibration,
  vocabulary,
  colmap_model,
  recording,  // format by extension: an .mcap file, else a folder
  folder,
};

struct NamedInput {
  InputKind input{};
  std::string argument;
  std::filesystem::path path;
};

struct NamedOutput {
  OutputKind output{};
  std::string argument;
  std::filesystem::path path;
};

struct NamedFiles {
  std::vector<NamedInput> inputs;
  std::vector<NamedOutput> outputs;
};

// An output that must not be written, and its argument.
class FileConflict : public std::runtime_error {
 public:
  FileConflict(std::string argument, const std::string& message)
      : std::runtime_error(message), argument_(std::move(argument)) {}

  const std::string& argument() const { return argument_; }

 private:
  std::string argument_;
};

// Each throws FileConflict. require_not_read: an output is an input, under any name. require_distinct: two outputs are
// the same file. require_same_kinds: an output would replace a file of another kind. require_absent: an output exists.
void require_not_read(const NamedFiles& arguments);
void require_distinct(const std::vector<NamedOutput>& outputs);
void require_same_kinds(const std::vector<NamedOutput>& outputs);
void require_absent(const std::vector<NamedOutput>& outputs);

// Same as require_absent, for one file or folder of an argument.
void require_absent(const std::string& argument, const std::filesystem::path& file);

}  // namespace byre
