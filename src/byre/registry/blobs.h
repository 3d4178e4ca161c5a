#pragma once

#include "byre/base/file_content.h"
#include "byre/registry/connection.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Files in a registry, in chunks of 1 MB. A chunk is named by the SHA-256 of its bytes, a file by the SHA-256 of the
// names of its chunks in order. Transfers continue after a broken connection, and after the end of the program.

// Stores a file, unless it is there. Chunks that an earlier upload stored are not sent again. Returns its name.
std::vector<std::byte> push_blob(Connection& connection, std::span<const std::byte> file);

// Writes a stored file, unless the path has it already. id: of a map or session; empty: another content. Returns the
// bytes received. Throws InputError for an unknown name, and for bytes that do not have their name or the id; the path
// is then unchanged.
std::size_t pull_blob(Connection& connection, std::span<const std::byte> name, const std::string& id,
                      const std::filesystem::path& path, FileContent content = FileContent::map);

// Floor plans of the sites of a registry, by names of floors or buildings. The newest plan of a name is the current
// one.

struct RegistryPlan {
  std::string name;
  int number = 0;          // from 1, for each name
  std::string file;        // YAML file or image, for read_floor_plan()
  std::string other_file;  // its image or world file
  std::string added_by;    // account
  std::string added_at;    // UTC
};

struct PushedPlan {
  std::string name;
  int number = 0;
  bool is_new = false;  // false: it was the current one
};

// Stores a plan as the current one of its name. Idempotent. name: empty for that of the file without extension. Throws
// InputError for a plan that read_drawn_floor_plan() refuses, and whose image is in another folder.
PushedPlan push_plan(Connection& connection, std::int64_t site, const std::filesystem::path& path,
                     const std::optional<std::string>& name, const std::string& note);

// Current plans that the account may read, by name.
std::vector<RegistryPlan> current_plans(Connection& connection, std::int64_t site);

// A plan, by default the current one of this name, or of the only name. Throws InputError without it, and if several
// names qualify.
RegistryPlan find_plan(Connection& connection, std::int64_t site, const std::optional<std::string>& name,
                       const std::optional<std::string>& number);

struct PulledPlan {
  std::filesystem::path path;  // YAML file or image, for read_floor_plan()
  std::size_t received = 0;    // bytes; 0: the folder had the plan already
};

// Writes both files of a plan to a folder, under their own names.
PulledPlan pull_plan(Connection& connection, std::int64_t site, const RegistryPlan& plan,
                     const std::filesystem::path& folder);

}  // namespace byre
