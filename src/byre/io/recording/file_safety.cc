#include "byre/io/recording/file_safety.h"

#include "byre/base/output_file.h"
#include "byre/io/image/plan_file.h"
#include "byre/io/recording/timed_files.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <system_error>

#include <sys/stat.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Identity of a file or folder, independent of its name.
struct Identity {
  dev_t device{};
  ino_t number{};

  auto operator<=>(const Identity&) const = default;
};

std::optional<Identity> identity_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return std::nullopt;
  if (!S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)) return std::nullopt;
  return Identity{status.st_dev, status.st_ino};
}

// Terminals and pipes: reading and writing them do not interfere.
bool is_special(const fs::path& path) {
  std::error_code error;
  return fs::is_other(path, error);
}

std::vector<fs::path> files_of(const NamedInput& read) {
  switch (read.input) {
    case InputKind::file:
    case InputKind::folder:
      break;
    case InputKind::recording:
      return files_of_recording(read.path);
    case InputKind::plan:
      return files_of_floor_plan(read.path);
    case InputKind::colmap_model:
      return files_of_colmap_model(read.path);
    case InputKind::images:
      return images_below(read.path);
  }
  return {};
}

// Files written for an output, except those in folders that belong to the command.
std::vector<fs::path> files_of(const NamedOutput& written) {
  std::vector<fs::path> files;
  switch (written.output) {
    case OutputKind::recording:
    case OutputKind::folder:
      return {};
    case OutputKind::colmap_model:
      for (const char* const name : {"cameras", "images", "points3D"}) {
        for (const char* const suffix : {".bin", ".txt"}) files.push_back(written.path / (std::string(name) + suffix));
      }
      return files;
    case OutputKind::grid:
      return {written.path, plan_description(written.path)};
    case OutputKind::viewed_map:
      files.push_back(picks_path(written.path));
      [[fallthrough]];
    default:
      files.push_back(written.path);
      return files;
  }
}

// Maps files and folders to the argument that reads them: existing ones by identity, named ones also by name.
struct Owners {
  std::map<Identity, const NamedInput*> by_identity;
  std::map<fs::path, const NamedInput*> by_name;

  const NamedInput* find(const fs::path& file, OutputKind output) const {
    const auto identity = identity_of(file);
    const auto same = identity ? by_identity.find(*identity) : by_identity.end();
    if (same != by_identity.end()) return same->second;
    if (output == OutputKind::folder) return nullptr;  // may have the name of a protocol that comes with byre
    const auto named = by_name.find(target_of(file));
    return named != by_name.end() && !is_special(file) ? named->second : nullptr;
  }
};

Owners owners_of(const std::vector<NamedInput>& inputs) {
  Owners owners;
  for (const NamedInput& read : inputs) {
    std::error_code error;
    if (read.input == InputKind::file && fs::is_directory(read.path, error)) continue;  // names no file
    owners.by_name.emplace(target_of(read.path), &read);
    std::vector<fs::path> files = files_of(read);
    files.push_back(read.path);
    for (const fs::path& file : files) {
      if (const auto identity = identity_of(file)) owners.by_identity.emplace(*identity, &read);
    }
  }
  return owners;
}

// A map may replace the map that it was derived from.
bool may_be(const NamedOutput& written, const NamedInput& read) {
  constexpr std::array kInPlace = {OutputKind::refined_map, OutputKind::updated_map, OutputKind::viewed_map};
  if (std::ranges::count(kInPlace, written.output) == 0) return false;
  return read.input == InputKind::file && read.argument == "MAP";
}

void require_not_read(const NamedOutput& written, const fs::path& file, const Owners& owners) {
  const NamedInput* const owner = owners.find(file, written.output);
  if (owner == nullptr || may_be(written, *owner)) return;
  throw FileConflict(written.argument, file.string() + " is also an input (" + owner->argument +
                                           ") and cannot be overwritten: choose another file");
}

void require_not_read(const NamedOutput& written, const Owners& owners) {
  // A model may be written to the folder of a recording.
  std::error_code error;
  const bool is_shared_folder = written.output == OutputKind::colmap_model && fs::is_directory(written.path, error);
  if (!is_shared_folder) require_not_read(written, written.path, owners);
  for (const fs::path& file : files_of(written)) require_not_read(written, file, owners);
}

// Such as /dev/stdout, which may be a file that is appended to.
bool is_device_name(const fs::path& path) {
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/") || name.starts_with("/proc/");
}

bool is_svg(const fs::path& file) {
  return file.extension() == ".svg" || file.extension() == ".SVG";
}

FileContent content_written(const NamedOutput& written, const fs::path& file) {
  switch (written.output) {
    case OutputKind::viewed_map:
      return file == written.path ? FileContent::map : FileContent::table;
    case OutputKind::map:
    case OutputKind::refined_map:
    case OutputKind::updated_map:
      return FileContent::map;
    case OutputKind::trajectory:
      return FileContent::trajectory;
    case OutputKind::json:
      return FileContent::json;
    case OutputKind::picture:
      return is_svg(file) ? FileContent::svg : FileContent::png;
    case OutputKind::grid:
      return file == written.path ? FileContent::pgm : FileContent::yaml;
    case OutputKind::video:
      return FileContent::video;
    case OutputKind::point_cloud:
      return FileContent::point_cloud;
    case OutputKind::mcap:
      return FileContent::mcap;
    case OutputKind::calibration:
      return FileContent::yaml;
    case OutputKind::vocabulary:
      return FileContent::vocabulary;
    case OutputKind::colmap_model:
      return FileContent::colmap_model;
    case OutputKind::recording:
    case OutputKind::folder:
      break;
  }
  return FileContent::other;
}

void require_same_kind(const NamedOutput& written, const fs::path& file) {
  const auto content = content_of(file);
  const FileContent expected = content_written(written, file);
  if (!content || may_replace(*content, expected)) return;
  throw FileConflict(written.argument, file.string() + " exists and is not the expected kind of file (" +
                                           std::string(name_of(expected)) +
                                           "): choose another file, or remove the existing one first");
}

}  // namespace

void require_not_read(const NamedFiles& arguments) {
  if (arguments.outputs.empty()) return;  // listing inputs takes time
  const Owners owners = owners_of(arguments.inputs);
  for (const NamedOutput& written : arguments.outputs) require_not_read(written, owners);
}

void require_distinct(const std::vector<NamedOutput>& outputs) {
  std::set<fs::path> files;
  std::set<Identity> identities;
  const auto require_new = [](bool is_new, const fs::path& file) {
    if (!is_new) throw FileConflict(file.string(), "is given for two outputs");
  };
  for (const NamedOutput& written : outputs) {
    for (const fs::path& file : files_of(written)) {
      require_new(files.insert(target_of(file)).second, file);
      const auto identity = identity_of(file);
      if (identity) require_new(identities.insert(*identity).second, file);
    }
  }
}

void require_same_kinds(const std::vector<NamedOutput>& outputs) {
  for (const NamedOutput& written : outputs) {
    if (is_device_name(written.path)) continue;
    for (const fs::path& file : files_of(written)) require_same_kind(written, file);
  }
}

void require_absent(const std::vector<NamedOutput>& outputs) {
  for (const NamedOutput& written : outputs) {
    if (is_device_name(written.path)) continue;
    if (written.output == OutputKind::folder) require_absent(written.argument, written.path);
    for (const fs::path& file : files_of(written)) require_absent(written.argument, file);
  }
}

void require_absent(const std::string& argument, const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const bool is_full_folder = fs::is_directory(status) && !fs::is_empty(file, error);
  if (!fs::is_regular_file(status) && !is_full_folder) return;
  throw FileConflict(argument, file.string() + " exists and is not replaced because of --no-overwrite");
}

}  // namespace byre
