#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Message on the first argument that is no command and no option, with the name that it likely stands for. Empty
// without such an argument. Call it after parsing.
std::string unknown_argument(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace byre::cli
