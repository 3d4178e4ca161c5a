#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace byre {

// Throws InputError when no file can be written there, so that it is known before the work and not after it.
void require_writable(const std::filesystem::path& path);

// Has write(other_path) write a file beside path, then gives it the name path: what is there is whole, whenever the
// program ends. A path that is no regular file, such as /dev/stdout, is written to directly. Hands on what write
// throws.
void write_whole(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& write);

// Writes a text so. Throws InputError when it cannot be written.
void write_whole(const std::filesystem::path& path, const std::string& text);

}  // namespace byre
