#pragma once

#include "byre/benchmark/measures.h"
#include "byre/recording.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// How a recording is run.
//   no_map         plain SLAM: a map of its own, finished at the end
//   localise_only  tracked on the offline map, nothing mapped
//   hybrid         tracked on the offline map, with an online one beside it
enum class Arm : std::uint8_t { no_map, localise_only, hybrid };

std::string_view name_of(Arm arm);  // as in a protocol

struct BenchmarkRecording {
  std::string name;
  std::filesystem::path folder;  // relative to the folder of data
  FrameRange range = {};
  OpenOptions open = {};                            // a calibration is relative to the folder of data
  std::optional<std::filesystem::path> truth = {};  // in the folder of data; empty: what comes with the recording
  Timestamp truth_offset{0};                        // added to the truth's time stamps
};

// One recording, on the map of another or on none.
struct BenchmarkCase {
  std::string name;
  std::string recording;
  std::optional<std::string> map;  // name of the recording it is made of
  std::vector<Arm> arms;
};

// What somebody else reached in these cases, of final poses; printed beside what is measured.
struct PublishedFigures {
  std::string name;
  std::string note;
  std::map<std::string, TrajectoryMeasures> of_case;  // by the case's name
};

struct BenchmarkProtocol {
  std::string name;  // name of the protocol's file without its ending
  std::string title;
  std::string about;
  int runs = 1;
  std::vector<std::uint64_t> seeds;  // seeds of the first runs; later runs count on from the last
  std::vector<BenchmarkRecording> recordings;
  std::vector<BenchmarkCase> cases;
  std::vector<PublishedFigures> published;

  const BenchmarkRecording& recording(const std::string& recording_name) const;  // precondition: it is there
  std::uint64_t seed_of_run(int run) const;                                      // run counts from 0
};

// A protocol file, or the name of one that comes with byre ("euroc"). Throws InputError when there is none.
std::filesystem::path find_benchmark_protocol(const std::string& file_or_name);

// Throws InputError, naming file and line, for anything that is not understood: fields that do not exist or are
// missing, values of another kind, names used twice or not declared.
BenchmarkProtocol read_benchmark_protocol(const std::filesystem::path& path);

}  // namespace byre
