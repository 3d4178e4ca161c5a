#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// What a command reads and writes, and the checks by which none destroys what it reads or what is of another kind than
// it writes.

enum class InputKind : std::uint8_t {
  file,
  recording,  // recording, truth of one, or trajectory
  plan,       // floor plan with its image
  colmap_model,
  images,  // image files, or folders of them
  folder,  // folder of other things, which are named elsewhere
};

enum class OutputKind : std::uint8_t {
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

struct NamedInput {
  InputKind input{};
  std::string argument;
  std::filesystem::path path;  // as given
};

struct NamedOutput {
  OutputKind output{};
  std::string argument;
  std::filesystem::path path;  // as given
};

struct NamedFiles {
  std::vector<NamedInput> inputs;
  std::vector<NamedOutput> outputs;
};

// A file that may not be written, and the argument that names it.
class FileConflict : public std::runtime_error {
 public:
  FileConflict(std::string argument, const std::string& message)
      : std::runtime_error(message), argument_(std::move(argument)) {}

  const std::string& argument() const { return argument_; }

 private:
  std::string argument_;
};

// Each throws FileConflict: when an output is, by any name for it, something that is read; when two outputs are
// one file; when an output would replace what is of another kind; and when there is something that it would replace.
void require_not_read(const NamedFiles& arguments);
void require_distinct(const std::vector<NamedOutput>& outputs);
void require_same_kinds(const std::vector<NamedOutput>& outputs);
void require_absent(const std::vector<NamedOutput>& outputs);

// The last for a file or folder of an argument.
void require_absent(const std::string& argument, const std::filesystem::path& file);

}  // namespace byre
