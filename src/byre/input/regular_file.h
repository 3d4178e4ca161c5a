#pragma once

#include <filesystem>

namespace byre {

// Throws InputError for a pipe, a socket or a device, from which nothing may ever come, and for a link that leads round
// in a circle. What is not there, and a folder, is left to who opens it.
void refuse_pipe(const std::filesystem::path& path);

}  // namespace byre
