#pragma once

#include "byre/benchmark/benchmark_run.h"

#include <string>
#include <utility>
#include <vector>

namespace byre {

// What the figures rest on beside the protocol; without it they cannot be compared with others.
struct BenchmarkSetting {
  std::string protocol_file;
  std::string data;
  Pace pace = Pace::paced;
  int cores = 0;                                                       // cores of the machine
  std::vector<std::pair<std::string, std::string>> changed_options{};  // names and values, other than by default
};

// Tables in Markdown. The header says how the figures were made.
std::string to_markdown(const BenchmarkResult& result, const BenchmarkProtocol& protocol,
                        const BenchmarkSetting& setting);

// Everything: protocol, setting, maps, every figure of every run and their summaries, and what was published.
std::string to_json(const BenchmarkResult& result, const BenchmarkProtocol& protocol, const BenchmarkSetting& setting);

}  // namespace byre
