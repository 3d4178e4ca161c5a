#pragma once

#include "byre/benchmark/benchmark_run.h"

#include <string>
#include <utility>
#include <vector>

namespace byre {

// Setting of a benchmark in addition to its protocol, needed to compare its figures with others.
struct BenchmarkSetting {
  std::string protocol_file;
  std::string data;
  Pace pace = Pace::paced;
  int cores = 0;
  std::vector<std::pair<std::string, std::string>> changed_options{};  // names and values that differ from the defaults
};

// Markdown tables. The header states protocol and setting.
std::string to_markdown(const BenchmarkResult& result, const BenchmarkProtocol& protocol,
                        const BenchmarkSetting& setting);

// Everything: protocol, setting, maps, all figures of all runs with summaries, and published results.
std::string to_json(const BenchmarkResult& result, const BenchmarkProtocol& protocol, const BenchmarkSetting& setting);

}  // namespace byre
