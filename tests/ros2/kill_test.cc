// byre node keeps its maps intact and relocalises, whenever it is killed: BYRE_NODE_KILLS, docs/lab/ros2.md.

#include "byre/base/binary_file.h"
#include "byre/map/map_file.h"
#include "staying_up_scene.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace byre::testing_ros2 {
namespace {

enum class Moment : std::uint8_t { writing, saving, loading, tracking };

constexpr std::array kMoments = {Moment::writing, Moment::saving, Moment::loading, Moment::tracking};

const char* name_of(Moment moment) {
  switch (moment) {
    case Moment::writing:
      return "while the file is written";
    case Moment::saving:
      return "after the command save";
    case Moment::loading:
      return "while it begins";
    case Moment::tracking:
      return "while it tracks";
  }
  return "";
}

struct RobotTask {
  std::string name;
  fs::path map;
  fs::path saved;  // equal to map if the map is extended

  bool is_extended() const { return map == saved; }
  std::string config() const {
    return testing_ros2::config("  task: " + name + "\n  map: " + map.string() + "\n  save: " + saved.string() + "\n");
  }
};

// A robot whose node is repeatedly killed and restarted with the same settings.
class KilledRobot {
 public:
  KilledRobot(fs::path folder, int domain, RobotTask task, std::uint64_t seed)
      : folder_(std::move(folder)), domain_(domain), task_(std::move(task)), random_(seed) {
    fs::create_directories(folder_);
    map_bytes_ = read_file(task_.map);
  }

  // A session that ends normally: start, localise, drive, save, stop.
  void run() {
    const int before = sessions();
    begin();
    ASSERT_NO_FATAL_FAILURE(localise());
    ASSERT_NO_FATAL_FAILURE(drive());
    const auto asked = Clock::now();
    peers_->command("save");
    ASSERT_TRUE(is_saved(20s)) << node_->stderr_output();
    seconds_to_save_ = seconds_since(asked);
    EXPECT_EQ(node_->stop(), 0) << node_->stderr_output();
    check_files(before, true);
    EXPECT_FALSE(unfinished()) << "a save removes temporary files of earlier ones";
    std::printf("%s, not killed: ready after %.2f s, found after %d frames, saved in %.3f s, %d sessions\n",
                task_.name.c_str(), seconds_to_begin_, frames_to_localise_, seconds_to_save_, sessions());
  }

  // A session that is killed; checks the files that it leaves.
  void run_and_kill(Moment moment) {
    const int before = sessions();
    const auto mark = mark_of_unfinished();
    begin();
    if (moment == Moment::loading) {
      std::this_thread::sleep_for(random_duration(1.2 * seconds_to_begin_));
    } else {
      ASSERT_NO_FATAL_FAILURE(localise());
      ASSERT_NO_FATAL_FAILURE(drive());
      wait_for(moment);
    }
    EXPECT_TRUE(node_->is_running()) << "it ended by itself\n" << node_->stderr_output();
    node_.reset();
    const bool was_saved = is_saved(0s);
    check_files(before, was_saved);
    const bool is_unfinished = mark_of_unfinished() && mark_of_unfinished() != mark;
    unfinished_ += is_unfinished ? 1 : 0;
    saved_ += was_saved ? 1 : 0;
    std::printf("%s, killed %s: %s%s%s, %d sessions, %ju bytes\n", task_.name.c_str(), name_of(moment),
                moment == Moment::loading ? "" : formatted_find().c_str(), was_saved ? "saved" : "not saved",
                is_unfinished ? ", an unfinished file beside" : "", sessions(),
                fs::exists(task_.saved) ? static_cast<std::uintmax_t>(fs::file_size(task_.saved)) : 0);
    std::fflush(stdout);
  }

  const std::string& name() const { return task_.name; }
  int unfinished_files() const { return unfinished_; }  // kills that left a temporary file
  int saves() const { return saved_; }                  // saves that were answered before the kill
  int max_frames_to_localise() const { return max_frames_to_localise_; }

 private:
  static constexpr int kFramesToFind = 60;

  // The newest temporary file of the saved map; empty without one.
  std::optional<fs::path> unfinished() const {
    std::optional<fs::path> newest;
    for (const auto& entry : fs::directory_iterator(task_.saved.parent_path())) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with(task_.saved.filename().string() + ".") || !name.ends_with(".unfinished")) continue;
      newest = std::max(newest.value_or(entry.path()), entry.path(), [](const fs::path& a, const fs::path& b) {
        std::error_code gone;
        return fs::last_write_time(a, gone) < fs::last_write_time(b, gone);
      });
    }
    return newest;
  }
  Clock::duration random_duration(double seconds) {
    std::uniform_real_distribution<double> draw(0.0, seconds);
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(draw(random_)));
  }
  int draw(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  // Number of recordings in the saved map.
  int sessions() const {
    return fs::exists(task_.saved) ? static_cast<int>(load_map(task_.saved).recordings.size()) : 0;
  }
  std::string formatted_find() const { return "found after " + std::to_string(frames_to_localise_) + " frames, "; }

  void begin() {
    peers_.emplace(domain_);
    begin_ = Clock::now();
    node_.emplace(folder_, task_.config(), domain_);
    visit_ = static_cast<std::size_t>(draw(0, static_cast<int>(Visits::shared().count()) - 1));
  }

  void localise() {
    ASSERT_TRUE(peers_->is_connected()) << node_->stderr_output();
    seconds_to_begin_ = seconds_since(begin_);
    constexpr int kKnown = 20;  // frames of a visit that even the smallest map covers
    for (int i = 0; i < kFramesToFind; ++i) {
      at_ = i % (2 * kKnown) < kKnown ? i % kKnown : kKnown - 1 - i % kKnown;  // forth and back
      const auto answer = peers_->answer_to(frame(), next_time());
      ASSERT_TRUE(answer) << node_->stderr_output();
      if (!answer->has_pose) continue;
      frames_to_localise_ = i + 1;
      max_frames_to_localise_ = std::max(max_frames_to_localise_, frames_to_localise_);
      return;
    }
    FAIL() << "it does not localise in " << kFramesToFind << " frames\n" << node_->stderr_output();
  }

  // Drives on, beyond the area of half_map().
  void drive() {
    for (const int end = draw(40, std::ssize(Visits::shared()[visit_]) - 1); at_ < end;) {
      ++at_;
      ASSERT_TRUE(peers_->answer_to(frame(), next_time())) << node_->stderr_output();
    }
  }

  void wait_for(Moment moment) {
    if (moment == Moment::tracking) {
      peers_->send(frame(), next_time());
      std::this_thread::sleep_for(random_duration(0.03));
      return;
    }
    // An earlier save may have left a shorter or older file.
    const auto mark = mark_of_unfinished();
    peers_->command("save");
    if (moment == Moment::saving) {
      std::this_thread::sleep_for(random_duration(1.5 * seconds_to_save_));
      return;
    }
    const auto asked = Clock::now();
    while (mark_of_unfinished() == mark && !peers_->answer("save", 0s) && seconds_since(asked) < 20.0)
      std::this_thread::yield();
    std::this_thread::sleep_for(random_duration(0.003));
  }
  std::optional<fs::file_time_type> mark_of_unfinished() const {
    const auto file = unfinished();
    if (!file) return std::nullopt;
    std::error_code absent;
    const auto time = fs::last_write_time(*file, absent);
    return absent ? std::nullopt : std::optional(time);
  }

  bool is_saved(std::chrono::seconds patience) {
    const auto answer = peers_->answer("save", patience);
    return answer && answer->at("done") == true;
  }

  const ImageFrame& frame() const { return Visits::shared()[visit_][static_cast<std::size_t>(at_)]; }
  Timestamp next_time() { return time_ += kFrameTime; }

  void check_files(int sessions_before, bool was_saved) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(task_.saved.parent_path())) {
      names.insert(entry.path().filename().string());
    }
    const std::string stem = task_.saved.stem().string();
    names.erase(task_.saved.filename().string());
    for (const char* const version : {".previous.byre", ".previous_2.byre", ".previous_3.byre"}) {
      names.erase(stem + version);
    }
    if (const auto file = unfinished()) names.erase(file->filename().string());
    std::erase_if(names, [&](const std::string& name) {  // a link left by a kill before its rename
      return name.starts_with(stem + ".previous") && name.ends_with(".unfinished");
    });
    EXPECT_THAT(names, testing::IsEmpty()) << "no backlog";
    const int most = task_.is_extended() ? sessions_before + 1 : 1;
    EXPECT_THAT(sessions(), testing::AllOf(testing::Ge(was_saved ? most : sessions_before), testing::Le(most)));
    if (!task_.is_extended()) {
      EXPECT_EQ(read_file(task_.map), map_bytes_) << "a mission's map stays as it is";
    }
    for (const fs::path& file : {task_.saved, task_.saved.parent_path() / (stem + ".previous.byre")}) {
      if (!fs::exists(file)) continue;
      const std::string validate = std::string(BYRE_PROGRAM) + " validate " + file.string() + " > " +
                                   (folder_ / "faults.txt").string() + " 2>&1";
      EXPECT_EQ(std::system(validate.c_str()), 0) << validate;
    }
  }

  // Constant after construction.
  fs::path folder_;  // contains the node's configuration
  int domain_;
  RobotTask task_;
  std::vector<std::byte> map_bytes_;

  std::mt19937_64 random_;
  std::optional<NodePeers> peers_;
  std::optional<NodeProcess> node_;
  Clock::time_point begin_;
  std::size_t visit_ = 0;
  int at_ = 0;  // index of the visit's last frame
  Timestamp time_ = 1000s;
  double seconds_to_begin_ = 1.0;
  double seconds_to_save_ = 0.1;
  int frames_to_localise_ = 0;
  int max_frames_to_localise_ = 0;
  int unfinished_ = 0;
  int saved_ = 0;
};

TEST_F(ByreNodeStaysUp, KeepsCompleteMapsWhenKilledAtAnyTime) {
  const int kills = number_from_environment("BYRE_NODE_KILLS", 3);
  const fs::path extended = folder_ / "extended" / "barn.byre", beside = folder_ / "beside" / "beside.byre";
  for (const fs::path& file : {extended, beside}) fs::create_directories(file.parent_path());
  fs::copy_file(Visits::shared().half_map(), extended);
  std::array robots = {KilledRobot(folder_ / "extend", domain_, {"extend", extended, extended}, 1),
                       KilledRobot(folder_ / "mission", domain_, {"mission", Visits::shared().half_map(), beside}, 2)};
  for (KilledRobot& robot : robots) ASSERT_NO_FATAL_FAILURE(robot.run());
  for (int i = 0; i < kills; ++i) {
    const auto moment = static_cast<std::size_t>(i) % kMoments.size();
    const auto robot = (static_cast<std::size_t>(i) + static_cast<std::size_t>(i) / kMoments.size()) % robots.size();
    std::printf("%d: ", i + 1);
    ASSERT_NO_FATAL_FAILURE(robots[robot].run_and_kill(kMoments[moment])) << "kill " << i + 1;
  }
  for (KilledRobot& robot : robots) {
    ASSERT_NO_FATAL_FAILURE(robot.run());
    std::printf("%s: found after %d frames at most, %d saves before kills, %d kills in the midst of writing\n",
                robot.name().c_str(), robot.max_frames_to_localise(), robot.saves(), robot.unfinished_files());
  }
}

}  // namespace
}  // namespace byre::testing_ros2
