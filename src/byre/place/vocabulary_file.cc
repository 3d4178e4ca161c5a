#include "byre/place/vocabulary_file.h"

#include "byre/base/byte_stream.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string_view>

namespace byre {
namespace {

constexpr std::string_view kMagic = "byrevoc\n";
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kHeaderSize = 64;
constexpr std::size_t kHeaderChecksumAt = 56;  // byte offset; checksum of the header's bytes before it
constexpr std::uint32_t kMaxBranching = 255;

struct Header {
  std::uint32_t node_count = 0;
  std::uint32_t word_count = 0;
  std::uint64_t centres_checksum = 0;
  std::uint64_t children_checksum = 0;
  std::uint64_t weights_checksum = 0;
  std::uint64_t checksum = 0;
};

// A section of the file, with its name and offset for messages.
class Section {
 public:
  // Fails if the section reaches beyond the end of the file.
  Section(std::span<const std::byte> file, const std::string& name, const std::string& section, std::size_t begin,
          std::size_t size)
      : place_(name + ": section " + section), begin_(begin) {
    if (begin > file.size() || size > file.size() - begin) {
      fail(file.size() - std::min(begin, file.size()),
           "ends too early: its " + std::to_string(size) + " bytes reach beyond the end of the file");
    }
    bytes_ = file.subspan(begin, size);
  }

  std::size_t end() const { return begin_ + bytes_.size(); }
  ByteReader reader() const { return {bytes_, place_, begin_}; }

  // Precondition: the section is aligned for T in memory.
  template <typename T>
  std::span<const T> as() const {
    return {reinterpret_cast<const T*>(bytes_.data()), bytes_.size() / sizeof(T)};
  }

  void require_checksum(std::uint64_t expected) const {
    if (checksum(bytes_) != expected) fail(0, "does not have the checksum given in the header");
  }

  // offset: bytes from the start of the section.
  [[noreturn]] void fail(std::size_t offset, const std::string& reason) const {
    throw InputError(place_ + " at byte " + std::to_string(begin_ + offset), reason,
                     "the file is damaged; use a copy, or create it again");
  }

 private:
  std::string place_;
  std::size_t begin_;
  std::span<const std::byte> bytes_;
};

void require_own_format(std::span<const std::byte> file, const std::string& name) {
  const std::string_view start(reinterpret_cast<const char*>(file.data()), std::min(file.size(), kMagic.size()));
  if (start == kMagic) return;
  throw InputError(name + ": section header at byte 0", "is not a vocabulary of byre",
                   "convert text files of DBoW2 with \"byre vocabulary import\"");
}

void require_known_version(std::uint32_t version, const std::string& name) {
  if (version == kVersion) return;
  throw InputError(name + ": section header at byte 8",
                   "has format " + std::to_string(version) + "; this program reads format " + std::to_string(kVersion),
                   "use the version of byre that wrote the vocabulary, or train it again");
}

Header read_header(std::span<const std::byte> file, const std::string& name) {
  require_own_format(file, name);
  const Section section(file, name, "header", 0, kHeaderSize);
  ByteReader reader = section.reader();
  reader.take(kMagic.size());
  require_known_version(reader.read<std::uint32_t>(), name);
  Header header;
  header.node_count = reader.read<std::uint32_t>();
  header.word_count = reader.read<std::uint32_t>();
  reader.take(sizeof(std::uint32_t));
  header.centres_checksum = reader.read<std::uint64_t>();
  header.children_checksum = reader.read<std::uint64_t>();
  header.weights_checksum = reader.read<std::uint64_t>();
  reader.take(sizeof(std::uint64_t));
  header.checksum = reader.read<std::uint64_t>();
  if (checksum(file.first(kHeaderChecksumAt)) != header.checksum) section.fail(0, "has a wrong checksum");
  return header;
}

// Requires that every node except the root is the child of exactly one earlier node.
void require_tree(const Section& section, std::span<const std::uint32_t> first_child) {
  const auto node_count = static_cast<std::uint32_t>(first_child.size() - 1);
  if (first_child.front() != 1) section.fail(0, "the children of the root do not begin with node 1");
  for (std::uint32_t node = 0; node < node_count; ++node) {
    const std::uint32_t begin = first_child[node], end = first_child[node + 1];
    if (begin > end || end - begin > kMaxBranching || (begin < end && begin <= node)) {
      section.fail(node * sizeof(std::uint32_t), "has invalid children of node " + std::to_string(node));
    }
  }
  if (first_child.back() != node_count) section.fail(node_count * sizeof(std::uint32_t), "has nodes without parent");
}

void require_weights(const Section& section, std::span<const float> weights) {
  for (std::size_t word = 0; word < weights.size(); ++word) {
    if (!(std::isfinite(weights[word]) && weights[word] >= 0.0f)) {
      section.fail(word * sizeof(float), "word " + std::to_string(word) + " has no valid weight");
    }
  }
}

// Number of levels below the root; a level's children are the next level.
int depth_of(std::span<const std::uint32_t> first_child) {
  int depth = 0;
  for (std::uint32_t begin = 0, end = 1; first_child[begin] < first_child[end]; ++depth) {
    begin = first_child[begin];
    end = first_child[end];
  }
  return depth;
}

int branching_of(std::span<const std::uint32_t> first_child) {
  std::uint32_t most = 0;
  for (std::size_t node = 0; node + 1 < first_child.size(); ++node) {
    most = std::max(most, first_child[node + 1] - first_child[node]);
  }
  return static_cast<int>(most);
}

std::uint32_t leaf_count(std::span<const std::uint32_t> first_child) {
  std::uint32_t count = 0;
  for (std::size_t node = 0; node + 1 < first_child.size(); ++node) count += first_child[node] == first_child[node + 1];
  return count;
}

}  // namespace

std::vector<std::uint32_t> first_words(std::span<const std::uint32_t> first_child) {
  const std::size_t node_count = first_child.size() - 1;
  std::vector<std::uint32_t> words_below(node_count);
  for (std::size_t node = node_count; node-- > 0;) {
    if (first_child[node] == first_child[node + 1]) words_below[node] = 1;
    for (std::uint32_t child = first_child[node]; child < first_child[node + 1]; ++child) {
      words_below[node] += words_below[child];
    }
  }
  std::vector<std::uint32_t> first_word(node_count);
  for (std::size_t node = 0; node < node_count; ++node) {
    std::uint32_t word = first_word[node];
    for (std::uint32_t child = first_child[node]; child < first_child[node + 1]; ++child) {
      first_word[child] = word;
      word += words_below[child];
    }
  }
  return first_word;
}

std::vector<std::byte> write_vocabulary(const VocabularyTree& tree) {
  assert(tree.first_child.size() == tree.centres.size() + 1);
  ByteWriter writer;
  writer.write_all(std::span(kMagic));
  writer.write(kVersion);
  writer.write(static_cast<std::uint32_t>(tree.centres.size()));
  writer.write(static_cast<std::uint32_t>(tree.weights.size()));
  writer.write(std::uint32_t{0});
  writer.write(checksum(std::as_bytes(std::span(tree.centres))));
  writer.write(checksum(std::as_bytes(std::span(tree.first_child))));
  writer.write(checksum(std::as_bytes(std::span(tree.weights))));
  writer.write(std::uint64_t{0});
  writer.write(checksum(writer.bytes()));
  writer.write_bytes(std::as_bytes(std::span(tree.centres)));
  writer.write_all(std::span(tree.first_child));
  writer.write_all(std::span(tree.weights));
  return writer.bytes();
}

VocabularyView read_vocabulary(std::span<const std::byte> bytes, const std::string& name) {
  const Header header = read_header(bytes, name);
  const std::size_t node_count = header.node_count;
  const Section centres(bytes, name, "centres", kHeaderSize, node_count * sizeof(Descriptor));
  const Section children(bytes, name, "children", centres.end(), (node_count + 1) * sizeof(std::uint32_t));
  const Section weights(bytes, name, "weights", children.end(), header.word_count * sizeof(float));
  if (weights.end() != bytes.size()) weights.fail(weights.end() - children.end(), "is not at the end of the file");
  centres.require_checksum(header.centres_checksum);
  children.require_checksum(header.children_checksum);
  weights.require_checksum(header.weights_checksum);

  VocabularyView view{centres.as<Descriptor>(), children.as<std::uint32_t>(), weights.as<float>(), {}, 0, 0, 0};
  if (node_count < 2) children.fail(0, "has no word");
  require_tree(children, view.first_child);
  require_weights(weights, view.weights);
  if (leaf_count(view.first_child) != view.weights.size())
    weights.fail(0, "has a number of weights other than the number of words");
  view.first_word = first_words(view.first_child);
  view.branching = branching_of(view.first_child);
  view.depth = depth_of(view.first_child);
  view.checksum = header.checksum;
  return view;
}

}  // namespace byre
