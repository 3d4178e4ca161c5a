#include "byre/registry/blobs.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/map/map_upkeep.h"

#include <algorithm>
#include <functional>
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

}  // namespace byre
