#pragma once

#include <filesystem>

namespace byre {

// Throws InputError for a pipe, a socket or a device, which may block for ever, and for a circular link. Missing files
// and folders are left to the function that opens them.
void refuse_pipe(const std::filesystem::path& path);

}  // namespace byre
