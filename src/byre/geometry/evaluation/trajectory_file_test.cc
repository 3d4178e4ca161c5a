#include "byre/trajectory_file.h"

#include "byre/input_error.h"

#include <cstdlib>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class TrajectoryFile : public testing::Test {
 protected:
  TrajectoryFile()
      : folder_(fs::path(testing::TempDir()) / testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~TrajectoryFile() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& content) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  fs::path folder_;
};

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

Pose sample_pose(double x) {
  return {rotation_exp({0.1 * x, -0.2, 0.3}), {x, 2.0 * x, -1.0}};
}

void expect_near(const Pose& actual, const Pose& expected, double tolerance) {
  EXPECT_LT((actual.translation - expected.translation).norm(), tolerance);
  EXPECT_LT(angle_between(actual.rotation, expected.rotation), tolerance);
}

TEST_F(TrajectoryFile, ReadsBackWhatItWrites) {
  const Trajectory trajectory = {{Timestamp(-1'500'000'000), sample_pose(-3.0)},
                                 {Timestamp(7), sample_pose(0.5)},
                                 {Timestamp(1403636584763555584), sample_pose(2.0)}};
  write_trajectory(trajectory, folder_ / "poses.txt");
  const Trajectory read = read_trajectory(folder_ / "poses.txt");
  ASSERT_EQ(read.size(), trajectory.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].time, trajectory[i].time);
    expect_near(read[i].world_from_body, trajectory[i].world_from_body, 1e-8);
  }
}

TEST_F(TrajectoryFile, IsWrittenInEachFormat) {
  const Trajectory trajectory = {{Timestamp(1403636584763555584), sample_pose(2.0)},
                                 {Timestamp(1403636584813555584), sample_pose(-0.5)}};
  const fs::path times = write("times.txt", "1403636584.763555584\n1403636584.813555584\n");
  for (const TrajectoryFormat format : {TrajectoryFormat::tum, TrajectoryFormat::euroc, TrajectoryFormat::kitti}) {
    const fs::path path = folder_ / "poses";
    write_trajectory(trajectory, path, format);
    EXPECT_EQ(guess_trajectory_format(path), format);
    const Trajectory read = format == TrajectoryFormat::kitti ? read_kitti_poses(path, times) : read_trajectory(path);
    ASSERT_EQ(read.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read[i].time, trajectory[i].time);
      expect_near(read[i].world_from_body, trajectory[i].world_from_body, 1e-8);
    }
  }
}

TEST_F(TrajectoryFile, HasTheQuaternionScalarLastInTum) {
  const Trajectory read = read_trajectory(write("tum.txt", "# time\n1.5 1 2 3 0 0 0.6 0.8\r\n"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].time, Timestamp(1'500'000'000));
  expect_near(read[0].world_from_body, {Eigen::Quaterniond(0.8, 0.0, 0.0, 0.6), {1.0, 2.0, 3.0}}, 1e-12);
}

TEST_F(TrajectoryFile, AcceptsTumWithNanosecondsOfOrbSlam) {
  const fs::path path =
      write("orb.txt", "1403636579763555584.000000 1 2 3 0 0 0 1\n1403636579813555456 1 2 3 0 0 0 1\n");
  const Trajectory read = read_trajectory(path);
  EXPECT_EQ(read[0].time, Timestamp(1403636579763555584));
  EXPECT_EQ(read[1].time, Timestamp(1403636579813555456));
}

TEST_F(TrajectoryFile, HasTheQuaternionScalarFirstInEuroc) {
  const fs::path path = write("data.csv", "#timestamp, p\n1500000000, 1, 2, 3, 0.8, 0, 0, 0.6, 9, 9, 9\r\n");
  const Trajectory read = read_trajectory(path);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].time, Timestamp(1'500'000'000));
  expect_near(read[0].world_from_body, {Eigen::Quaterniond(0.8, 0.0, 0.0, 0.6), {1.0, 2.0, 3.0}}, 1e-12);
}

TEST_F(TrajectoryFile, ReadsTheTimesOfKittiFromAnotherFile) {
  const fs::path poses = write("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 -1 0 1 1 0 0 2 0 0 1 3\n");
  const Trajectory read = read_kitti_poses(poses, write("times.txt", "0.000000e+00\n1.037000e-01\n"));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].time, Timestamp(103'700'000));
  expect_near(read[1].world_from_body, {rotation_exp({0.0, 0.0, std::acos(0.0)}), {1.0, 2.0, 3.0}}, 1e-12);
}

TEST_F(TrajectoryFile, RequiresTimesForKitti) {
  const fs::path poses = write("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(error_of([&] { read_trajectory(poses); }), HasSubstr("no time stamps"));
  EXPECT_EQ(guess_trajectory_format(poses), TrajectoryFormat::kitti);
}

TEST_F(TrajectoryFile, RequiresATimeForEachKittiPose) {
  const fs::path poses = write("00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  const fs::path times = write("times.txt", "0\n1\n");
  EXPECT_THAT(error_of([&] { read_kitti_poses(poses, times); }), HasSubstr("1 poses, but"));
}

TEST_F(TrajectoryFile, RequiresRotationsInKitti) {
  const fs::path poses = write("00.txt", "1 0 0 0 0 1 0 0 0 0 2 0\n");
  const fs::path times = write("times.txt", "0\n");
  EXPECT_THAT(error_of([&] { read_kitti_poses(poses, times); }), HasSubstr("00.txt:1: the left 3x3 part"));
}

TEST_F(TrajectoryFile, ReportsTheLineOfAnError) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"1 0 0 0 0 0 0 1\n2 0 0 x 0 0 0 1\n", "bad.txt:2: \"x\" is not a number"},
      {"1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n", "bad.txt:2: has 7 columns instead of 8"},
      {"1 0 0 0 0 0 0 1\n\n1 0 0 0 0 0 0 1\n", "bad.txt:3: repeats the previous time stamp"},
      {"2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", "bad.txt:2: is earlier"},
      {"1 0 0 0 0 0 0 1.1\n", "bad.txt:1: the quaternion has length 1.1"},
      {"1 0 nan 0 0 0 0 1\n", "bad.txt:1: \"nan\" is not a number"},
      {"1.5,0,0,0,1,0,0,0\n", "bad.txt:1: \"1.5\" is not a time in nanoseconds"},
      {"noon 0 0 0 0 0 0 1\n", "bad.txt:1: \"noon\" is not a time in seconds"},
      {"1 2 3\n", "bad.txt:1: has 3 columns, which matches no"},
      {"# nothing\n", "bad.txt: contains no poses"},
  };
  for (const auto& [content, message] : cases) {
    const fs::path path = write("bad.txt", content);
    EXPECT_THAT(error_of([&] { read_trajectory(path); }), HasSubstr(message));
  }
}

TEST_F(TrajectoryFile, IsFoundInsideARecording) {
  const fs::path truth = write("room/mav0/state_groundtruth_estimate0/data.csv", "5,1,2,3,1,0,0,0\n");
  EXPECT_EQ(find_euroc_ground_truth(folder_ / "room"), truth);
  EXPECT_EQ(find_euroc_ground_truth(folder_ / "room" / "mav0"), truth);
  EXPECT_EQ(find_euroc_ground_truth(folder_), std::nullopt);
  EXPECT_EQ(read_trajectory(folder_ / "room").size(), 1u);
  EXPECT_THAT(error_of([&] { read_trajectory(folder_); }), HasSubstr("contains no ground truth"));
}

TEST_F(TrajectoryFile, ReportsAFileThatCannotBeWritten) {
  EXPECT_THAT(error_of([&] { write_trajectory({}, folder_ / "absent" / "poses.txt"); }),
              HasSubstr("cannot be written"));
}

TEST_F(TrajectoryFile, AcceptsTimesInSecondsAndNanoseconds) {
  EXPECT_THAT(read_times(write("times.txt", "0.5\n1.5\n")),
              testing::ElementsAre(Timestamp(500'000'000), Timestamp(1'500'000'000)));
  EXPECT_THAT(read_times(write("data.csv", "#time,file\n7,7.png\n9,9.png\n")),
              testing::ElementsAre(Timestamp(7), Timestamp(9)));
  EXPECT_THAT(error_of([&] { read_times(write("none.txt", "")); }), HasSubstr("contains no times"));
  EXPECT_THAT(error_of([&] { read_times(write("back.txt", "2\n1\n")); }), HasSubstr("back.txt:2: is earlier"));
}

fs::path real_data() {
  const char* const folder = std::getenv("BYRE_DATA");
  return folder != nullptr ? fs::path(folder) : fs::path(BYRE_SOURCE_DIR) / ".." / "shared" / "data";
}

TEST(RealTrajectories, OfEurocAgreeInBothFormats) {
  const fs::path csv = real_data() / "euroc" / "MH_01_easy";
  const fs::path tum = real_data() / "euroc" / "groundtruth" / "MH_01_easy.txt";
  if (!fs::exists(csv) || !fs::exists(tum)) GTEST_SKIP() << "no EuRoC MH_01 in " << real_data() << "; set BYRE_DATA";
  const Trajectory from_csv = read_trajectory(csv);
  const Trajectory from_tum = read_trajectory(tum);
  ASSERT_GT(from_csv.size(), 3000u);
  for (const StampedPose& sample : from_csv) {
    const std::optional<Pose> other = pose_at(from_tum, sample.time, std::chrono::milliseconds(20));
    ASSERT_TRUE(other.has_value());
    ASSERT_LT((other->translation - sample.world_from_body.translation).norm(),
              1e-4);  // the file rounds times to 10 us
    ASSERT_LT(angle_between(other->rotation, sample.world_from_body.rotation), 1e-4);
  }
}

}  // namespace
}  // namespace byre
