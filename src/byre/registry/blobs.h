#pragma once

#include "byre/base/file_content.h"
#include "byre/registry/connection.h"

#include <cstddef>
#include <filesystem>
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

}  // namespace byre
