#include "byre/io/bag/bag.h"

#include "byre/base/binary_file.h"
#include "byre/input_error.h"
#include "byre/io/bag/bag_scene.h"

#include <cstdlib>
#include <fstream>
#include <optional>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> expected_messages(ros::Encoding encoding) {
  std::vector<std::string> expected;
  for (const SceneMessage& message : scene_messages()) {
    expected.push_back(message.topic + " " + std::to_string(message.log_time.count()) + " " +
                       std::to_string(message.bytes(encoding).size()));
  }
  return expected;
}

class BagFiles : public BagFolderTest {
 protected:
  // Expects the messages of the scene, and the contents to describe them.
  void expect_scene(const fs::path& path, ros::Encoding encoding, const std::string& storage) const {
    const auto bag = open_bag(path, every_type);
    const BagContent& content = bag->content();
    EXPECT_EQ(content.storage, storage);
    EXPECT_EQ(content.message_count, 18u);
    EXPECT_EQ(content.first, Timestamp(std::chrono::milliseconds(1003)));
    EXPECT_EQ(content.last, Timestamp(std::chrono::milliseconds(1253)));
    ASSERT_EQ(content.topics.size(), 3u);
    for (const BagTopic& topic : content.topics) EXPECT_EQ(topic.messages, 6u) << topic.name;
    EXPECT_EQ(readable_messages(*bag), expected_messages(encoding));
    const BagMessage& second = content.messages[1];
    EXPECT_EQ(bag->read(second), scene_messages()[1].bytes(encoding));
    EXPECT_TRUE(holds<ros::Image>(content.topics[second.topic]));
    EXPECT_FALSE(holds<ros::CompressedImage>(content.topics[second.topic]));
    EXPECT_EQ(encoding_of(content.topics[second.topic]), encoding);
  }

  std::vector<std::string> damage_of(const fs::path& path) const {
    return open_bag(path, every_type)->content().damage;
  }

  fs::path write_by_writer(const std::string& name) const {
    McapWriter writer(folder_ / name);
    const std::uint16_t left = writer.add(ros::topic_of<ros::Image>("/left/image_raw"));
    const std::uint16_t right = writer.add(ros::topic_of<ros::Image>("/right/image_raw"));
    const std::uint16_t words = writer.add(ros::topic_of<ros::String>("/words"));
    for (const SceneMessage& message : scene_messages()) {
      const bool is_word = message.topic == "/words";
      writer.put(is_word ? words : (message.topic == "/left/image_raw" ? left : right), message.log_time,
                 message.bytes(ros::Encoding::cdr));
      if (is_word) writer.flush();
    }
    writer.close();
    return folder_ / name;
  }
};

TEST_F(BagFiles, ReadMcapWithAndWithoutChunksOfEachCompression) {
  for (const char* const compression : {"-", "", "lz4", "zstd"}) {
    const fs::path path = write("scene.mcap", mcap_bytes(scene_messages(), compression));
    expect_scene(path, ros::Encoding::cdr, "mcap");
    EXPECT_THAT(damage_of(path), IsEmpty()) << compression;
  }
}

TEST_F(BagFiles, ReadMcapOfTheWriter) {
  const fs::path path = write_by_writer("scene.mcap");
  expect_scene(path, ros::Encoding::cdr, "mcap");
  EXPECT_THAT(damage_of(path), IsEmpty());
  EXPECT_THAT(open_bag(path, every_type)->content().compression, ElementsAre("zstd"));
}

TEST_F(BagFiles, ReadUnclosedMcapToItsEnd) {
  BagBytes bytes = mcap_bytes(scene_messages(), "zstd");
  bytes.resize(bytes.size() - kMcapMagic.size() - kMcapRecordHead - 4);
  const fs::path path = write("scene.mcap", bytes);
  expect_scene(path, ros::Encoding::cdr, "mcap");
  EXPECT_THAT(damage_of(path), ElementsAre(HasSubstr("was not closed")));
}

TEST_F(BagFiles, ReadRos1WithoutIndex) {
  for (const char* const compression : {"none", "lz4"}) {
    const fs::path path = write("scene.bag", ros1_bytes(scene_messages(), compression));
    expect_scene(path, ros::Encoding::ros1, "rosbag 2.0");
    EXPECT_THAT(damage_of(path), ElementsAre(HasSubstr("it has no index")));
  }
}

TEST_F(BagFiles, ReadSqlite) {
  write_db3(folder_ / "scene.db3", scene_messages());
  expect_scene(folder_ / "scene.db3", ros::Encoding::cdr, "sqlite3");
  EXPECT_THAT(damage_of(folder_ / "scene.db3"), IsEmpty());
}

TEST_F(BagFiles, ReadCompressedMessages) {
  write_db3(folder_ / "scene.db3", scene_messages(), [](const BagBytes& bytes) { return compress_zstd(bytes); });
  expect_scene(folder_ / "scene.db3", ros::Encoding::cdr, "sqlite3");
  const auto bag = open_bag(folder_ / "scene.db3", every_type);
  EXPECT_THAT(bag->content().compression, ElementsAre("zstd"));
  const BagBytes first = scene_messages()[0].bytes(ros::Encoding::cdr);
  EXPECT_TRUE(std::equal(first.begin(), first.begin() + 16, bag->content().messages[0].head.begin()));
}

TEST_F(BagFiles, SkipMessagesThatFailToDecompress) {
  int count = 0;
  write_db3(folder_ / "scene.db3", scene_messages(), [&count](const BagBytes& bytes) {
    BagBytes packed = compress_zstd(bytes);
    if (++count == 2) packed.resize(5);
    return packed;
  });
  const auto bag = open_bag(folder_ / "scene.db3", every_type);
  EXPECT_EQ(readable_messages(*bag).size(), 17u);
  EXPECT_THAT(bag->content().damage, ElementsAre(HasSubstr("scene.db3: 1 messages are damaged")));
}

TEST_F(BagFiles, ReadCompressedFiles) {
  const fs::path whole = write("scene.mcap.zstd", compress_zstd(mcap_bytes(scene_messages(), "-")));
  expect_scene(whole, ros::Encoding::cdr, "mcap");
  write_db3(folder_ / "scene.db3", scene_messages());
  std::ifstream file(folder_ / "scene.db3", std::ios::binary);
  const std::string database((std::istreambuf_iterator<char>(file)), {});
  expect_scene(write("packed.db3.zstd", compress_zstd(std::as_bytes(std::span(database)))), ros::Encoding::cdr,
               "sqlite3");
  const BagBytes bytes = mcap_bytes(scene_messages(), "-");
  BagBytes cut = compress_zstd(std::span(bytes).first(bytes.size() / 2));
  const BagBytes rest = compress_zstd(std::span(bytes).subspan(bytes.size() / 2));
  cut.insert(cut.end(), rest.begin(), rest.end() - 9);
  EXPECT_THAT(damage_of(write("cut.mcap.zstd", cut)),
              testing::Contains(HasSubstr("cut.mcap.zstd: is truncated or damaged")));
}

TEST_F(BagFiles, ReportFilesThatFailToDecompress) {
  const fs::path whole = write("scene.mcap.zstd", compress_zstd(mcap_bytes(scene_messages(), "-")));
  const auto refusal = [&whole](const std::string& folder) -> std::string {
    const char* const set = std::getenv("TMPDIR");
    const std::string before = set != nullptr ? set : "/tmp";
    setenv("TMPDIR", folder.c_str(), 1);
    std::string reason;
    try {
      open_bag(whole, every_type);
    } catch (const InputError& error) {
      reason = error.what();
    }
    setenv("TMPDIR", before.c_str(), 1);
    return reason;
  };
  EXPECT_EQ(refusal(folder_ / "absent"), whole.string() +
                                             ": cannot be decompressed: TMPDIR is not a folder (set TMPDIR to "
                                             "an existing, writable folder)");
  EXPECT_EQ(refusal(folder_), "");
}

TEST_F(BagFiles, JoinTheFilesOfARosbag2Folder) {
  const std::vector<SceneMessage> all = scene_messages();
  write("bag/bag_0.mcap", mcap_bytes({all.begin(), all.begin() + 9}, "zstd"));
  write("bag/bag_1.mcap", mcap_bytes({all.begin() + 9, all.end()}, "zstd"));
  write("bag/metadata.yaml",
        "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n"
        "    - bag_0.mcap\n    - bag_1.mcap\n");
  expect_scene(folder_ / "bag", ros::Encoding::cdr, "mcap");
  EXPECT_THAT(damage_of(folder_ / "bag"), IsEmpty());

  fs::remove(folder_ / "bag/metadata.yaml");
  expect_scene(folder_ / "bag", ros::Encoding::cdr, "mcap");
  EXPECT_THAT(damage_of(folder_ / "bag"), ElementsAre(HasSubstr("metadata.yaml: is missing")));
}

TEST_F(BagFiles, ReadDuplicateFilesOfMetadataOnce) {
  write("bag/bag_0.mcap", mcap_bytes(scene_messages(), "zstd"));
  fs::create_symlink("bag_0.mcap", folder_ / "bag/link.mcap");
  write("bag/metadata.yaml",
        "rosbag2_bagfile_information:\n  relative_file_paths: [bag_0.mcap, ./bag_0.mcap, bag_0.mcap, link.mcap]\n");
  expect_scene(folder_ / "bag", ros::Encoding::cdr, "mcap");
  EXPECT_THAT(damage_of(folder_ / "bag"), ElementsAre(HasSubstr("metadata.yaml: has 3 duplicate file names")));
}

TEST_F(BagFiles, LimitTheDecompressedSize) {
  const std::vector<fs::path> chunked = {write("chunk.mcap", mcap_bytes(scene_messages(), "zstd")),
                                         write("chunk.bag", ros1_bytes(scene_messages(), "lz4"))};
  for (const fs::path& path : chunked) {
    const auto bag = open_bag(path, every_type, {.free_bytes = 100, .ratio = 0});
    EXPECT_EQ(bag->content().message_count, 0u) << path;
    EXPECT_THAT(bag->content().damage, testing::Contains(HasSubstr("chunks were not read"))) << path;
    EXPECT_EQ(open_bag(path, every_type, {.free_bytes = 0, .ratio = 100})->content().message_count, 18u) << path;
  }
  const fs::path whole = write("file.mcap.zstd", compress_zstd(mcap_bytes(scene_messages(), "-")));
  EXPECT_THROW(open_bag(whole, every_type, {.free_bytes = 100, .ratio = 0}), InputError);
  EXPECT_EQ(open_bag(whole, every_type)->content().message_count, 18u);
}

TEST_F(BagFiles, ReportMissingFilesOfARosbag2Folder) {
  const std::vector<SceneMessage> all = scene_messages();
  write("bag/bag_1.mcap", mcap_bytes({all.begin() + 9, all.end()}, "zstd"));
  write("bag/metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [bag_0.mcap, bag_1.mcap]\n");
  const auto bag = open_bag(folder_ / "bag", every_type);
  EXPECT_EQ(bag->content().message_count, 9u);
  EXPECT_THAT(bag->content().damage, ElementsAre(HasSubstr("bag_0.mcap: cannot be opened")));
}

TEST_F(BagFiles, ListTopicsOfTheSelectedTypesOnly) {
  const fs::path path = write("scene.mcap", mcap_bytes(scene_messages(), "zstd"));
  const auto bag = open_bag(path, [](std::string_view type) { return type == "std_msgs/msg/String"; });
  EXPECT_EQ(bag->content().messages.size(), 6u);
  EXPECT_EQ(bag->content().message_count, 18u);
}

TEST_F(BagFiles, RecogniseBagsByContent) {
  EXPECT_TRUE(is_bag(write("a", mcap_bytes({}, "-"))));
  EXPECT_TRUE(is_bag(write("b", ros1_bytes({}))));
  EXPECT_TRUE(is_bag(write("empty.bag", std::string())));
  EXPECT_FALSE(is_bag(write("c", std::string("not a bag"))));
  EXPECT_FALSE(is_bag(folder_ / "absent"));
  EXPECT_FALSE(is_bag(folder_));
  write("d/metadata.yaml", std::string("rosbag2_bagfile_information: {}\n"));
  EXPECT_TRUE(is_bag(folder_ / "d"));
  write("e/metadata.yaml", std::string("title: something else\n"));
  EXPECT_FALSE(is_bag(folder_ / "e"));
}

TEST_F(BagFiles, RejectOtherFilesByName) {
  for (const char* const name : {"text.bag", "text.mcap", "text.db3"}) {
    try {
      open_bag(write(name, std::string("hello, this is text")), every_type);
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string(name) + ": is not a bag"));
    }
  }
  EXPECT_THROW(open_bag(folder_ / "absent.mcap", every_type), InputError);
  EXPECT_THROW(open_bag(write("db.db3", std::string("SQLite format 3\0rest of it", 26)), every_type), InputError);
}

TEST_F(BagFiles, ContinueAfterADamagedChunk) {
  const fs::path path = write_by_writer("scene.mcap");
  BagBytes bytes = read_file(path);
  std::size_t third = 0;  // start of the third chunk's zstd frame
  for (int chunk = 0; chunk < 3; ++third) chunk += is_zstd(std::span(bytes).subspan(third)) ? 1 : 0;
  std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(third) + 20, 8, std::byte{0});
  write("scene.mcap", bytes);
  const auto bag = open_bag(path, every_type);
  EXPECT_EQ(readable_messages(*bag).size(), 15u);
  EXPECT_THAT(bag->content().damage, ElementsAre(HasSubstr("1 record is damaged")));
}

}  // namespace
}  // namespace byre
