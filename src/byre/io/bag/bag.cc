#include "byre/io/bag/bag.h"

#include "byre/input_error.h"
#include "byre/io/bag/compression.h"
#include "byre/io/bag/mcap_bag.h"
#include "byre/io/bag/mcap_format.h"
#include "byre/io/bag/ros1_bag.h"
#include "byre/io/bag/sqlite_bag.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <set>
#include <system_error>

#include <unistd.h>
#include <yaml-cpp/yaml.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxSmallMessageBytes = 64u << 20;  // decompressed bytes allowed for a message of any size
constexpr std::string_view kRos1Begin = "#ROSBAG V";
constexpr std::string_view kSqliteBegin = "SQLite format 3";

// Metadata file of a rosbag2 folder.
constexpr const char* kRosbag2Metadata = "metadata.yaml";
constexpr const char* kRosbag2Key = "rosbag2_bagfile_information";

struct Rosbag2Files {
  std::vector<fs::path> files;
  std::vector<std::string> warnings{};
};

// Whether the name is that of a file in a rosbag2 folder: .mcap, .db3, .mcap.zstd, .db3.zstd.
bool has_rosbag2_name(const fs::path& file) {
  constexpr std::array<std::string_view, 4> kEndings = {".mcap", ".db3", ".mcap.zstd", ".db3.zstd"};
  const std::string name = file.filename().string();
  return std::ranges::any_of(kEndings, [&](std::string_view ending) { return name.ends_with(ending); });
}

std::vector<fs::path> sibling_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code unreadable;
    if (has_rosbag2_name(entry->path()) && entry->is_regular_file(unreadable)) files.push_back(entry->path());
  }
  // Recorders number the files; "bag_10" sorts after "bag_9".
  std::ranges::sort(files, [](const fs::path& a, const fs::path& b) {
    const std::string name = a.filename().string(), other = b.filename().string();
    return name.size() != other.size() ? name.size() < other.size() : name < other;
  });
  return files;
}

// Path relative to the folder; the first versions prefix the folder's own name.
fs::path resolve_file(const fs::path& folder, const fs::path& named) {
  const std::array<fs::path, 2> places = {folder / named, folder / named.filename()};
  std::error_code error;
  return fs::exists(places[0], error) || !fs::exists(places[1], error) ? places[0] : places[1];
}

// The files of metadata.yaml without duplicates, with a warning about these.
Rosbag2Files listed_files(const fs::path& metadata) {
  const YAML::Node bag = YAML::LoadFile(metadata.string())[kRosbag2Key];
  Rosbag2Files named;
  std::set<fs::path> known;
  int repeated = 0;
  for (const YAML::Node& file : bag["relative_file_paths"]) {
    fs::path path = resolve_file(metadata.parent_path(), file.as<std::string>());
    std::error_code error;
    const bool is_new = known.insert(fs::weakly_canonical(path, error)).second;
    if (is_new || error) {
      named.files.push_back(std::move(path));
    } else {
      ++repeated;
    }
  }
  if (repeated > 0) {
    named.warnings.push_back(metadata.string() + ": has " + std::to_string(repeated) +
                             " duplicate file names; each file is read once");
  }
  return named;
}

// Files of the bag in a folder: those in its metadata.yaml, in order; without it, all files with a rosbag2 name.
// Warnings list missing and invalid entries.
Rosbag2Files rosbag2_files(const fs::path& folder) {
  const fs::path metadata = folder / kRosbag2Metadata;
  std::error_code error;
  std::string why;
  if (!fs::is_regular_file(metadata, error)) {
    why = "is missing, as after a killed recorder";
  } else {
    try {
      Rosbag2Files named = listed_files(metadata);
      if (!named.files.empty()) return named;
      why = "lists no files";
    } catch (const YAML::Exception& exception) {
      why = std::string("cannot be parsed (") + exception.what() + ")";
    }
  }
  return {sibling_files(folder), {metadata.string() + ": " + why + "; bag files in its folder are used"}};
}

bool begins_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::ranges::equal(bytes.first(text.size()), std::as_bytes(std::span(text)));
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

bool is_rosbag2_metadata(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  FileSource source(file);
  const std::vector<std::byte> begin = read_piece(source, 0, 4096);
  return std::string_view(reinterpret_cast<const char*>(begin.data()), begin.size()).find(kRosbag2Key) !=
         std::string_view::npos;
}

// A decompressed file of a bag, removed by the destructor.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& bag) {
    const std::string ending = bag.stem().extension().string();
    const auto refuse = [&bag](const std::string& reason) {
      throw InputError(bag.string(), "cannot be decompressed: " + reason, "set TMPDIR to an existing, writable folder");
    };
    std::error_code error;
    const fs::path folder = fs::temp_directory_path(error);
    if (error) refuse("TMPDIR is not a folder");
    std::string name = (folder / "byre-XXXXXX").string() + ending;
    const int descriptor = mkstemps(name.data(), static_cast<int>(ending.size()));
    if (descriptor < 0) refuse("a file in " + folder.string() + " cannot be created: " + std::strerror(errno));
    close(descriptor);
    path_ = name;
  }
  ~TemporaryFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;  // constant after construction
};

// A bag file with the features common to all formats: individually compressed messages, recognised because CDR never
// begins with zstd's magic number, and files compressed as a whole.
class BagFile final : public Bag {
 public:
  BagFile(const fs::path& path, const TypeFilter& wanted, const BagLimits& limits);
  std::vector<std::byte> read(const BagMessage& message) override;

 private:
  // Decompresses the first bytes of a message; false if it is damaged.
  bool unpack_head(BagMessage& message);

  std::string place_;                            // constant after construction
  BagLimits limits_;                             // constant after construction
  std::unique_ptr<TemporaryFile> decompressed_;  // must outlive bag_, which reads it
  std::unique_ptr<Bag> bag_;
};

std::unique_ptr<Bag> open_file(const fs::path& path, const std::string& place, const TypeFilter& wanted,
                               const BagLimits& limits) {
  auto source = std::make_unique<FileSource>(path);
  const std::vector<std::byte> head = read_piece(*source, 0, 16);
  if (begins_with(head, kSqliteBegin)) return std::make_unique<SqliteBag>(path, place, wanted);
  if (begins_with(head, kRos1Begin)) return std::make_unique<Ros1Bag>(std::move(source), place, wanted, limits);
  if (std::ranges::equal(head.size() < kMcapMagic.size() ? head : std::vector(head.begin(), head.begin() + 8),
                         kMcapMagic)) {
    return std::make_unique<McapBag>(std::move(source), place, wanted, limits);
  }
  throw InputError(place, head.empty() ? "is empty" : "is not a bag in MCAP, sqlite3 or ROS 1 format",
                   "give a .mcap, .db3 or .bag file, or the folder of a rosbag2 bag");
}

BagFile::BagFile(const fs::path& path, const TypeFilter& wanted, const BagLimits& limits)
    : place_(path.string()), limits_(limits) {
  bool is_cut = false;
  if (path.extension() == ".zstd") {
    decompressed_ = std::make_unique<TemporaryFile>(path);
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    is_cut = !decompress_zstd_file(path, decompressed_->path(), limits.most(error ? 0 : size));
  }
  bag_ = open_file(decompressed_ ? decompressed_->path() : path, path.string(), wanted, limits);
  content_ = bag_->take_content();
  if (is_cut) content_.damage.push_back(place_ + ": is truncated or damaged: the part before the damage was read");
  std::size_t packed = 0;
  const std::size_t broken = std::erase_if(content_.messages, [&](BagMessage& message) {
    if (!is_zstd(message.head)) return false;
    ++packed;
    return !unpack_head(message);
  });
  if (decompressed_ || packed > 0) content_.compression.emplace_back("zstd");
  if (broken > 0) content_.damage.push_back(place_ + ": " + std::to_string(broken) + " messages are damaged");
}

bool BagFile::unpack_head(BagMessage& message) {
  try {
    const Decompressed head = decompress(Compression::zstd, bag_->read(message), message.head.size());
    message.head = {};
    std::ranges::copy(head.bytes, message.head.begin());
    return !head.bytes.empty();
  } catch (const InputError&) {
    return false;
  }
}

std::vector<std::byte> BagFile::read(const BagMessage& message) {
  std::vector<std::byte> bytes = bag_->read(message);
  if (!is_zstd(bytes)) return bytes;
  Decompressed whole = decompress(Compression::zstd, bytes,
                                  std::min(kMaxChunkBytes, kMaxSmallMessageBytes + limits_.ratio * bytes.size()));
  if (whole.is_whole) return std::move(whole.bytes);
  throw InputError(place_, "a message cannot be decompressed", "the bag is damaged; exclude this frame");
}

// The files of a rosbag2 folder as one bag.
class BagFolder final : public Bag {
 public:
  BagFolder(const fs::path& folder, const TypeFilter& wanted, const BagLimits& limits);
  std::vector<std::byte> read(const BagMessage& message) override { return files_[message.place.file]->read(message); }

 private:
  void add(std::unique_ptr<Bag> file);
  std::size_t topic_number(const BagTopic& topic);

  std::vector<std::unique_ptr<Bag>> files_;
};

BagFolder::BagFolder(const fs::path& folder, const TypeFilter& wanted, const BagLimits& limits) {
  const Rosbag2Files bag = rosbag2_files(folder);
  content_.damage = bag.warnings;
  std::optional<InputError> first_error;
  for (const fs::path& file : bag.files) {
    try {
      add(std::make_unique<BagFile>(file, wanted, limits));
    } catch (const InputError& error) {
      if (!first_error) first_error = error;
      content_.damage.emplace_back(error.what());
    }
  }
  if (files_.empty() && first_error) throw *first_error;
  if (files_.empty())
    throw InputError(folder.string(), "contains no bag", "give the folder with its .mcap or .db3 files");
  std::ranges::stable_sort(content_.messages, {}, &BagMessage::log_time);
}

std::size_t BagFolder::topic_number(const BagTopic& topic) {
  const auto found = std::ranges::find_if(content_.topics, [&](const BagTopic& each) {
    return each.name == topic.name && each.type == topic.type && each.encoding == topic.encoding;
  });
  if (found != content_.topics.end()) return static_cast<std::size_t>(found - content_.topics.begin());
  content_.topics.push_back({topic.name, topic.type, topic.encoding});
  return content_.topics.size() - 1;
}

void BagFolder::add(std::unique_ptr<Bag> file) {
  const BagContent added = file->take_content();
  std::vector<std::size_t> numbers;
  for (const BagTopic& topic : added.topics) {
    numbers.push_back(topic_number(topic));
    content_.topics[numbers.back()].messages += topic.messages;
  }
  for (BagMessage message : added.messages) {
    message.topic = numbers[message.topic];
    message.place.file = static_cast<std::uint32_t>(files_.size());
    content_.messages.push_back(message);
  }
  if (added.first) content_.first = std::min(content_.first.value_or(*added.first), *added.first);
  if (added.last) content_.last = std::max(content_.last.value_or(*added.last), *added.last);
  content_.storage = added.storage;
  content_.bytes += added.bytes;
  content_.message_count += added.message_count;
  content_.damage.insert(content_.damage.end(), added.damage.begin(), added.damage.end());
  for (const std::string& name : added.compression) {
    if (std::ranges::find(content_.compression, name) == content_.compression.end())
      content_.compression.push_back(name);
  }
  files_.push_back(std::move(file));
}

}  // namespace

bool has_type(const BagTopic& topic, std::string_view type) {
  return ros::short_type(topic.type) == ros::short_type(type);
}

std::optional<ros::Encoding> encoding_of(const BagTopic& topic) {
  if (topic.encoding == "cdr") return ros::Encoding::cdr;
  if (topic.encoding == "ros1") return ros::Encoding::ros1;
  return std::nullopt;
}

bool is_bag(const fs::path& path) {
  std::error_code error;
  if (is_folder(path)) {
    if (is_rosbag2_metadata(path / kRosbag2Metadata)) return true;
    for (fs::directory_iterator entry(path, error), end; !error && entry != end; entry.increment(error)) {
      if (has_rosbag2_name(entry->path())) return true;
    }
    return false;
  }
  if (!fs::is_regular_file(path, error)) return false;
  if (has_rosbag2_name(path) || path.extension() == ".bag") return true;
  try {
    FileSource source(path);
    const std::vector<std::byte> head = read_piece(source, 0, 16);
    return begins_with(head, kRos1Begin) || begins_with(head, kSqliteBegin) ||
           (head.size() >= kMcapMagic.size() && std::equal(kMcapMagic.begin(), kMcapMagic.end(), head.begin()));
  } catch (const InputError&) {
    return false;
  }
}

std::vector<fs::path> files_of_bag(const fs::path& path) {
  if (!is_folder(path)) return {path};
  std::vector<fs::path> files = rosbag2_files(path).files;
  files.push_back(path / kRosbag2Metadata);
  return files;
}

std::unique_ptr<Bag> open_bag(const fs::path& path, const TypeFilter& wanted, const BagLimits& limits) {
  if (is_folder(path)) return std::make_unique<BagFolder>(path, wanted, limits);
  return std::make_unique<BagFile>(path, wanted, limits);
}

}  // namespace byre
