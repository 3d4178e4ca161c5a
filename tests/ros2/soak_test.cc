// byre node stays up: fed frames for as long as is wanted, and killed at random times.
// BYRE_NODE_SOAK_FRAMES and BYRE_NODE_KILLS make both longer, docs/ros2.md.

#include "byre/calibration_file.h"
#include "byre/input/binary_file.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_room.h"
#include "byre/simulation/simulated_trajectory.h"
#include "byre/slam.h"
#include "node_fixture.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

namespace byre::testing_ros2 {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Clock = std::chrono::steady_clock;

constexpr Timestamp kFrameTime = 50ms;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

int number_from_environment(const char* name, int otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoi(text);
}

// Visits to a room of made-up walls, and maps of it, with images as small as are tracked well: 188 x 120 pixels.
class Visits {
 public:
  static const Visits& shared() {
    static const Visits visits;
    return visits;
  }

  fs::path calibration() const { return folder_ / "camchain.yaml"; }
  fs::path whole_map() const { return folder_ / "whole.byre"; }  // all that the visits show
  fs::path half_map() const { return folder_ / "half.byre"; }    // what they show until their middle
  std::size_t count() const { return visits_.size(); }
  const std::vector<ImageFrame>& operator[](std::size_t number) const { return visits_[number]; }

 private:
  static constexpr int kFrames = 60;

  Visits() {
    fs::create_directories(folder_);
    std::ofstream(calibration()) << write_calibration(euroc_like_calibration(4));
    const RenderedCameras cameras(euroc_like_calibration(4));
    const std::vector<ImageFrame> seen = visit(cameras, 3.0, 0);
    keep_map(seen, whole_map());
    keep_map({seen.begin(), seen.begin() + kFrames / 2}, half_map());
    for (const double length : {3.0, 2.9, 3.1}) visits_.push_back(visit(cameras, length, 1 + std::ssize(visits_)));
  }
  ~Visits() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  // length: of the way's figure of eight, metres. Each visit has noise of its own.
  static std::vector<ImageFrame> visit(const RenderedCameras& cameras, double length, std::ptrdiff_t number) {
    const RenderedRoom room({});
    std::vector<ImageFrame> frames;
    for (const StampedPose& pose :
         figure_eight_trajectory(kFrames, 20.0, length, 0.6, cameras.calibration.body_from_left)) {
      frames.push_back(room.render(cameras, pose.world_from_body, pose.time + number * 1h));
    }
    return frames;
  }

  void keep_map(const std::vector<ImageFrame>& frames, const fs::path& file) const {
    SlamOptions options;
    options.workers = Workers::repeatable;
    Slam slam = Slam::mapping(read_calibration(calibration()), options);
    for (const ImageFrame& frame : frames) slam.process(view_of(frame));
    slam.finish();
    slam.save(file);
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node_visits." + std::to_string(getpid()));
  std::vector<std::vector<ImageFrame>> visits_;
};

// Goes forth and back through a visit, so that the motion has no jump, until another visit begins.
class Player {
 public:
  explicit Player(std::uint64_t seed) : random_(seed) {}

  const ImageFrame& next() {
    if (left_-- <= 0) cut();
    const auto& frames = Visits::shared()[visit_];
    if (at_ == 0) step_ = 1;
    if (at_ + 1 == std::ssize(frames)) step_ = -1;
    at_ += step_;
    return frames[static_cast<std::size_t>(at_)];
  }
  int cuts() const { return cuts_; }

 private:
  void cut() {
    const Visits& visits = Visits::shared();
    left_ = std::uniform_int_distribution<int>(300, 1500)(random_);
    visit_ = (visit_ + 1) % visits.count();
    at_ = std::uniform_int_distribution<std::ptrdiff_t>(0, std::ssize(visits[visit_]) - 1)(random_);
    ++cuts_;
  }

  std::mt19937_64 random_;
  std::size_t visit_ = 0;
  std::ptrdiff_t at_ = 0;  // index of the last frame
  std::ptrdiff_t step_ = 1;
  int left_ = 0;  // frames until the next cut
  int cuts_ = 0;
};

// Other programs that a robot's node works with.
class Others {
 public:
  explicit Others(int domain) : peer_(domain) {}

  // Whether the node is there, and all have found one another.
  bool is_connected() {
    if (!feed_.is_heard()) return false;
    for (int attempt = 0; attempt < 100; ++attempt) {
      command("hello");
      if (answer("hello", 1s)) return feed_.settle();
    }
    return false;
  }

  void command(const std::string& text) {
    std_msgs::msg::String message;
    message.data(text);
    command_->write(&message);
  }
  // What was done, or could not be done, as the node says.
  std::optional<nlohmann::json> answer(const std::string& command, std::chrono::seconds patience = 20s) {
    const std::string part = "\"command\":\"" + command + "\"";
    const auto told =
        events_.find([&](const auto& event) { return event.data().find(part) != std::string::npos; }, patience);
    return told ? std::optional(nlohmann::json::parse(told->data())) : std::nullopt;
  }

  // What the node makes of a frame: its health and, where it has a pose in the map, its odometry.
  struct Answer {
    bool has_pose = false;
  };
  std::optional<Answer> answer_to(const ImageFrame& frame, Timestamp time) {
    health_.forget();
    odometry_.forget();
    feed_.send(frame, time - frame.time);
    const std::string stamp = "\"time_ns\":" + std::to_string(time.count()) + ",";
    const auto health = health_.find([&](const auto& text) { return text.data().find(stamp) != std::string::npos; });
    if (!health) return std::nullopt;
    const Answer answer{!nlohmann::json::parse(health->data()).at("pose").is_null()};
    if (answer.has_pose &&
        !odometry_.find([&](const auto& odometry) { return time_of(odometry.header().stamp()) == time; })) {
      return std::nullopt;
    }
    return answer;
  }
  void send(const ImageFrame& frame, Timestamp time) { feed_.send(frame, time - frame.time); }
  // So that what was heard takes no more room.
  void forget() { events_.forget(); }

 private:
  FastPeer peer_;
  Odometry odometry_{peer_, "rt/byre/odometry", kVolatile};
  Texts health_{peer_, "rt/byre/health", kVolatile};
  Texts events_{peer_, "rt/byre/events", kVolatile};
  CameraFeed feed_{peer_};
  eprosima::fastdds::dds::DataWriter* command_ =
      peer_.writer("rt/byre/command", TypeSupport(new std_msgs::msg::StringPubSubType), kVolatile);
};

// The socket of a service manager, and how long the node was silent at most.
class Watchdog {
 public:
  explicit Watchdog(const fs::path& folder) : path_(folder / "notify") {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.string().copy(address.sun_path, sizeof address.sun_path - 1);
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    reader_ = std::jthread([this](const std::stop_token& stop) { read_until(stop); });
  }
  ~Watchdog() {
    if (reader_.joinable()) stop();
    close(socket_);
  }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  static constexpr std::chrono::seconds kTime{10};  // as in byre.service
  std::vector<std::string> variables() const {
    return {"NOTIFY_SOCKET=" + path_.string(),
            "WATCHDOG_USEC=" + std::to_string(std::chrono::microseconds(kTime).count())};
  }

  // The time since the last sign counts as well.
  void stop() {
    reader_.request_stop();
    reader_.join();
    note(Clock::now());
  }
  // After stop().
  int signs() const { return signs_; }
  double longest_silence() const { return longest_; }  // seconds

 private:
  void read_until(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd polled{socket_, POLLIN, 0};
      if (poll(&polled, 1, 100) <= 0) continue;
      std::array<char, 4096> text{};
      const ssize_t size = recv(socket_, text.data(), text.size(), 0);
      if (size <= 0) continue;
      const std::string_view line(text.data(), static_cast<std::size_t>(size));
      if (line == "READY=1") last_ = Clock::now();
      if (line != "WATCHDOG=1") continue;
      note(Clock::now());
      ++signs_;
    }
  }
  void note(Clock::time_point now) {
    if (last_) longest_ = std::max(longest_, std::chrono::duration<double>(now - *last_).count());
    last_ = now;
  }

  fs::path path_;
  int socket_ = -1;
  // Written by the reader until it is stopped.
  std::optional<Clock::time_point> last_;
  double longest_ = 0.0;
  int signs_ = 0;
  std::jthread reader_;
};

// What a process holds.
struct Usage {
  long resident_kb = 0;   // all of its memory that is there
  long anonymous_kb = 0;  // without what is read from files
  long descriptors = 0;
};

Usage usage_of(pid_t process) {
  const fs::path about = "/proc/" + std::to_string(process);
  Usage usage;
  std::ifstream status(about / "status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) usage.resident_kb = std::stol(line.substr(6));
    if (line.starts_with("RssAnon:")) usage.anonymous_kb = std::stol(line.substr(8));
  }
  usage.descriptors = std::distance(fs::directory_iterator(about / "fd"), fs::directory_iterator());
  return usage;
}

std::string config(const std::string& slam) {
  return "slam:\n" + slam + "images:\n  reliable: true\n  pair_wait: 0.2\ncalibration:\n  file: " +
         Visits::shared().calibration().string() + "\n";
}

class ByreNodeStaysUp : public testing::Test {
 protected:
  ByreNodeStaysUp() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ByreNodeStaysUp() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node_soak." + std::to_string(getpid()));
  int domain_ = some_domain();
};

TEST_F(ByreNodeStaysUp, ThroughOneVisitAfterAnother) {
  const int frames = number_from_environment("BYRE_NODE_SOAK_FRAMES", 200);
  // The node's memory grows until it has as many poses of its way as it keeps, so short runs do not judge it.
  constexpr int kSettled = 20'000;  // frames
  constexpr int kJudged = 40'000;   // frames
  constexpr double kGrowth = 1.05;
  Watchdog watchdog(folder_);
  Others others(domain_);
  NodeProcess node(folder_, config("  map: " + Visits::shared().whole_map().string() + "\n"), domain_,
                   watchdog.variables());
  ASSERT_TRUE(others.is_connected()) << node.said();
  Player player(1);
  std::vector<Usage> tenths;
  int with_pose = 0;
  const auto begin = Clock::now();
  for (int i = 0; i < frames; ++i) {
    const auto answer = others.answer_to(player.next(), 1000s + i * kFrameTime);
    ASSERT_TRUE(answer) << "frame " << i << "\n" << node.said();
    if (answer->has_pose) ++with_pose;
    if ((i + 1) * 10 / frames == i * 10 / frames) continue;
    others.forget();
    tenths.push_back(usage_of(node.process()));
    const double seconds = seconds_since(begin);
    std::printf("%7d frames %7.1f s %6.1f frames/s  VmRSS %ld kB  RssAnon %ld kB  %ld descriptors\n", i + 1, seconds,
                (i + 1) / seconds, tenths.back().resident_kb, tenths.back().anonymous_kb, tenths.back().descriptors);
    std::fflush(stdout);
  }
  watchdog.stop();
  std::printf("%d of %d frames with a pose, %d cuts, %d signs of life, longest silence %.1f s\n", with_pose, frames,
              player.cuts(), watchdog.signs(), watchdog.longest_silence());
  EXPECT_GT(with_pose, frames / 2);
  EXPECT_GE(watchdog.signs(), 1);
  EXPECT_LT(watchdog.longest_silence(), watchdog.kTime.count());
  EXPECT_EQ(tenths.back().descriptors, tenths.front().descriptors);
  if (frames >= kJudged) {
    const auto settled = static_cast<std::size_t>((10LL * kSettled + frames - 1) / frames - 1);
    EXPECT_LT(static_cast<double>(tenths.back().resident_kb),
              kGrowth * static_cast<double>(tenths[settled].resident_kb));
    EXPECT_LT(static_cast<double>(tenths.back().anonymous_kb),
              kGrowth * static_cast<double>(tenths[settled].anonymous_kb));
  }
  EXPECT_EQ(node.stop(), 0) << node.said();
}

// When a node is killed.
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
  fs::path saved;  // the map itself where that is gone on with

  bool is_extended() const { return map == saved; }
  std::string config() const {
    return testing_ros2::config("  task: " + name + "\n  map: " + map.string() + "\n  save: " + saved.string() + "\n");
  }
};

// A robot whose node is killed again and again, and started with the same settings.
class KilledRobot {
 public:
  KilledRobot(fs::path folder, int domain, RobotTask task, std::uint64_t seed)
      : folder_(std::move(folder)), domain_(domain), task_(std::move(task)), random_(seed) {
    fs::create_directories(folder_);
    map_bytes_ = read_file(task_.map);
  }

  // The node begins, finds itself, saves, and ends when it is asked to.
  void live() {
    const int before = sessions();
    begin();
    ASSERT_NO_FATAL_FAILURE(find_itself());
    ASSERT_NO_FATAL_FAILURE(drive());
    const auto asked = Clock::now();
    others_->command("save");
    ASSERT_TRUE(is_saved(20s)) << node_->said();
    seconds_to_save_ = seconds_since(asked);
    EXPECT_EQ(node_->stop(), 0) << node_->said();
    look_at_files(before, true);
    EXPECT_FALSE(fs::exists(unfinished())) << "what was left of another save is gone with the next one";
    std::printf("%s, not killed: ready after %.2f s, found after %d frames, saved in %.3f s, %d sessions\n",
                task_.name.c_str(), seconds_to_begin_, frames_to_find_, seconds_to_save_, sessions());
  }

  // The node begins, finds itself, is killed, and what it leaves is looked at.
  void live_and_die(Moment moment) {
    const int before = sessions();
    const auto mark = mark_of_unfinished();
    begin();
    if (moment == Moment::loading) {
      std::this_thread::sleep_for(up_to(1.2 * seconds_to_begin_));
    } else {
      ASSERT_NO_FATAL_FAILURE(find_itself());
      ASSERT_NO_FATAL_FAILURE(drive());
      wait_for(moment);
    }
    EXPECT_TRUE(node_->is_running()) << "it has ended by itself\n" << node_->said();
    node_.reset();
    const bool was_saved = is_saved(0s);
    look_at_files(before, was_saved);
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
  int unfinished_files() const { return unfinished_; }  // kills that left one
  int saves() const { return saved_; }                  // saves that were answered before the kill
  int most_frames_to_find() const { return most_frames_to_find_; }

 private:
  static constexpr int kFramesToFind = 60;

  fs::path unfinished() const { return task_.saved.string() + ".unfinished"; }
  Clock::duration up_to(double seconds) {
    std::uniform_real_distribution<double> draw(0.0, seconds);
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(draw(random_)));
  }
  int draw(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  // Recordings that the saved map is made of.
  int sessions() const {
    return fs::exists(task_.saved) ? static_cast<int>(load_map(task_.saved).recordings.size()) : 0;
  }
  std::string formatted_find() const { return "found after " + std::to_string(frames_to_find_) + " frames, "; }

  void begin() {
    others_.emplace(domain_);
    begin_ = Clock::now();
    node_.emplace(folder_, task_.config(), domain_);
    visit_ = static_cast<std::size_t>(draw(0, static_cast<int>(Visits::shared().count()) - 1));
  }

  void find_itself() {
    ASSERT_TRUE(others_->is_connected()) << node_->said();
    seconds_to_begin_ = seconds_since(begin_);
    constexpr int kKnown = 20;  // frames of a visit that the map at its smallest surely shows
    for (int i = 0; i < kFramesToFind; ++i) {
      at_ = i % (2 * kKnown) < kKnown ? i % kKnown : kKnown - 1 - i % kKnown;  // forth and back
      const auto answer = others_->answer_to(frame(), next_time());
      ASSERT_TRUE(answer) << node_->said();
      if (!answer->has_pose) continue;
      frames_to_find_ = i + 1;
      most_frames_to_find_ = std::max(most_frames_to_find_, frames_to_find_);
      return;
    }
    FAIL() << "it does not find itself in " << kFramesToFind << " frames\n" << node_->said();
  }

  // Onwards, to where half a map does not reach.
  void drive() {
    for (const int end = draw(40, std::ssize(Visits::shared()[visit_]) - 1); at_ < end;) {
      ++at_;
      ASSERT_TRUE(others_->answer_to(frame(), next_time())) << node_->said();
    }
  }

  void wait_for(Moment moment) {
    if (moment == Moment::tracking) {
      others_->send(frame(), next_time());
      std::this_thread::sleep_for(up_to(0.03));
      return;
    }
    // What another save left is there already; it is shorter or older then.
    const auto mark = mark_of_unfinished();
    others_->command("save");
    if (moment == Moment::saving) {
      std::this_thread::sleep_for(up_to(1.5 * seconds_to_save_));
      return;
    }
    const auto asked = Clock::now();
    while (mark_of_unfinished() == mark && !others_->answer("save", 0s) && seconds_since(asked) < 20.0)
      std::this_thread::yield();
    std::this_thread::sleep_for(up_to(0.003));
  }
  std::optional<fs::file_time_type> mark_of_unfinished() const {
    std::error_code absent;
    const auto time = fs::last_write_time(unfinished(), absent);
    return absent ? std::nullopt : std::optional(time);
  }

  bool is_saved(std::chrono::seconds patience) {
    const auto answer = others_->answer("save", patience);
    return answer && answer->at("done") == true;
  }

  const ImageFrame& frame() const { return Visits::shared()[visit_][static_cast<std::size_t>(at_)]; }
  Timestamp next_time() { return time_ += kFrameTime; }

  void look_at_files(int sessions_before, bool was_saved) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(task_.saved.parent_path())) {
      names.insert(entry.path().filename().string());
    }
    const fs::path previous = task_.saved.parent_path() / (task_.saved.stem().string() + ".previous.byre");
    for (const fs::path& file : {task_.saved, unfinished(), previous}) names.erase(file.filename().string());
    names.erase(previous.filename().string() + ".unfinished");
    EXPECT_THAT(names, testing::IsEmpty()) << "nothing piles up";
    const int most = task_.is_extended() ? sessions_before + 1 : 1;
    EXPECT_THAT(sessions(), testing::AllOf(testing::Ge(was_saved ? most : sessions_before), testing::Le(most)));
    if (!task_.is_extended()) {
      EXPECT_EQ(read_file(task_.map), map_bytes_) << "a mission's map stays as it is";
    }
    for (const fs::path& file : {task_.saved, previous}) {
      if (!fs::exists(file)) continue;
      const std::string validate = std::string(BYRE_PROGRAM) + " validate " + file.string() + " > " +
                                   (folder_ / "faults.txt").string() + " 2>&1";
      EXPECT_EQ(std::system(validate.c_str()), 0) << validate;
    }
  }

  // Constant after construction.
  fs::path folder_;  // what the node is started with
  int domain_;
  RobotTask task_;
  std::vector<std::byte> map_bytes_;

  std::mt19937_64 random_;
  std::optional<Others> others_;
  std::optional<NodeProcess> node_;
  Clock::time_point begin_;
  std::size_t visit_ = 0;
  int at_ = 0;  // index of the visit's last frame
  Timestamp time_ = 1000s;
  double seconds_to_begin_ = 1.0;
  double seconds_to_save_ = 0.1;
  int frames_to_find_ = 0;
  int most_frames_to_find_ = 0;
  int unfinished_ = 0;
  int saved_ = 0;
};

TEST_F(ByreNodeStaysUp, WholeWhateverItIsKilledAt) {
  const int kills = number_from_environment("BYRE_NODE_KILLS", 3);
  const fs::path extended = folder_ / "extended" / "barn.byre", beside = folder_ / "beside" / "beside.byre";
  for (const fs::path& file : {extended, beside}) fs::create_directories(file.parent_path());
  fs::copy_file(Visits::shared().half_map(), extended);
  std::array robots = {KilledRobot(folder_ / "extend", domain_, {"extend", extended, extended}, 1),
                       KilledRobot(folder_ / "mission", domain_, {"mission", Visits::shared().half_map(), beside}, 2)};
  for (KilledRobot& robot : robots) ASSERT_NO_FATAL_FAILURE(robot.live());
  for (int i = 0; i < kills; ++i) {
    const auto moment = static_cast<std::size_t>(i) % kMoments.size();
    const auto robot = (static_cast<std::size_t>(i) + static_cast<std::size_t>(i) / kMoments.size()) % robots.size();
    std::printf("%d: ", i + 1);
    ASSERT_NO_FATAL_FAILURE(robots[robot].live_and_die(kMoments[moment])) << "kill " << i + 1;
  }
  for (KilledRobot& robot : robots) {
    ASSERT_NO_FATAL_FAILURE(robot.live());
    std::printf("%s: found after %d frames at most, %d saves before kills, %d kills in the midst of writing\n",
                robot.name().c_str(), robot.most_frames_to_find(), robot.saves(), robot.unfinished_files());
  }
}

}  // namespace
}  // namespace byre::testing_ros2
