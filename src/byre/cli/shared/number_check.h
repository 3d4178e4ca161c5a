#pragma once

#include <CLI/App.hpp>

namespace byre::cli {

// Checks of numbers on the command line, which nan and infinities never pass; help does not show them.
CLI::Validator between(double low, double high);  // both inclusive
CLI::Validator from(double low);
CLI::Validator above_zero();

}  // namespace byre::cli
