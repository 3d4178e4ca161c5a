#include "byre/cli/shared/number_check.h"

#include "byre/base/text_file.h"

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

CLI::Validator number_that(std::function<bool(double)> fits, std::string what) {
  const auto fault_of = [fits = std::move(fits), what = std::move(what)](const std::string& text) {
    const std::optional<double> number = parse_number(text);
    return number && fits(*number) ? std::string() : "\"" + text + "\" is not a number " + what;
  };
  return {fault_of, ""};
}

}  // namespace

CLI::Validator between(double low, double high) {
  return number_that([=](double number) { return low <= number && number <= high; },
                     fmt::format("from {:.12g} to {:.12g}", low, high));
}

CLI::Validator from(double low) {
  return number_that([=](double number) { return low <= number; }, fmt::format("of at least {:.12g}", low));
}

CLI::Validator above_zero() {
  return number_that([](double number) { return number > 0.0; }, "above 0");
}

}  // namespace byre::cli
