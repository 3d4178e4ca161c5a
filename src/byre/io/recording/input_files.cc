#include "byre/io/recording/input_files.h"

#include "byre/base/text_file.h"
#include "byre/floor_plan.h"
#include "byre/io/bag/bag.h"
#include "byre/io/image/image_names.h"
#include "byre/recording.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <system_error>

#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

void add_if_exists(const fs::path& file, Files& files) {
  if (is_file(file)) files.push_back(file);
}

// Follows links to a limited depth, because links may be circular.
void add_below(const fs::path& folder, Files& files, int levels = 4) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (levels > 1 && is_folder(entry->path())) add_below(entry->path(), files, levels - 1);
    add_if_exists(entry->path(), files);
  }
}

// Files in a list in TUM's format; their paths may be anywhere.
void add_listed(const fs::path& list, Files& files) {
  try {
    if (!is_file(list)) return;
    for (const TextLine& line : read_lines(list)) {
      const std::vector<std::string_view> fields = split_fields(line.text);
      if (fields.size() >= 2) add_if_exists(list.parent_path() / fields[1], files);
    }
  } catch (const std::exception&) {  // not a list, so it names nothing
    return;
  }
}

bool is_folder_of_sensor(const fs::path& folder) {
  return is_file(folder / "sensor.yaml") || is_file(folder / "data.csv");
}

void add_euroc(const fs::path& mav, Files& files) {
  add_if_exists(mav / "body.yaml", files);
  std::error_code error;
  for (fs::directory_iterator entry(mav, error), end; !error && entry != end; entry.increment(error)) {
    if (is_folder_of_sensor(entry->path())) add_below(entry->path(), files);
  }
}

void add_images(const fs::path& folder, Files& files) {
  try {
    const Files images = images_in(folder);
    files.insert(files.end(), images.begin(), images.end());
  } catch (const fs::filesystem_error&) {  // unreadable folder
    return;
  }
}

void add_truth(const fs::path& recording, Files& files) {
  try {
    if (const std::optional<fs::path> truth = find_ground_truth(recording)) add_if_exists(*truth, files);
  } catch (const std::exception&) {  // not a recording, so it has none
    return;
  }
}

void add_bag(const fs::path& folder, Files& files) {
  try {
    for (const fs::path& file : files_of_bag(folder)) add_if_exists(file, files);
  } catch (const std::exception&) {  // unreadable folder
    return;
  }
}

void add_calibrations(const fs::path& folder, Files& files) {
  for (const char* const name : {"calibration.yaml", "camera.yaml", "sensor.yaml", "depth.yaml", "left.yaml",
                                 "right.yaml", "intrinsics.yml", "extrinsics.yml"}) {
    add_if_exists(folder / name, files);
  }
}

std::optional<fs::path> plan_image(const fs::path& plan) {
  try {
    const YAML::Node image = YAML::LoadFile(plan.string())["image"];
    if (image && image.IsScalar()) return plan.parent_path() / image.Scalar();
  } catch (const YAML::Exception&) {  // not a plan
  }
  return std::nullopt;
}

}  // namespace

Files files_of_recording(const fs::path& recording) {
  Files files;
  if (!is_folder(recording)) {
    files.push_back(recording);
    if (is_file(recording) && (is_video_file(recording) || is_bag(recording))) {
      add_calibrations(recording.parent_path(), files);
    }
    return files;
  }
  if (is_bag(recording)) add_bag(recording, files);
  add_calibrations(recording, files);
  for (const char* const list : {"calib.txt", "times.txt", "rgb.txt", "depth.txt", "groundtruth.txt"}) {
    add_if_exists(recording / list, files);
  }
  for (const char* const folder : {"image_0", "image_1", "image_2", "image_3", "left", "right", "rgb", "depth"}) {
    if (is_folder(recording / folder)) add_below(recording / folder, files);
  }
  for (const char* const mav : {"mav0", "."}) add_euroc(recording / mav, files);
  for (const char* const list : {"rgb.txt", "depth.txt"}) add_listed(recording / list, files);
  add_images(recording, files);
  add_truth(recording, files);
  std::ranges::sort(files);
  const auto repeated = std::ranges::unique(files);
  files.erase(repeated.begin(), repeated.end());
  return files;
}

Files files_of_floor_plan(const fs::path& plan) {
  Files files = {plan};
  fs::path image = plan;
  if (!has_image_name(plan) && is_file(plan)) image = plan_image(plan).value_or(plan);
  if (image != plan) files.push_back(image);
  if (const std::optional<fs::path> world = find_world_file(image)) files.push_back(*world);
  return files;
}

Files files_of_colmap_model(const fs::path& folder) {
  Files files;
  for (const char* const name : {"cameras", "images", "points3D"}) {
    for (const char* const suffix : {".bin", ".txt"}) add_if_exists(folder / (std::string(name) + suffix), files);
  }
  return files;
}

Files images_below(const fs::path& folder) {
  if (!is_folder(folder)) return {folder};
  Files files;
  add_below(folder, files);
  std::erase_if(files, [](const fs::path& file) { return !has_image_name(file); });
  return files;
}

std::filesystem::path picks_path(const std::filesystem::path& map) {
  std::filesystem::path path = map;
  return path.replace_extension(".picks.csv");
}

}  // namespace byre
