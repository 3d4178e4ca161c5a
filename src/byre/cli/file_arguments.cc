#include "byre/cli/file_arguments.h"

#include "byre/cli/file_content.h"
#include "byre/dataset/files_read.h"
#include "byre/input/regular_file.h"
#include "byre/viewer/web_map.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <sys/stat.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoOverwrite = "--no-overwrite";

// An option carries its declaration as the name of a validator, which help does not show.
constexpr const char* kText = "text";
constexpr std::array kInputs = {
    std::pair(Input::file, "reads file"),     std::pair(Input::recording, "reads recording"),
    std::pair(Input::plan, "reads plan"),     std::pair(Input::colmap_model, "reads model"),
    std::pair(Input::images, "reads images"), std::pair(Input::folder, "reads folder")};
constexpr std::array kOutputs = {std::pair(Output::map, "writes map"),
                                 std::pair(Output::refined_map, "writes refined map"),
                                 std::pair(Output::updated_map, "writes updated map"),
                                 std::pair(Output::viewed_map, "writes viewed map"),
                                 std::pair(Output::trajectory, "writes trajectory"),
                                 std::pair(Output::json, "writes JSON"),
                                 std::pair(Output::picture, "writes picture"),
                                 std::pair(Output::video, "writes video"),
                                 std::pair(Output::point_cloud, "writes point cloud"),
                                 std::pair(Output::calibration, "writes calibration"),
                                 std::pair(Output::vocabulary, "writes vocabulary"),
                                 std::pair(Output::colmap_model, "writes model"),
                                 std::pair(Output::folder, "writes folder")};

template <typename Kind, std::size_t n>
const char* name_of(const std::array<std::pair<Kind, const char*>, n>& names, Kind kind) {
  return std::ranges::find(names, kind, &std::pair<Kind, const char*>::first)->second;
}

bool is_declared(CLI::Option& option, const char* name) {
  try {
    option.get_validator(name);
    return true;
  } catch (const CLI::OptionNotFound&) {
    return false;
  }
}

template <typename Kind, std::size_t n>
std::optional<Kind> declared_as(const std::array<std::pair<Kind, const char*>, n>& names, CLI::Option& option) {
  for (const auto& [kind, name] : names) {
    if (is_declared(option, name)) return kind;
  }
  return std::nullopt;
}

CLI::Option* declare_file(CLI::Option* option, const char* name) {
  const auto require_name = [](const std::string& path) {
    return path.empty() ? std::string("is empty: name a file or folder (is a shell variable not set?)") : std::string();
  };
  return option->check(CLI::Validator(require_name, "", name));
}

// A file or folder by what it is, not by its name.
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

// A terminal, a pipe: reading and writing it are two things.
bool is_special(const fs::path& path) {
  std::error_code error;
  return fs::is_other(path, error);
}

// The file that a path stands for, also by links, whether it is there or not.
fs::path target_of(fs::path path) {
  constexpr int kMostLinks = 40;
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  return error ? path : target;
}

struct Read {
  Input input{};
  std::string argument;
  fs::path path;  // as given
};

struct Written {
  Output output{};
  std::string argument;
  fs::path path;  // as given
};

std::vector<fs::path> files_of(const Read& read) {
  switch (read.input) {
    case Input::file:
    case Input::folder:
      break;
    case Input::recording:
      return files_of_recording(read.path);
    case Input::plan:
      return files_of_floor_plan(read.path);
    case Input::colmap_model:
      return files_of_colmap_model(read.path);
    case Input::images:
      return images_below(read.path);
  }
  return {};
}

// All that is written for an output, but for what comes into folders whose content is the command's own.
std::vector<fs::path> files_of(const Written& written) {
  std::vector<fs::path> files;
  switch (written.output) {
    case Output::folder:
      return {};
    case Output::colmap_model:
      for (const char* const name : {"cameras", "images", "points3D"}) {
        for (const char* const suffix : {".bin", ".txt"}) files.push_back(written.path / (std::string(name) + suffix));
      }
      return files;
    case Output::viewed_map:
      files.push_back(picks_path(written.path));
      [[fallthrough]];
    default:
      files.push_back(written.path);
      return files;
  }
}

struct Arguments {
  std::vector<Read> inputs;
  std::vector<Written> outputs;
};

// The commands that were given, one below the other, outermost first.
std::vector<CLI::App*> given_commands(CLI::App& command) {
  std::vector<CLI::App*> commands = {&command};
  for (CLI::App* const below : command.get_subcommands()) {
    for (CLI::App* const each : given_commands(*below)) commands.push_back(each);
  }
  return commands;
}

Arguments arguments_of(CLI::App& command) {
  Arguments arguments;
  for (CLI::App* const given : given_commands(command)) {
    for (CLI::Option* const option : given->get_options()) {
      const auto input = input_of(*option);
      const auto output = output_of(*option);
      for (const std::string& path : option->results()) {
        if (input) arguments.inputs.push_back({*input, option->get_name(), path});
        if (output) arguments.outputs.push_back({*output, option->get_name(), path});
      }
    }
  }
  return arguments;
}

// Which argument reads a file or folder: those that are there by what they are, those that were named by their name
// too.
struct Owners {
  std::map<Identity, const Read*> by_identity;
  std::map<fs::path, const Read*> by_name;

  const Read* find(const fs::path& file, Output output) const {
    const auto identity = identity_of(file);
    const auto same = identity ? by_identity.find(*identity) : by_identity.end();
    if (same != by_identity.end()) return same->second;
    if (output == Output::folder) return nullptr;  // it may bear the name of a protocol that comes with byre
    const auto named = by_name.find(target_of(file));
    return named != by_name.end() && !is_special(file) ? named->second : nullptr;
  }
};

Owners owners_of(const std::vector<Read>& inputs) {
  Owners owners;
  for (const Read& read : inputs) {
    std::error_code error;
    if (read.input == Input::file && fs::is_directory(read.path, error)) continue;  // no file, but a name like one
    owners.by_name.emplace(target_of(read.path), &read);
    std::vector<fs::path> files = files_of(read);
    files.push_back(read.path);
    for (const fs::path& file : files) {
      if (const auto identity = identity_of(file)) owners.by_identity.emplace(*identity, &read);
    }
  }
  return owners;
}

// A map may take the place of the map that it was made of.
bool may_be(const Written& written, const Read& read) {
  constexpr std::array kInPlace = {Output::refined_map, Output::updated_map, Output::viewed_map};
  if (std::ranges::count(kInPlace, written.output) == 0) return false;
  return read.input == Input::file && read.argument == "MAP";
}

void require_not_read(const Written& written, const fs::path& file, const Owners& owners) {
  const Read* const owner = owners.find(file, written.output);
  if (owner == nullptr || may_be(written, *owner)) return;
  throw CLI::ValidationError(written.argument, file.string() + " is read, for " + owner->argument +
                                                   ", so it may not be written: name another file");
}

void require_not_read(const Written& written, const Owners& owners) {
  // The files of a model may be put beside those of a recording.
  std::error_code error;
  const bool is_shared_folder = written.output == Output::colmap_model && fs::is_directory(written.path, error);
  if (!is_shared_folder) require_not_read(written, written.path, owners);
  for (const fs::path& file : files_of(written)) {
    require_not_read(written, file, owners);
    fs::path unfinished = target_of(file);
    unfinished += ".unfinished";  // where it is written first
    require_not_read(written, unfinished, owners);
  }
}

void require_distinct(const std::vector<Written>& outputs) {
  std::set<fs::path> files;
  std::set<Identity> identities;
  const auto require_new = [](bool is_new, const fs::path& file) {
    if (!is_new) throw CLI::ValidationError(file.string(), "is named for two outputs");
  };
  for (const Written& written : outputs) {
    for (const fs::path& file : files_of(written)) {
      fs::path unfinished = target_of(file);
      require_new(files.insert(unfinished).second, file);
      require_new(files.insert(unfinished += ".unfinished").second, file);
      const auto identity = identity_of(file);
      if (identity) require_new(identities.insert(*identity).second, file);
    }
  }
}

// Such as /dev/stdout, which may stand for a file that is gone on with.
bool is_device_name(const fs::path& path) {
  const std::string name = path.lexically_normal().string();
  return name.starts_with("/dev/") || name.starts_with("/proc/");
}

bool is_svg(const fs::path& file) {
  return file.extension() == ".svg" || file.extension() == ".SVG";
}

std::string_view kind_of(const Written& written, const fs::path& file) {
  switch (written.output) {
    case Output::viewed_map:
      return file == written.path ? "map" : "table of picks";
    case Output::map:
    case Output::refined_map:
    case Output::updated_map:
      return "map";
    case Output::trajectory:
      return "trajectory";
    case Output::json:
      return "JSON";
    case Output::picture:
      return is_svg(file) ? "SVG picture" : "PNG picture";
    case Output::video:
      return "video";
    case Output::point_cloud:
      return "point cloud";
    case Output::calibration:
      return "calibration";
    case Output::vocabulary:
      return "vocabulary";
    case Output::colmap_model:
    case Output::folder:
      break;
  }
  return "part of a model";
}

bool may_replace(const Written& written, const fs::path& file, FileContent content) {
  switch (written.output) {
    case Output::viewed_map:
      return content == (file == written.path ? FileContent::map : FileContent::table);
    case Output::map:
    case Output::refined_map:
    case Output::updated_map:
      return content == FileContent::map;
    case Output::trajectory:
      return content == FileContent::trajectory;
    case Output::json:
      return content == FileContent::json;
    case Output::picture:
      return content == (is_svg(file) ? FileContent::svg : FileContent::png);
    case Output::video:
      return content == FileContent::video;
    case Output::point_cloud:
      return content == FileContent::point_cloud;
    case Output::calibration:
      return content == FileContent::yaml;
    case Output::vocabulary:
      return content == FileContent::vocabulary;
    case Output::colmap_model:
    case Output::folder:
      break;
  }
  return content == FileContent::other || content == FileContent::text || content == FileContent::trajectory;
}

void require_same_kind(const Written& written, const fs::path& file) {
  const auto content = content_of(file);
  if (!content || *content == FileContent::nothing || may_replace(written, file, *content)) return;
  throw CLI::ValidationError(written.argument, file.string() + " is there and is no " +
                                                   std::string(kind_of(written, file)) +
                                                   ": name another file, or remove that one first");
}

bool has_no_overwrite(const CLI::App& command) {
  const CLI::Option* const option = command.get_option_no_throw(kNoOverwrite);
  return option != nullptr && option->count() > 0;
}

// It may stand anywhere on the command line.
bool wants_no_overwrite(CLI::App& command) {
  for (const CLI::App* each = command.get_parent(); each != nullptr; each = each->get_parent()) {
    if (has_no_overwrite(*each)) return true;
  }
  return std::ranges::any_of(given_commands(command), [](const CLI::App* given) { return has_no_overwrite(*given); });
}

void require_absent(const std::string& argument, const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  const bool is_full_folder = fs::is_directory(status) && !fs::is_empty(file, error);
  if (!fs::is_regular_file(status) && !is_full_folder) return;
  throw CLI::ValidationError(argument, file.string() + " is there, and " + kNoOverwrite + " keeps what is");
}

// Where no file is named for it, a refined map replaces the one that was read.
void require_absent_map(CLI::App& command, const Arguments& arguments) {
  for (CLI::Option* const option : command.get_options()) {
    if (output_of(*option) != Output::refined_map || option->count() > 0) continue;
    for (const Read& read : arguments.inputs) {
      if (read.argument == "MAP") require_absent(read.argument, read.path);
    }
  }
}

void require_nothing_replaced(CLI::App& command, const Arguments& arguments) {
  for (const Written& written : arguments.outputs) {
    if (is_device_name(written.path)) continue;
    if (written.output == Output::folder) require_absent(written.argument, written.path);
    for (const fs::path& file : files_of(written)) require_absent(written.argument, file);
  }
  for (CLI::App* const given : given_commands(command)) require_absent_map(*given, arguments);
}

}  // namespace

CLI::Option* declare(CLI::Option* option, Input input) {
  return declare_file(option, name_of(kInputs, input));
}

CLI::Option* declare(CLI::Option* option, Output output) {
  return declare_file(option, name_of(kOutputs, output));
}

CLI::Option* declare_text(CLI::Option* option) {
  return option->check(CLI::Validator([](const std::string&) { return std::string(); }, "", kText));
}

std::optional<Input> input_of(CLI::Option& option) {
  return declared_as(kInputs, option);
}

std::optional<Output> output_of(CLI::Option& option) {
  return declared_as(kOutputs, option);
}

bool is_text(CLI::Option& option) {
  return is_declared(option, kText);
}

void declare_no_overwrite(CLI::App& command) {
  command.add_flag(kNoOverwrite)->description("Replace no file that is there");
}

void require_safe_files(CLI::App& command) {
  const Arguments arguments = arguments_of(command);
  if (!arguments.outputs.empty()) {  // else nobody needs to know all that is read
    const Owners owners = owners_of(arguments.inputs);
    for (const Written& written : arguments.outputs) require_not_read(written, owners);
    require_distinct(arguments.outputs);
  }
  if (wants_no_overwrite(command)) require_nothing_replaced(command, arguments);
  for (const Written& written : arguments.outputs) {
    if (is_device_name(written.path)) continue;
    for (const fs::path& file : files_of(written)) require_same_kind(written, file);
  }
}

void require_files_or_folders(CLI::App& command) {
  for (const Read& read : arguments_of(command).inputs) refuse_pipe(read.path);
}

void check_when_parsed(CLI::App& command, std::function<void()> check) {
  command.parse_complete_callback([&command, check = std::move(check)] {
    require_safe_files(command);
    if (check) check();
  });
}

}  // namespace byre::cli
