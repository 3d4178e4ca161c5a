#pragma once

#include <filesystem>
#include <functional>

namespace byre::cli {

// Throws InputError when no file can be written there, so that it is known before the work and not after it.
void require_writable(const std::filesystem::path& path);

// Has write(other_path) write a file beside path, then gives it the name path: what is there is whole, whenever the
// program ends. A path that is no regular file, such as /dev/stdout, is written to directly. Hands on what write
// throws.
void write_whole(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

}  // namespace byre::cli
