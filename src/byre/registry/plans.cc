#include "byre/registry/plans.h"

#include "byre/base/binary_file.h"
#include "byre/base/printable.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/registry/blobs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <system_error>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 200;  // characters; limit of the schema

std::vector<RegistryPlan> read_plans(Connection& connection, std::int64_t site, const std::optional<std::string>& name,
                                     const std::optional<std::string>& number) {
  std::vector<RegistryPlan> plans;
  persist(connection, [&] {
    plans.clear();
    const Rows rows = connection.run(
        R"(SELECT name, number, file, other_file, added_by,
            to_char(added_at AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"')
          FROM byre.plan p WHERE site = $1 AND name = coalesce($2, name) AND number::text = coalesce($3,
            (SELECT max(number) FROM byre.plan q WHERE q.site = p.site AND q.name = p.name)::text) ORDER BY name)",
        {site, name, number});
    for (int row = 0; row < rows.size(); ++row) {
      plans.push_back({rows.text(row, 0), static_cast<int>(rows.number(row, 1)), rows.text(row, 2), rows.text(row, 3),
                       rows.text(row, 4), rows.text(row, 5)});
    }
  });
  return plans;
}

// Kind of a plan's file, by its name.
FileContent content_by_name(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) { return std::tolower(letter); });
  if (extension == ".yaml" || extension == ".yml") return FileContent::yaml;
  if (extension == ".png") return FileContent::png;
  if (extension == ".pgm") return FileContent::pgm;
  return extension.ends_with('w') || extension == ".wld" ? FileContent::text : FileContent::photograph;
}

// The server refuses other names; a damaged registry must not lead to files elsewhere.
void require_plain_name(const Connection& connection, const std::string& file) {
  if (!file.empty() && !file.starts_with('.') && file.find_first_of(std::string("/\0", 2)) == std::string::npos) return;
  throw InputError(connection.place(), "is damaged: a plan has a file named '" + file + "'",
                   "restore the registry from a backup");
}

}  // namespace

PushedPlan push_plan(Connection& connection, std::int64_t site, const fs::path& path,
                     const std::optional<std::string>& name, const std::string& note) {
  const std::array<fs::path, 2> files = files_to_copy(path);
  PushedPlan pushed{name.value_or(path.stem().string())};
  if (printable(pushed.name, kMaxName) != pushed.name) {
    throw InputError("--name", "has control characters, or more than 200 bytes: " + pushed.name, "give a shorter name");
  }
  const std::vector<std::byte> blob = push_blob(connection, MappedFile(files[0]).bytes());
  const std::vector<std::byte> other_blob = push_blob(connection, MappedFile(files[1]).bytes());
  persist(connection, [&] {
    const Rows added = connection.run(
        "INSERT INTO byre.plan (site, name, file, blob, other_file, other_blob, note) VALUES ($1, $2, $3, $4, $5, $6, "
        "$7) RETURNING number",
        {site, pushed.name, files[0].filename().string(), blob, files[1].filename().string(), other_blob, note});
    pushed.is_new = added.size() > 0;
    if (pushed.is_new) pushed.number = static_cast<int>(added.number(0, 0));
  });
  if (!pushed.is_new) pushed.number = find_plan(connection, site, pushed.name, {}).number;
  return pushed;
}

std::vector<RegistryPlan> current_plans(Connection& connection, std::int64_t site) {
  return read_plans(connection, site, {}, {});
}

RegistryPlan find_plan(Connection& connection, std::int64_t site, const std::optional<std::string>& name,
                       const std::optional<std::string>& number) {
  const std::vector<RegistryPlan> plans = read_plans(connection, site, name, number);
  if (plans.size() == 1) return plans.front();
  if (plans.empty()) {
    throw InputError(connection.place(),
                     "has no plan" + (name ? " '" + *name + "'" : "") + (number ? " of number " + *number : "") +
                         " of this site, or the account may not read it",
                     "list the site with byre registry list");
  }
  std::string names;
  for (const RegistryPlan& plan : plans) names += (names.empty() ? "" : ", ") + plan.name;
  throw InputError(connection.place(), "has several plans of this site: " + names, "choose one with --name");
}

PulledPlan pull_plan(Connection& connection, std::int64_t site, const RegistryPlan& plan, const fs::path& folder) {
  PulledPlan pulled{folder / plan.file};
  const auto pull = [&](const char* statement, const std::string& file) {
    require_plain_name(connection, file);
    std::optional<std::vector<std::byte>> blob;
    persist(connection, [&] { blob = connection.bytes(statement, {site, plan.name, plan.number}); });
    pulled.received +=
        pull_blob(connection, blob.value_or(std::vector<std::byte>()), "", folder / file, content_by_name(file));
  };
  std::error_code error;
  fs::create_directories(folder, error);  // a failure is reported by the file
  pull("SELECT other_blob FROM byre.plan WHERE site = $1 AND name = $2 AND number = $3", plan.other_file);
  pull("SELECT blob FROM byre.plan WHERE site = $1 AND name = $2 AND number = $3", plan.file);
  const fs::path other = files_to_copy(pulled.path)[1];
  if (other.filename() != plan.other_file) {
    throw InputError(other.string(), "is read with " + plan.file + " instead of " + plan.other_file,
                     "remove it, or choose another folder");
  }
  return pulled;
}

}  // namespace byre
