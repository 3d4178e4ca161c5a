#include "byre/registry/blobs.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/image/plan_file.h"
#include "byre/map/map_upkeep.h"

#include <algorithm>
#include <array>
#include <system_error>

#include <fmt/format.h>
#include <openssl/evp.h>

namespace byre {
namespace {

constexpr std::size_t kChunkBytes = 1 << 20;
constexpr std::size_t kHashBytes = 32;

using Bytes = std::vector<std::byte>;

Bytes sha256(std::span<const std::byte> bytes) {
  Bytes hash(kHashBytes);
  EVP_Digest(bytes.data(), bytes.size(), reinterpret_cast<unsigned char*>(hash.data()), nullptr, EVP_sha256(), nullptr);
  return hash;
}

std::span<const std::byte> chunk_of(std::span<const std::byte> file, std::size_t number) {
  const std::size_t first = number * kChunkBytes;
  return file.subspan(first, std::min(kChunkBytes, file.size() - first));
}

std::span<const std::byte> hash_of(const Bytes& hashes, std::size_t number) {
  return std::span(hashes).subspan(number * kHashBytes, kHashBytes);
}

// Names of the chunks of a file, in order.
Bytes chunk_hashes(std::span<const std::byte> file) {
  Bytes hashes;
  for (std::size_t first = 0; first < file.size(); first += kChunkBytes) {
    const Bytes hash = sha256(chunk_of(file, first / kChunkBytes));
    hashes.insert(hashes.end(), hash.begin(), hash.end());
  }
  return hashes;
}

// Number of equal chunks at the beginning of two files.
std::size_t common_chunks(const Bytes& one, const Bytes& other) {
  const auto [end, other_end] = std::ranges::mismatch(one, other);
  return static_cast<std::size_t>(end - one.begin()) / kHashBytes;
}

bool has_chunks(const std::filesystem::path& path, const Bytes& hashes) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) > 0 &&
         chunk_hashes(MappedFile(path).bytes()) == hashes;
}

[[noreturn]] void refuse_damage(const Connection& connection, const std::string& part) {
  throw InputError(connection.place(), "is damaged: " + part + " does not have its SHA-256",
                   "restore the registry from a backup");
}

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
  const std::string extension = lower_case(file.extension().string());
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

Bytes push_blob(Connection& connection, std::span<const std::byte> file) {
  const Bytes hashes = chunk_hashes(file);
  Bytes name;
  persist(connection, [&] {
    const Rows missing = connection.run("SELECT byre.missing_chunks($1)", {hashes});
    for (int row = 0; row < missing.size(); ++row) {
      const auto number = static_cast<std::size_t>(missing.number(row, 0));
      connection.run("INSERT INTO byre.chunk (hash, data) VALUES ($1, $2) ON CONFLICT DO NOTHING",
                     {hash_of(hashes, number), chunk_of(file, number)});
    }
    name = connection.bytes("SELECT byre.add_blob($1)", {hashes}).value();
  });
  return name;
}

std::size_t pull_blob(Connection& connection, std::span<const std::byte> name, const std::string& id,
                      const std::filesystem::path& path, FileContent content) {
  Bytes hashes;
  persist(connection, [&] {
    hashes =
        connection.bytes("SELECT string_agg(chunk, '' ORDER BY number) FROM byre.blob_chunk WHERE blob = $1", {name})
            .value_or(Bytes());
  });
  if (hashes.empty()) throw InputError(connection.place(), "has no such file, or the account may not read it");
  if (!std::ranges::equal(sha256(hashes), name)) refuse_damage(connection, "the list of chunks of a file");
  if (has_chunks(path, hashes)) return 0;
  const Bytes leftover = read_leftover(path, content);
  const std::size_t kept = common_chunks(chunk_hashes(leftover), hashes);
  OutputFile file(path, content);
  file.append(std::span(leftover).first(std::min(leftover.size(), kept * kChunkBytes)));
  std::size_t received = 0;
  for (std::size_t number = kept; number < hashes.size() / kHashBytes; ++number) {
    std::optional<Bytes> data;
    file.keep_unpublished(true);
    persist(connection,
            [&] { data = connection.bytes("SELECT data FROM byre.chunk WHERE hash = $1", {hash_of(hashes, number)}); });
    file.keep_unpublished(false);
    if (!data || !std::ranges::equal(sha256(*data), hash_of(hashes, number))) {
      refuse_damage(connection, fmt::format("chunk {} of a file", number + 1));
    }
    file.append(*data);
    received += data->size();
  }
  if (!id.empty() && !file.temporary().empty() && to_text(map_id(file.temporary())) != id) {
    throw InputError(connection.place(), "has a file of another id as " + id, "restore the registry from a backup");
  }
  file.publish();
  return received;
}

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
