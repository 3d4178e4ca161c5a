#include "hot_loop.h"

#include "byre/features/detect.h"
#include "byre/features/extract.h"
#include "byre/features/gaussian_blur.h"
#include "byre/features/image_threads.h"
#include "byre/features/match.h"
#include "byre/features/rectify.h"
#include "byre/features/stereo.h"
#include "byre/simulation/rendered_room_scene.h"
#include "byre/simulation/simulated_mission_scene.h"

#include <algorithm>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

struct RenderedPair {
  Calibration calibration;
  ImageFrame images;
};

// A stereo pair of EuRoC's resolution, rendered once per process because rendering is slower than most benchmarks.
const RenderedPair& rendered_pair() {
  static const RenderedPair pair = [] {
    limit_image_threads(1);
    const Calibration calibration = euroc_like_calibration(1);
    const Trajectory truth = figure_eight_trajectory(2, 1.0, 3.0, 0.1, calibration.body_from_left);
    return RenderedPair{calibration, RenderedRoom({}).render(calibration, truth.front().world_from_body, {})};
  }();
  return pair;
}

cv::Mat as_matrix(const Image& image) {
  return cv::Mat(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data())).clone();
}

struct DetectedPair {
  Rig rig;
  Pyramid left;
  Pyramid right;
  std::vector<Keypoint> keypoints;
};

DetectedPair detected_pair() {
  const auto& [calibration, images] = rendered_pair();
  const Rectifier rectifier(calibration);
  DetectedPair pair;
  pair.rig = rectifier.rig();
  build_pyramid(rectifier.left(as_matrix(images.left)), pair.left);
  build_pyramid(rectifier.right(as_matrix(*images.right)), pair.right);
  pair.keypoints = to_vector(Extractor(calibration, {}).extract({{}, images.left, {}}).frame.features->keypoints());
  return pair;
}

// Single-threaded, so that all allocations are counted.
void extract_images(benchmark::State& state, const ImageFrame& images) {
  ExtractOptions options;
  options.threads = 1;
  Extractor extractor(rendered_pair().calibration, options);
  ExtractTimes total;
  int features = 0, extractions = 0;
  measure_hot_loop(state, [&] {
    const Extraction extraction = extractor.extract(images);
    features = extraction.frame.features->size();
    ++extractions;
    total.rectify += extraction.times.rectify;
    total.extract += extraction.times.extract;
    total.stereo += extraction.times.stereo;
  });
  const auto mean_ms = [extractions](double seconds) { return 1e3 * seconds / extractions; };
  state.counters["features"] = features;
  state.counters["rectify_ms"] = mean_ms(total.rectify);
  state.counters["extract_ms"] = mean_ms(total.extract);
  state.counters["stereo_ms"] = mean_ms(total.stereo);
}

// Single loops over whole images.
void rectify_left_image(benchmark::State& state) {
  const Rectifier rectifier(rendered_pair().calibration);
  const cv::Mat image = as_matrix(rendered_pair().images.left);
  measure_hot_loop(state, [&] { benchmark::DoNotOptimize(rectifier.left(image).data); });
}
BENCHMARK(rectify_left_image)->Unit(benchmark::kMillisecond);

void shrink_to_all_octaves(benchmark::State& state) {
  const cv::Mat image = as_matrix(rendered_pair().images.left);
  Pyramid pyramid;
  measure_hot_loop(state, [&] {
    build_pyramid(image, pyramid);
    benchmark::DoNotOptimize(pyramid.levels.back().data);
  });
}
BENCHMARK(shrink_to_all_octaves)->Unit(benchmark::kMillisecond);

void blur_image(benchmark::State& state) {
  const cv::Mat image = as_matrix(rendered_pair().images.left);
  cv::Mat blurred;
  measure_hot_loop(state, [&] {
    gaussian_blur(image, blurred);
    benchmark::DoNotOptimize(blurred.data);
  });
}
BENCHMARK(blur_image)->Unit(benchmark::kMillisecond);

void detect_corners_of_image(benchmark::State& state) {
  const cv::Mat image = as_matrix(rendered_pair().images.left);
  cv::Mat strengths;
  measure_hot_loop(state, [&] {
    const ScratchVector<Corner> corners = detect_corners(image, 300, {}, strengths);
    benchmark::DoNotOptimize(corners.data());
  });
}
BENCHMARK(detect_corners_of_image)->Unit(benchmark::kMillisecond);

void extract_left_image(benchmark::State& state) {
  extract_images(state, {{}, rendered_pair().images.left, {}});
}
BENCHMARK(extract_left_image)->Unit(benchmark::kMillisecond);

void extract_stereo_pair(benchmark::State& state) {
  extract_images(state, rendered_pair().images);
}
BENCHMARK(extract_stereo_pair)->Unit(benchmark::kMillisecond);

void match_stereo_pair(benchmark::State& state) {
  const DetectedPair pair = detected_pair();
  std::vector<std::optional<StereoMatch>> matches(pair.keypoints.size());
  measure_hot_loop(state, [&] { match_stereo(pair.left, pair.right, pair.rig, pair.keypoints, {}, matches); });
  state.counters["features"] = static_cast<double>(matches.size());
  state.counters["matched"] =
      static_cast<double>(std::ranges::count_if(matches, [](const auto& match) { return match.has_value(); }));
}
BENCHMARK(match_stereo_pair)->Unit(benchmark::kMillisecond);

// Exhaustive matching, as in relocalisation.
void match_all_descriptors(benchmark::State& state) {
  SimulationOptions options;
  options.landmarks = 12000;
  const auto mission = simulate_mission(simulated_rig(), circling_trajectory(2, 10.0, 2.0, 0.01), options);
  const Features& first = *mission.frames[0].features;
  const Features& second = *mission.frames[1].features;
  std::vector<Match> matches;
  measure_hot_loop(state, [&] { matches = match_features(first, second, {}); });
  state.counters["features"] = first.size();
  state.counters["matched"] = static_cast<double>(matches.size());
}
BENCHMARK(match_all_descriptors)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
