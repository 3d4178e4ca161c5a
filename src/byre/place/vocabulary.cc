#include "byre/place/vocabulary.h"

#include "byre/base/binary_file.h"
#include "byre/base/output_file.h"
#include "byre/place/dbow2_file.h"
#include "byre/place/k_majority.h"
#include "byre/place/vocabulary_file.h"

#include <algorithm>
#include <cassert>

namespace byre {

// The bytes of a vocabulary file, mapped or owned.
struct Vocabulary::Data {
  std::unique_ptr<const MappedFile> file;
  std::vector<std::byte> own_bytes;
  std::span<const std::byte> bytes;  // the whole file
  VocabularyView view;               // into `bytes`
};

namespace {

std::span<const Descriptor> children_of(const VocabularyView& view, std::uint32_t node) {
  const std::uint32_t begin = view.first_child[node];
  return view.centres.subspan(begin, view.first_child[node + 1] - begin);
}

// The child of an inner node whose subtree contains the word.
std::uint32_t child_above(const VocabularyView& view, std::uint32_t node, Word word) {
  const auto begin = view.first_word.begin() + view.first_child[node];
  const auto end = view.first_word.begin() + view.first_child[node + 1];
  return static_cast<std::uint32_t>(std::upper_bound(begin, end, word) - view.first_word.begin()) - 1;
}

void normalise(BagOfWords& bag) {
  float sum = 0.0f;
  for (const auto& [word, weight] : bag) sum += weight;
  for (auto& [word, weight] : bag) weight /= sum;
}

}  // namespace

Vocabulary::Vocabulary(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

Vocabulary Vocabulary::of_tree(const VocabularyTree& tree) {
  auto data = std::make_shared<Data>();
  data->own_bytes = write_vocabulary(tree);
  data->bytes = data->own_bytes;
  data->view = read_vocabulary(data->bytes, "vocabulary");
  return Vocabulary(std::move(data));
}

Vocabulary Vocabulary::import_dbow2(const std::filesystem::path& path) {
  return of_tree(read_dbow2(path));
}

Vocabulary Vocabulary::load(const std::filesystem::path& path) {
  auto data = std::make_shared<Data>();
  data->file = std::make_unique<const MappedFile>(path);
  data->bytes = data->file->bytes();
  data->view = read_vocabulary(data->bytes, path.string());
  return Vocabulary(std::move(data));
}

void Vocabulary::save(const std::filesystem::path& path) const {
  write_atomically(path, data_->bytes);
}

int Vocabulary::word_count() const {
  return static_cast<int>(data_->view.weights.size());
}

int Vocabulary::branching() const {
  return data_->view.branching;
}

int Vocabulary::depth() const {
  return data_->view.depth;
}

std::uint64_t Vocabulary::checksum() const {
  return data_->view.checksum;
}

Word Vocabulary::word_of(const Descriptor& descriptor) const {
  const VocabularyView& view = data_->view;
  std::uint32_t node = 0;
  for (auto children = children_of(view, node); !children.empty(); children = children_of(view, node)) {
    node = view.first_child[node] + static_cast<std::uint32_t>(nearest(children, descriptor));
  }
  return view.first_word[node];
}

std::vector<Word> Vocabulary::words_of(const Features& features) const {
  std::vector<Word> words;
  words.reserve(features.descriptors().size());
  for (const Descriptor& descriptor : features.descriptors()) words.push_back(word_of(descriptor));
  return words;
}

float Vocabulary::weight_of(Word word) const {
  return word < data_->view.weights.size() ? data_->view.weights[word] : 0.0f;
}

BagOfWords Vocabulary::bag_of(std::span<const Word> words) const {
  std::vector<Word> sorted(words.begin(), words.end());
  std::ranges::sort(sorted);
  BagOfWords bag;
  for (const Word word : sorted) {
    if (word >= data_->view.weights.size()) break;
    const float weight = data_->view.weights[word];
    if (weight == 0.0f) continue;
    if (!bag.empty() && bag.back().first == word) {
      bag.back().second += weight;
    } else {
      bag.emplace_back(word, weight);
    }
  }
  normalise(bag);
  return bag;
}

Word Vocabulary::node_above(Word word, int levels_up) const {
  const VocabularyView& view = data_->view;
  assert(word < view.weights.size());
  std::uint32_t node = 0;
  for (int level = levels_up; level < view.depth && !children_of(view, node).empty(); ++level) {
    node = child_above(view, node, word);
  }
  return view.first_word[node];
}

float similarity(const BagOfWords& a, const BagOfWords& b) {
  float shared = 0.0f;
  auto in_b = b.begin();
  for (const auto& [word, weight] : a) {
    while (in_b != b.end() && in_b->first < word) ++in_b;
    if (in_b == b.end()) break;
    if (in_b->first == word) shared += std::min(weight, in_b->second);
  }
  return shared;
}

}  // namespace byre
