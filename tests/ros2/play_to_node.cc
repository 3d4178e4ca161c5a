// Plays a recording of a stereo pair, or of a camera with depth, in real time to `byre node` on a saved map, like a
// camera driver, and compares the answers with Slam in this process on the same frames. Usage: byre_play_to_node
// RECORDING MAP [HZ]      20 Hz by default; images are sent reliably Exit code: 0 every frame was answered, with the
// poses of Slam to 1e-6 m, 1 otherwise, 2 wrong usage.

#include "node_fixture.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <thread>

#include <sys/resource.h>

namespace byre::testing_ros2 {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

// Odometry messages and their arrival times.
class Answers : private eprosima::fastdds::dds::DataReaderListener {
 public:
  struct Answer {
    Clock::time_point received{};
    Eigen::Vector3d position;
  };

  explicit Answers(FastPeer& peer)
      : reader_(peer.reader("rt/byre/odometry", TypeSupport(new nav_msgs::msg::OdometryPubSubType), kVolatile, this)) {}
  ~Answers() override { reader_->set_listener(nullptr); }

  std::map<Timestamp, Answer> all() {
    const std::lock_guard lock(mutex_);
    return answers_;
  }

 private:
  void on_data_available(eprosima::fastdds::dds::DataReader* reader) override {
    const Clock::time_point now = Clock::now();
    nav_msgs::msg::Odometry message;
    eprosima::fastdds::dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      const std::lock_guard lock(mutex_);
      answers_[time_of(message.header().stamp())] = {now, vector_of(message.pose().pose().position())};
    }
  }

  std::mutex mutex_;
  std::map<Timestamp, Answer> answers_;  // guarded by mutex_
  eprosima::fastdds::dds::DataReader* reader_;
};

// Processor time of this process, or of its terminated children (getrusage(2)).
double processor_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void print_statistics(const char* what, std::vector<double> values) {
  if (values.empty()) return;
  std::ranges::sort(values);
  double sum = 0.0;
  for (const double value : values) sum += value;
  const auto quantile = [&](double share) { return values[static_cast<std::size_t>(share * (values.size() - 1.0))]; };
  std::printf("%-34s mean %.2f ms, median %.2f, 99 %% %.2f, worst %.2f\n", what, sum / values.size(), quantile(0.5),
              quantile(0.99), values.back());
}

struct Playing {
  std::vector<ImageFrame> frames;
  fs::path folder, map, calibration;
  double rate = 20.0;
  std::optional<DepthCamera> depth{};  // empty for a stereo pair
};

// Results of the node, which received the frames in real time.
struct Played {
  std::vector<double> latency_ms;
  std::map<Timestamp, Answers::Answer> answers;
  double node_seconds = 0.0;  // processor time, including loading the map
};

Played play(const Playing& playing, const std::string& workers) {
  const int domain = some_domain();
  FastPeer peer(domain);
  Answers answers(peer);
  CameraFeed feed(peer, true, playing.depth ? "depth" : "right");
  const double before = processor_seconds(RUSAGE_CHILDREN);
  NodeProcess node(
      playing.folder,
      "slam:\n  workers: " + workers + "\n  map: " + playing.map.string() + "\nimages:\n  reliable: true\n" +
          (playing.depth ? "  right: ''\n  depth: /depth/image_raw\n  pair_wait: 0.02\n" : "  pair_wait: 0.2\n") +
          "calibration:\n  file: " + playing.calibration.string() + "\n",
      domain);
  if (!feed.has_subscriber() || !feed.send_acknowledged())
    throw std::runtime_error("the node does not hear: " + node.stderr_output());
  if (playing.depth) {  // tracking starts after the first depth image
    const auto first =
        std::ranges::find_if(playing.frames, [](const ImageFrame& frame) { return frame.depth.has_value(); });
    if (first == playing.frames.end()) throw std::runtime_error("no frame has depth");
    feed.send_depth({.time = {}, .left = {}, .right = {}, .depth = first->depth}, playing.depth->units_per_metre);
    std::this_thread::sleep_for(std::chrono::seconds(5));
  }
  std::map<Timestamp, Clock::time_point> sent;
  Clock::time_point next = Clock::now();
  for (const ImageFrame& frame : playing.frames) {
    std::this_thread::sleep_until(next);
    next += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / playing.rate));
    sent[frame.time] = Clock::now();
    if (frame.depth) feed.send_depth(frame, playing.depth->units_per_metre);
    feed.send(frame);
  }
  std::this_thread::sleep_for(std::chrono::seconds(2));
  Played played{{}, answers.all(), 0.0};
  node.stop();
  played.node_seconds = processor_seconds(RUSAGE_CHILDREN) - before;
  for (const auto& [time, answer] : played.answers)
    played.latency_ms.push_back(milliseconds(answer.received - sent[time]));
  return played;
}

// Results of Slam on the same frames, without pauses.
struct Tracked {
  std::vector<double> process_ms;
  std::vector<FrameReport> reports;
  double seconds = 0.0;  // processor time, including loading the map
};

Tracked track(const Playing& playing, Workers workers) {
  Tracked tracked;
  const double before = processor_seconds(RUSAGE_SELF);
  SlamOptions options;
  options.workers = workers;
  Calibration calibration = read_calibration(playing.calibration);
  calibration.depth = playing.depth;
  Slam slam = Slam::on_map(calibration, playing.map, options);
  Clock::time_point next = Clock::now();
  for (const ImageFrame& frame : playing.frames) {
    std::this_thread::sleep_until(next);
    next += std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / playing.rate));
    const Clock::time_point begin = Clock::now();
    tracked.reports.push_back(slam.process(view_of(frame)));
    tracked.process_ms.push_back(milliseconds(Clock::now() - begin));
  }
  tracked.seconds = processor_seconds(RUSAGE_SELF) - before;
  return tracked;
}

// Largest distance between the node's odometry and Slam's, metres, and number of frames with odometry but no answer.
std::pair<double, int> compared(const Tracked& tracked, const Played& played) {
  double furthest = 0.0;
  int missing = 0;
  for (const FrameReport& report : tracked.reports) {
    if (!report.odometry_from_body) continue;
    const auto answer = played.answers.find(report.time);
    if (answer == played.answers.end()) {
      ++missing;
    } else {
      furthest = std::max(furthest, (answer->second.position - report.odometry_from_body->translation).norm());
    }
  }
  return {furthest, missing};
}

int run(const fs::path& recording_path, const fs::path& map, double rate) {
  const fs::path folder = fs::temp_directory_path() / ("byre_play_to_node." + std::to_string(getpid()));
  fs::create_directories(folder);
  Playing playing{{}, folder, fs::absolute(map), folder / "camchain.yaml", rate};
  const auto recording = open_recording(recording_path, {});
  std::ofstream(playing.calibration) << write_calibration(recording->calibration());
  playing.depth = recording->calibration().depth;
  for (int i = 0; i < recording->size(); ++i) {
    if (auto frame = recording->read(i)) playing.frames.push_back(std::move(*frame));
  }
  std::printf("%zu frames at %g Hz\n", playing.frames.size(), rate);

  const Tracked live = track(playing, Workers::live);
  const Played played_live = play(playing, "live");
  print_statistics("process, in one's own program", live.process_ms);
  print_statistics("image sent to odometry received", played_live.latency_ms);
  const double seconds = static_cast<double>(playing.frames.size()) / rate;
  std::printf("%-34s %.1f s in one's own program, %.1f s in the node: %.1f %% of a core more\n", "processor time",
              live.seconds, played_live.node_seconds, 100.0 * (played_live.node_seconds - live.seconds) / seconds);

  const auto [furthest, missing] = compared(track(playing, Workers::repeatable), play(playing, "repeatable"));
  const int late = compared(live, played_live).second;
  std::printf("%-34s %d live, %d repeatable\n", "frames not answered", late, missing);
  std::printf("%-34s %.2e m at most\n", "odometry beside Slam's, repeatable", furthest);
  fs::remove_all(folder);
  return late == 0 && missing == 0 && furthest <= 1e-6 ? 0 : 1;
}

}  // namespace
}  // namespace byre::testing_ros2

int main(int argument_count, char** arguments) {
  if (argument_count < 3 || argument_count > 4) {
    std::fprintf(stderr, "usage: byre_play_to_node RECORDING MAP [HZ]\n");
    return 2;
  }
  const double rate = argument_count > 3 ? std::atof(arguments[3]) : 20.0;
  if (!(rate > 0.0)) return 2;
  return byre::testing_ros2::run(arguments[1], arguments[2], rate);
}
