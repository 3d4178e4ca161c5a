#pragma once

#include <CLI/App.hpp>

namespace byre::cli {

// Validators of numbers; reject NaN and infinity; not shown in the help.
CLI::Validator between(double low, double high);  // both inclusive
CLI::Validator from(double low);
CLI::Validator above_zero();

}  // namespace byre::cli
