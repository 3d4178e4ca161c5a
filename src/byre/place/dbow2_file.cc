#include "byre/place/dbow2_file.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace byre {
namespace {

constexpr std::size_t kDescriptorBytes = 32;
constexpr std::size_t kNodeFields = kDescriptorBytes + 3;

struct Dbow2Header {
  std::uint32_t branching = 0;
  std::uint32_t depth = 0;
};

struct Dbow2Node {
  std::uint32_t parent = 0;
  bool is_leaf = false;
  Descriptor centre{};
  float weight = 0.0f;
};

// The line that is parsed, for messages.
struct Line {
  const std::filesystem::path& path;
  const TextLine& text;

  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(place_of(path, text), reason, "give a vocabulary in the text format of DBoW2");
  }
};

std::uint32_t parse_integer(const Line& line, std::string_view field, const std::string& what, std::uint32_t min,
                            std::uint32_t max) {
  const std::optional<double> value = parse_number(field);
  if (value && *value == std::floor(*value) && *value >= min && *value <= max)
    return static_cast<std::uint32_t>(*value);
  line.fail(what + " is \"" + std::string(field) + "\", not a whole number from " + std::to_string(min) + " to " +
            std::to_string(max));
}

Dbow2Header parse_header(const Line& line) {
  const std::vector<std::string_view> fields = split_fields(line.text.text);
  if (fields.size() != 4)
    line.fail("has " + std::to_string(fields.size()) + " fields instead of k, L, scoring, weighting");
  Dbow2Header header;
  header.branching = parse_integer(line, fields[0], "the branching k", 2, 255);
  header.depth = parse_integer(line, fields[1], "the depth L", 1, 16);
  parse_integer(line, fields[2], "the scoring", 0, 5);
  parse_integer(line, fields[3], "the weighting", 0, 3);
  return header;
}

Descriptor parse_descriptor(const Line& line, std::span<const std::string_view> fields) {
  std::array<std::uint8_t, kDescriptorBytes> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(parse_integer(line, fields[i], "a byte of the descriptor", 0, 255));
  }
  Descriptor descriptor;
  std::memcpy(descriptor.data(), bytes.data(), bytes.size());
  return descriptor;
}

// number: index of the node.
Dbow2Node parse_node(const Line& line, std::uint32_t number) {
  const std::vector<std::string_view> fields = split_fields(line.text.text);
  if (fields.size() != kNodeFields) {
    line.fail("has " + std::to_string(fields.size()) + " fields instead of " + std::to_string(kNodeFields) +
              ": parent, is_leaf, 32 bytes, weight");
  }
  Dbow2Node node;
  node.parent = parse_integer(line, fields[0], "the parent", 0, number - 1);
  node.is_leaf = parse_integer(line, fields[1], "is_leaf", 0, 1) == 1;
  node.centre = parse_descriptor(line, std::span(fields).subspan(2, kDescriptorBytes));
  const std::optional<double> weight = parse_number(fields.back());
  if (!weight || !(*weight >= 0.0 && *weight <= std::numeric_limits<float>::max())) {
    line.fail("the weight is \"" + std::string(fields.back()) + "\", not a number from 0");
  }
  node.weight = static_cast<float>(*weight);
  return node;
}

// Nodes by index, with the root. The children of node n are children[first_child[n]] to children[first_child[n + 1]].
struct Dbow2Tree {
  std::vector<Dbow2Node> nodes;
  std::vector<std::uint32_t> first_child;
  std::vector<std::uint32_t> children;
};

void link_children(Dbow2Tree& tree) {
  const std::size_t node_count = tree.nodes.size();
  tree.first_child.assign(node_count + 1, 0);
  for (std::size_t node = 1; node < node_count; ++node) ++tree.first_child[tree.nodes[node].parent + 1];
  std::partial_sum(tree.first_child.begin(), tree.first_child.end(), tree.first_child.begin());
  tree.children.resize(node_count - 1);
  std::vector<std::uint32_t> next = tree.first_child;
  for (std::uint32_t node = 1; node < node_count; ++node) tree.children[next[tree.nodes[node].parent]++] = node;
}

// lines: the header, then one line per node except the root.
void require_consistent(const Dbow2Tree& tree, const Dbow2Header& header, const std::filesystem::path& path,
                        std::span<const TextLine> lines) {
  std::vector<std::uint32_t> level(tree.nodes.size(), 0);
  for (std::size_t node = 0; node < tree.nodes.size(); ++node) {
    const Line line{path, lines[node]};
    const std::uint32_t child_count = tree.first_child[node + 1] - tree.first_child[node];
    const std::string name = "node " + std::to_string(node);
    if (node > 0) level[node] = level[tree.nodes[node].parent] + 1;
    if (level[node] > header.depth) line.fail(name + " is deeper than L");
    if (child_count > header.branching) line.fail(name + " has more than k children");
    if (tree.nodes[node].is_leaf && child_count > 0) line.fail(name + " is marked as a leaf but has children");
    if (!tree.nodes[node].is_leaf && child_count == 0) line.fail(name + " has no children but is not marked as a leaf");
  }
}

VocabularyTree breadth_first(const Dbow2Tree& tree) {
  VocabularyTree result;
  std::vector<std::uint32_t> order = {0};
  order.reserve(tree.nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t node = order[i];
    result.centres.push_back(tree.nodes[node].centre);
    result.first_child.push_back(static_cast<std::uint32_t>(order.size()));
    const auto begin = tree.children.begin();
    order.insert(order.end(), begin + tree.first_child[node], begin + tree.first_child[node + 1]);
  }
  result.first_child.push_back(static_cast<std::uint32_t>(order.size()));

  const std::vector<std::uint32_t> first_word = first_words(result.first_child);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!tree.nodes[order[i]].is_leaf) continue;
    if (result.weights.size() <= first_word[i]) result.weights.resize(first_word[i] + 1);
    result.weights[first_word[i]] = tree.nodes[order[i]].weight;
  }
  return result;
}

}  // namespace

VocabularyTree read_dbow2(const std::filesystem::path& path) {
  const std::vector<TextLine> lines = read_lines(path);
  if (lines.size() < 2)
    throw InputError(path.string(), "has no nodes", "give a vocabulary in the text format of DBoW2");
  const Dbow2Header header = parse_header({path, lines.front()});
  Dbow2Tree tree;
  tree.nodes.reserve(lines.size());
  tree.nodes.emplace_back();
  for (std::size_t i = 1; i < lines.size(); ++i) {
    tree.nodes.push_back(parse_node({path, lines[i]}, static_cast<std::uint32_t>(i)));
  }
  link_children(tree);
  require_consistent(tree, header, path, lines);
  return breadth_first(tree);
}

}  // namespace byre
