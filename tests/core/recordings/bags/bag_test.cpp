#include "bags/bag.h"

#include <zstd.h>

#include "made_bags.h"
#include "streams/stream_reader.h"

using namespace hqslam::recordings;

// What holds messages: kinds of bags, whole and damaged, and the metadata in them.

namespace {

/// The packets of a turn of an Ouster as messages.
std::vector<BagMessage> ouster_messages(const std::string& topic, std::uint32_t id, int rows = 8) {
  std::vector<BagMessage> messages;
  for (const Captured& packet : ouster_turn(OusterProfile::kRng19, id, rows)) {
    messages.push_back({topic, "ouster_sensor_msgs/msg/PacketMsg", packet.time_ns,
                        buffer_message(packet.payload, false)});
  }
  return messages;
}
BagMessage metadata_message(const std::string& topic, const std::string& text) {
  return {topic, "std_msgs/msg/String", 1, text_message(text, false)};
}

}  // namespace

TEST_CASE("every kind of bag carries the same packets") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("a.db3"));
  for (const char* compression : {"", "lz4", "zstd"}) {
    write_file(directory.file(std::string("a") + compression + ".mcap"),
               mcap_bytes(velodyne_messages(false), compression));
  }
  for (const char* compression : {"none", "lz4", "bz2"}) {
    write_file(directory.file(std::string("a") + compression + ".bag"),
               ros1_bytes(velodyne_messages(true), compression));
  }
  std::filesystem::create_directory(directory.file("folder"));
  write_file(directory.file("folder/metadata.yaml"), "rosbag2_bagfile_information:\n");
  write_db3(velodyne_messages(false), directory.file("folder/folder_0.db3"));
  const auto expected = all_scans(Recording::open(directory.file("a.db3")));
  REQUIRE(expected.size() == 4);
  for (const char* name :
       {"a.mcap", "alz4.mcap", "azstd.mcap", "anone.bag", "alz4.bag", "abz2.bag", "folder"}) {
    CAPTURE(name);
    auto source = Recording::open(directory.file(name));
    CHECK(same_scans(all_scans(source), expected));
    CHECK(source.warnings().empty());  // nothing came twice
    CHECK(inspect(directory.file(name)).streams.size() == 2);
  }
}

TEST_CASE("a bag that was cut off gives the scans before the cut, and then says so") {
  const TemporaryDirectory directory;
  const std::vector<BagMessage> messages = velodyne_messages(false);
  const std::string whole = mcap_bytes(messages, "");
  // A chunk of all messages, and one behind it of which a half is there.
  const std::string chunk = whole.substr(0, whole.size() - 8 - 2 * 9 - 4 - 20);
  const std::string path = directory.file("a.mcap");
  write_file(path, chunk + whole.substr(8, whole.size() / 2));
  auto source = Recording::open(path);
  for (int i = 0; i < 4; ++i) CHECK(source.next());
  CHECK(refused_with([&] { source.next(); }, "cut off", "mcap recover"));
  CHECK_FALSE(source.next());
  CHECK(inspect(path).scans == 4);
  CHECK(inspect(path).warnings.at(0).find("cut off") != std::string::npos);
}

TEST_CASE("a bag of which a file is missing gives the others, and then says so") {
  const TemporaryDirectory directory;
  write_db3(cloud_messages(), directory.file("a_0.db3"));
  write_file(directory.file("metadata.yaml"),
             "rosbag2_bagfile_information:\n  topics:\n    - name\n  relative_file_paths:\n"
             "    - a_0.db3\n    - a_1.db3\n");
  auto source = Recording::open(directory.path());
  for (int i = 0; i < 4; ++i) CHECK(source.next());
  CHECK(refused_with([&] { source.next(); }, "missing: a_1.db3"));
  std::filesystem::rename(directory.file("a_0.db3"), directory.file("a_0.db3.zstd"));
  CHECK(refused_with([&] { Recording::open(directory.path()); }, "unzstd"));
}

TEST_CASE("messages that were compressed by themselves are read") {
  const TemporaryDirectory directory;
  auto messages = cloud_messages();
  for (BagMessage& message : messages) {
    Payload packed(ZSTD_compressBound(message.bytes.size()));
    packed.resize(
        ZSTD_compress(packed.data(), packed.size(), message.bytes.data(), message.bytes.size(), 1));
    message.bytes = packed;
  }
  write_db3(messages, directory.file("a.db3"));
  CHECK(all_scans(Recording::open(directory.file("a.db3"))).size() == 4);
}

TEST_CASE("a bag with an empty serialization format is read, one with another is not") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("a.db3"), "");
  CHECK(all_scans(Recording::open(directory.file("a.db3"))).size() == 4);
  write_db3(velodyne_messages(false), directory.file("b.db3"), "protobuf");
  CHECK(refused_with([&] { Recording::open(directory.file("b.db3")); }, "none"));
}

TEST_CASE("an Ouster's metadata are found wherever they stand in a bag") {
  std::vector<BagMessage> messages = ouster_messages("/lidar_packets", 1);
  for (const BagMessage& later : ouster_messages("/lidar_packets", 2)) messages.push_back(later);
  messages.push_back(metadata_message("/metadata", ouster_metadata_text(OusterProfile::kRng19)));
  messages.back().time_ns = messages[messages.size() - 2].time_ns + 10'000'000'000;
  CHECK(scans_of(messages).size() == 2);
}

TEST_CASE("a bag in write-ahead mode is read without a file being written beside it") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("50 % sure? #1.db3");
  write_db3(velodyne_messages(false), path);
  std::string bytes = file_contents(path);
  bytes[18] = bytes[19] = 2;  // of SQLite's header: the versions that write and read such a file
  write_file(path, bytes);
  CHECK(all_scans(Recording::open(path)).size() == 4);
  const std::filesystem::directory_iterator files(directory.file("."));
  CHECK(std::distance(begin(files), end(files)) == 1);
}

TEST_CASE("the log beside a bag in write-ahead mode is read with it") {
  const TemporaryDirectory directory;
  write_db3(velodyne_messages(false), directory.file("whole.db3"));
  copy_with_half_taken_back(directory.file("whole.db3"), directory.file("stopped.db3"));
  const auto scans = all_scans(Recording::open(directory.file("stopped.db3")));
  CHECK(!scans.empty());
  CHECK(scans.size() < 4);
}

TEST_CASE("of several Ousters in a bag each has its own metadata, whatever other texts are there") {
  const OusterProfile profile = OusterProfile::kRng19;
  std::vector<BagMessage> messages = {
      metadata_message("/camera/metadata", "{\"width\": 640}"),
      metadata_message("/front/metadata", ouster_metadata_text(profile, 8)),
      metadata_message("/rear/metadata", ouster_metadata_text(profile, 16))};
  for (const auto& [topic, rows] :
       {std::pair("/front/lidar_packets", 8), {"/rear/lidar_packets", 16}}) {
    for (const BagMessage& message : ouster_messages(topic, 1, rows)) messages.push_back(message);
  }
  const Bag bag(messages);
  CHECK(bag.open({.stream = "/front/lidar_packets"}).sensor().rows() == 8);
  CHECK(bag.open({.stream = "/rear/lidar_packets"}).sensor().rows() == 16);
}

TEST_CASE("of a bag's metadata no more is kept than an Ouster's may be") {
  const std::string text = ouster_metadata_text(OusterProfile::kRng19);
  std::vector<BagMessage> messages = velodyne_messages(false);
  const auto add = [&](const std::string& metadata) {
    messages.insert(messages.begin(), metadata_message("/metadata", metadata));
  };
  for (std::size_t i = 0; i < 2 * kMostMetadataTexts; ++i) add(text);
  add(text + std::string(kMostMetadata_bytes, ' '));
  for (std::size_t i = 0; i < kMostMetadataTexts; ++i) add("{\"of\": \"a camera\"}");
  const Bag bag(messages);
  const StreamReader reader(bag.path, "");
  CHECK(reader.metadata().size() == kMostMetadataTexts);
  for (const TopicText& kept : reader.metadata()) CHECK(kept.text == text);
}

TEST_CASE("a topic is passed over whose name or type is longer than any is, in every kind of bag") {
  const TemporaryDirectory directory;
  const auto with_long_names = [](bool ros1) {
    std::vector<BagMessage> messages = velodyne_messages(ros1);
    for (const std::size_t bytes : {kMaxNameBytes, kMaxNameBytes + 1}) {
      messages.push_back({std::string(bytes, 'n'), "a/msg/B", 1, Payload(8)});
      messages.push_back({"/" + std::to_string(bytes), std::string(bytes, 't'), 1, Payload(8)});
    }
    return messages;
  };
  write_db3(with_long_names(false), directory.file("a.db3"));
  write_file(directory.file("a.mcap"), mcap_bytes(with_long_names(false), "zstd"));
  write_file(directory.file("a.bag"), ros1_bytes(with_long_names(true), "bz2"));
  for (const char* name : {"a.db3", "a.mcap", "a.bag"}) {
    CAPTURE(name);
    CHECK(inspect(directory.file(name)).streams.size() == 4);
  }
}

TEST_CASE("in a ROS 1 bag too long a connection and a view of messages without end are refused") {
  const TemporaryDirectory directory;
  write_file(directory.file("a.bag"),
             ros1_bytes({{"/a", std::string(1U << 20U, 't'), 1, Payload(8)}}, "bz2"));
  CHECK(refused_with([&] { Recording::open(directory.file("a.bag")); }, "at most 1048576 bytes"));
  write_endless_db3(directory.file("a.db3"));
  CHECK(
      refused_with([&] { Recording::open(directory.file("a.db3")); }, "a.db3", "whole .db3 file"));
}
