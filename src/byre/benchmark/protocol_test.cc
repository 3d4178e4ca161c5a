#include "byre/benchmark/protocol.h"

#include "byre/input_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::SizeIs;

// Writes a protocol to a temporary file.
class Protocols : public testing::Test {
 protected:
  ~Protocols() override { fs::remove(path_); }

  BenchmarkProtocol read(const std::string& yaml) const {
    std::ofstream(path_) << yaml;
    return read_benchmark_protocol(path_);
  }

  // Error message of an invalid protocol.
  std::string fault_of(const std::string& yaml) const {
    try {
      read(yaml);
    } catch (const InputError& error) {
      EXPECT_THAT(error.place(), HasSubstr(path_.string()));
      return fs::path(error.place()).extension().string() + " " + error.reason() + " | " + error.remedy();
    }
    return "no InputError";
  }

  fs::path path_ = fs::path(testing::TempDir()) / ("byre_protocol." + std::to_string(getpid()) + ".yaml");
};

TEST_F(Protocols, DefineHowToOpenARecording) {
  const std::string cases = "cases:\n  - {name: a, recording: a}\n";
  const std::string recording = "recordings:\n  - {name: a, folder: monday, ";
  const BenchmarkProtocol protocol = read(recording + "camera: right, calibration: cameras.yaml, fps: 12.5}\n" + cases);
  EXPECT_EQ(protocol.recording("a").open.camera, CameraChoice::right);
  EXPECT_EQ(protocol.recording("a").open.calibration, "cameras.yaml");
  EXPECT_EQ(protocol.recording("a").open.frame_rate_hz, 12.5);
  const OpenOptions bag = read(recording + "left: /cam0/image, right: /cam1/image}\n" + cases).recording("a").open;
  EXPECT_EQ(bag.left_topic, "/cam0/image");
  EXPECT_EQ(bag.right_topic, "/cam1/image");
  EXPECT_THAT(fault_of(recording + "camera: middle}\n" + cases),
              HasSubstr("\"middle\" is not a choice of cameras | use stereo, left, right or rgbd"));
  EXPECT_THAT(fault_of(recording + "fps: 0}\n" + cases), HasSubstr("is not a number from 0.01"));
}

constexpr const char* kComplete = R"(title: Barns
about: Two visits.
runs: 3
seeds: [7, 9]
recordings:
  - {name: a, folder: monday}
  - {name: b, folder: tuesday, frames: "10:20", truth: tuesday.txt, truth_offset_s: -0.0075}
cases:
  - {name: b, recording: b}
  - {name: b*, recording: b, map: a, arms: [hybrid, no_map]}
  - {name: b all, recording: b, map: a}
published:
  - name: Others
    note: As printed.
    cases:
      b*: {ate_m: 0.12, rpe_1s_deg: 2.5, coverage: 0.9}
)";

TEST_F(Protocols, DefineTheRuns) {
  const BenchmarkProtocol protocol = read(kComplete);
  EXPECT_EQ(protocol.title, "Barns");
  EXPECT_EQ(protocol.about, "Two visits.");
  EXPECT_THAT(protocol.name, testing::StartsWith("byre_protocol"));
  ASSERT_THAT(protocol.recordings, SizeIs(2));
  const BenchmarkRecording& second = protocol.recording("b");
  EXPECT_EQ(second.folder, "tuesday");
  EXPECT_EQ(second.range.first, 10);
  EXPECT_EQ(second.range.last, 20);
  EXPECT_EQ(second.truth, "tuesday.txt");
  EXPECT_EQ(second.truth_offset, std::chrono::microseconds(-7500));
  ASSERT_THAT(protocol.cases, SizeIs(3));
  EXPECT_THAT(protocol.cases[0].arms, ElementsAre(Arm::no_map));
  EXPECT_FALSE(protocol.cases[0].map);
  EXPECT_EQ(protocol.cases[1].map, "a");
  EXPECT_THAT(protocol.cases[1].arms, ElementsAre(Arm::hybrid, Arm::no_map));
  EXPECT_THAT(protocol.cases[2].arms, ElementsAre(Arm::no_map, Arm::localise_only, Arm::hybrid));
}

TEST_F(Protocols, ContainPublishedFigures) {
  const BenchmarkProtocol protocol = read(kComplete);
  ASSERT_THAT(protocol.published, SizeIs(1));
  EXPECT_EQ(protocol.published[0].note, "As printed.");
  const TrajectoryMeasures& figures = protocol.published[0].of_case.at("b*");
  EXPECT_EQ(figures.ate, 0.12);
  EXPECT_EQ(figures.rpe_second_deg, 2.5);
  EXPECT_EQ(figures.coverage, 0.9);
  EXPECT_FALSE(figures.map_error);
}

TEST_F(Protocols, ContinueFromTheLastSeed) {
  const BenchmarkProtocol protocol = read(kComplete);
  EXPECT_EQ(protocol.seed_of_run(0), 7u);
  EXPECT_EQ(protocol.seed_of_run(1), 9u);
  EXPECT_EQ(protocol.seed_of_run(2), 10u);
  EXPECT_EQ(BenchmarkProtocol().seed_of_run(4), 4u);
}

constexpr const char* kRecordings = "recordings:\n  - {name: a, folder: monday}\n";

TEST_F(Protocols, ReportTheLineOfAFault) {
  const std::string begin = kRecordings;
  EXPECT_THAT(fault_of(begin + "cases:\n  - {name: c, recording: b}\n"),
              HasSubstr(":4 the recording \"b\" is not declared | the protocol has a"));
  EXPECT_THAT(fault_of(begin + "cases:\n  - {name: c, recording: a, map: z}\n"), HasSubstr("\"z\" is not declared"));
  EXPECT_THAT(fault_of(begin + "cases:\n  - {name: c, recording: a, arms: [hybrid]}\n"),
              HasSubstr(":4 localise_only and hybrid need a map"));
  EXPECT_THAT(fault_of(begin + "cases:\n  - {name: c, recording: a, arms: [mono]}\n"),
              HasSubstr("\"mono\" is not an arm | use no_map, localise_only, hybrid"));
  EXPECT_THAT(fault_of(begin + "cases:\n  - {name: c, recording: a}\n  - {name: c, recording: a}\n"),
              HasSubstr(":5 the name is used twice"));
  EXPECT_THAT(fault_of(begin + "cases: []\n"), HasSubstr(":3 is not a list, or is empty"));
  EXPECT_THAT(fault_of(begin), HasSubstr("\"cases\" is missing"));
  EXPECT_THAT(fault_of(begin + "speed: 3\n"), HasSubstr(":3 unknown field \"speed\" | fields: title"));
  EXPECT_THAT(fault_of(begin + "runs: many\n"), HasSubstr(":3 is not a number from 1 to 1000"));
  EXPECT_THAT(fault_of(begin + "runs: 1.5\n"), HasSubstr(":3 is not an integer"));
  EXPECT_THAT(fault_of(begin + "runs: 1\nruns: 2\n"), HasSubstr("\"runs\" is given twice"));
  EXPECT_THAT(fault_of("recordings:\n  - {name: a, folder: f, frames: all}\n"), HasSubstr("not a range of frames"));
  EXPECT_THAT(fault_of("recordings:\n  - {name: a}\n"), HasSubstr("\"folder\" is missing"));
}

TEST_F(Protocols, ReportFaultsOfPublishedFigures) {
  const std::string begin = std::string(kRecordings) + "cases:\n  - {name: c, recording: a}\npublished:\n  - name: X\n";
  EXPECT_THAT(fault_of(begin + "    cases: {d: {ate_m: 1}}\n"), HasSubstr(":7 unknown case \"d\""));
  EXPECT_THAT(fault_of(begin + "    cases: {c: {ate: 1}}\n"),
              HasSubstr(":7 \"ate\" is not a figure | use coverage, ate_m"));
  EXPECT_THAT(fault_of(begin + "    cases: {c: {ate_m: small}}\n"), HasSubstr("is not a number"));
}

TEST_F(Protocols, AreYaml) {
  EXPECT_THAT(fault_of("cases: [\n"), HasSubstr("correct the YAML"));
  EXPECT_THAT(fault_of("- a\n- b\n"), HasSubstr("is not a YAML mapping"));
  EXPECT_THROW(read_benchmark_protocol("absent.yaml"), InputError);
}

TEST(ShippedProtocols, AreFoundByNameAndParsed) {
  const BenchmarkProtocol euroc = read_benchmark_protocol(find_benchmark_protocol("euroc"));
  EXPECT_EQ(euroc.name, "euroc");
  EXPECT_THAT(euroc.cases, SizeIs(15));
  EXPECT_EQ(euroc.published.front().of_case.at("v2_02*").rpe_second_deg, 8.77);
  EXPECT_THAT(read_benchmark_protocol(find_benchmark_protocol("twin")).cases, SizeIs(7));
  EXPECT_THAT(read_benchmark_protocol(find_benchmark_protocol("mh_short")).cases, SizeIs(2));
}

TEST(ShippedProtocols, AreShadowedByFilesOfTheUser) {
  EXPECT_EQ(find_benchmark_protocol("folder/euroc"), "folder/euroc");
  EXPECT_EQ(find_benchmark_protocol("mine.yaml"), "mine.yaml");
  EXPECT_THAT(find_benchmark_protocol("twin").string(), EndsWith("protocols/twin.yaml"));
  EXPECT_THROW(find_benchmark_protocol("absent"), InputError);
}

}  // namespace
}  // namespace byre
