#pragma once

#include "byre/benchmark/measures.h"
#include "byre/recording.h"

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

namespace byre {

// A YAML value with its position, so that errors in it are InputErrors at "FILE:LINE".
class YamlValue {
 public:
  // Loads a file of named fields. Throws InputError if it cannot be read or is not of this form.
  static YamlValue load(const std::filesystem::path& path);

  // Each throws InputError if the value is of another kind or outside the inclusive limits.
  std::string text() const;
  double number(double min_value, double max_value) const;
  int whole_number(int min_value, int max_value) const;
  std::vector<YamlValue> entries() const;                       // entries of a list, not empty
  std::vector<std::pair<YamlValue, YamlValue>> fields() const;  // names and values in file order
  YamlValue operator[](const std::string& name) const;          // value of a required field
  std::optional<YamlValue> find(const std::string& name) const;

  // Throws InputError for a field not among names, or given twice.
  void require_fields(std::initializer_list<std::string_view> names) const;

  [[noreturn]] void fail(const std::string& reason, const std::string& remedy) const;

 private:
  YamlValue(std::filesystem::path path, YAML::Node node) : path_(std::move(path)), node_(std::move(node)) {}

  std::filesystem::path path_;
  YAML::Node node_;
};

// Mode of a run.
//   no_map         plain SLAM: maps from scratch, with finishing
//   localise_only  tracks on the offline map, maps nothing
//   hybrid         tracks on the offline map and extends it by an online map
enum class Arm : std::uint8_t { no_map, localise_only, hybrid };

std::string_view name_of(Arm arm);  // as in a protocol

struct BenchmarkRecording {
  std::string name;
  std::filesystem::path folder;  // relative to the data folder
  FrameRange range = {};
  OpenOptions open = {};                            // calibration relative to the data folder
  std::optional<std::filesystem::path> truth = {};  // in the data folder; empty: the recording's own
  Timestamp truth_offset{0};                        // added to the truth's time stamps
};

// A recording, with the map of another one or without a map.
struct BenchmarkCase {
  std::string name;
  std::string recording;
  std::optional<std::string> map;  // name of the recording that is mapped
  std::vector<Arm> arms;
};

// Results published for other systems, of final poses; printed next to byre's.
struct PublishedFigures {
  std::string name;
  std::string note;
  std::map<std::string, TrajectoryMeasures> of_case;  // by case name
};

struct BenchmarkProtocol {
  std::string name;  // the protocol's file name without extension
  std::string title;
  std::string about;
  int runs = 1;
  std::vector<std::uint64_t> seeds;  // seeds of the first runs; later runs increment the last
  std::vector<BenchmarkRecording> recordings;
  std::vector<BenchmarkCase> cases;
  std::vector<PublishedFigures> published;

  const BenchmarkRecording& recording(const std::string& recording_name) const;
  std::uint64_t seed_of_run(int run) const;  // run counts from 0
};

// A protocol file, or the name of an installed one ("euroc"). Throws InputError if neither exists.
std::filesystem::path find_benchmark_protocol(const std::string& file_or_name);

// Throws InputError with file and line for any invalid content: unknown or missing fields, values of a wrong kind,
// names that are duplicate or undeclared.
BenchmarkProtocol read_benchmark_protocol(const std::filesystem::path& path);

}  // namespace byre
