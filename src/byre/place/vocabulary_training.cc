#include "byre/place/vocabulary.h"

#include "byre/input_error.h"
#include "byre/place/k_majority.h"
#include "byre/place/vocabulary_file.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace byre {
namespace {

constexpr int kMostBranches = 255;
constexpr int kMaxDepth = 16;

void require_range(const char* option, int value, int min, int max) {
  if (value >= min && value <= max) return;
  throw InputError(std::string("vocabulary: ") + option, "is " + std::to_string(value),
                   "choose " + std::to_string(min) + " to " + std::to_string(max));
}

// All descriptors, reordered so that those of a node are contiguous, in the order of the images.
struct Samples {
  std::vector<Descriptor> descriptors;
  std::vector<std::uint32_t> image_of;
};

// The samples of a node that is not yet split.
struct NodeRange {
  std::size_t begin = 0;
  std::size_t end = 0;
  int level = 0;

  std::size_t size() const { return end - begin; }
};

Samples gather(std::span<const std::vector<Descriptor>> descriptors_of_images) {
  Samples samples;
  for (std::size_t image = 0; image < descriptors_of_images.size(); ++image) {
    const std::vector<Descriptor>& descriptors = descriptors_of_images[image];
    samples.descriptors.insert(samples.descriptors.end(), descriptors.begin(), descriptors.end());
    samples.image_of.insert(samples.image_of.end(), descriptors.size(), static_cast<std::uint32_t>(image));
  }
  return samples;
}

// Groups the samples of a range by cluster, in stable order. Returns each cluster's start in the range, then its size.
std::vector<std::size_t> sort_by_cluster(Samples& samples, const NodeRange& range, const Clusters& clusters) {
  std::vector<std::size_t> begin_of(clusters.centres.size() + 1, 0);
  for (const int cluster : clusters.cluster_of) ++begin_of[static_cast<std::size_t>(cluster) + 1];
  std::partial_sum(begin_of.begin(), begin_of.end(), begin_of.begin());

  std::vector<Descriptor> descriptors(range.size());
  std::vector<std::uint32_t> image_of(range.size());
  std::vector<std::size_t> next = begin_of;
  for (std::size_t i = 0; i < range.size(); ++i) {
    const std::size_t target = next[static_cast<std::size_t>(clusters.cluster_of[i])]++;
    descriptors[target] = samples.descriptors[range.begin + i];
    image_of[target] = samples.image_of[range.begin + i];
  }
  const auto offset = static_cast<std::ptrdiff_t>(range.begin);
  std::ranges::copy(descriptors, samples.descriptors.begin() + offset);
  std::ranges::copy(image_of, samples.image_of.begin() + offset);
  return begin_of;
}

// Number of images with samples in the range, which is in the order of the images.
int count_images(const Samples& samples, const NodeRange& range) {
  int count = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    count += i == range.begin || samples.image_of[i] != samples.image_of[i - 1];
  }
  return count;
}

// Builds the tree node by node in breadth-first order.
class TreeGrowth {
 public:
  TreeGrowth(Samples samples, const VocabularyOptions& options, const std::function<void(double)>& progress)
      : options_(options), progress_(progress), samples_(std::move(samples)), random_(options.seed) {
    ranges_.push_back({0, samples_.descriptors.size(), 0});
    tree_.centres.emplace_back();
  }

  // image_count: number of all images, for the weights.
  VocabularyTree run(std::size_t image_count) {
    for (std::size_t node = 0; node < ranges_.size(); ++node) {
      tree_.first_child.push_back(static_cast<std::uint32_t>(ranges_.size()));
      if (!split(ranges_[node])) report(ranges_[node].size() * levels_below(ranges_[node]));
    }
    tree_.first_child.push_back(static_cast<std::uint32_t>(ranges_.size()));
    weigh(image_count);
    return std::move(tree_);
  }

 private:
  std::size_t levels_below(const NodeRange& range) const {
    return static_cast<std::size_t>(options_.depth - range.level);
  }

  // Appends the children of a node; false if it is a leaf.
  bool split(const NodeRange range) {
    if (range.level == options_.depth || range.size() < 2) return false;
    const auto descriptors = std::span(samples_.descriptors).subspan(range.begin, range.size());
    const Clusters clusters = k_majority(descriptors, options_.branching, options_.rounds, random_);
    if (clusters.centres.size() < 2) return false;
    const std::vector<std::size_t> begin_of = sort_by_cluster(samples_, range, clusters);
    for (std::size_t c = 0; c < clusters.centres.size(); ++c) {
      ranges_.push_back({range.begin + begin_of[c], range.begin + begin_of[c + 1], range.level + 1});
      tree_.centres.push_back(clusters.centres[c]);
    }
    report(range.size());
    return true;
  }

  void report(std::size_t assigned) {
    assigned_ += assigned;
    const std::size_t all = samples_.descriptors.size() * static_cast<std::size_t>(options_.depth);
    if (progress_ && assigned > 0) progress_(static_cast<double>(assigned_) / static_cast<double>(all));
  }

  // Inverse document frequency; zero for a word in every image.
  void weigh(std::size_t image_count) {
    const std::vector<std::uint32_t> first_word = first_words(tree_.first_child);
    for (std::size_t node = 0; node < ranges_.size(); ++node) {
      if (tree_.first_child[node] != tree_.first_child[node + 1]) continue;
      if (tree_.weights.size() <= first_word[node]) tree_.weights.resize(first_word[node] + 1);
      tree_.weights[first_word[node]] =
          static_cast<float>(std::log(static_cast<double>(image_count) / count_images(samples_, ranges_[node])));
    }
  }

  const VocabularyOptions& options_;
  const std::function<void(double)>& progress_;
  Samples samples_;
  std::mt19937_64 random_;
  VocabularyTree tree_;
  std::vector<NodeRange> ranges_;  // one per node
  std::size_t assigned_ = 0;       // samples assigned to nodes, counted once per level
};

}  // namespace

Vocabulary Vocabulary::train(std::span<const std::vector<Descriptor>> descriptors_of_images,
                             const VocabularyOptions& options, const std::function<void(double)>& progress) {
  require_range("branching", options.branching, 2, kMostBranches);
  require_range("depth", options.depth, 1, kMaxDepth);
  require_range("rounds", options.rounds, 1, 1000);
  if (descriptors_of_images.size() < 2) {
    throw InputError("vocabulary", "fewer than two training images are given", "give more images");
  }
  TreeGrowth growth(gather(descriptors_of_images), options, progress);
  VocabularyTree tree = growth.run(descriptors_of_images.size());
  if (tree.weights.size() < 2) {
    throw InputError("vocabulary", "the training images have fewer than two different descriptors",
                     "give images with more texture");
  }
  return of_tree(tree);
}

}  // namespace byre
