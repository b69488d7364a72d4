#include "bags.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <numbers>
#include <stdexcept>

namespace hqslam::test {

namespace {

/// Writes a message as ROS 2 (CDR, little-endian) or ROS 1 does.
class Writer {
 public:
  explicit Writer(bool ros1) : ros1_(ros1) {
    if (!ros1) bytes = {0, 1, 0, 0};  // little-endian CDR
  }
  template <typename T>
  void number(T value) {
    while (!ros1_ && (bytes.size() - 4) % sizeof(T) != 0) bytes.push_back(0);
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(first[i]);
  }
  void words(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size() + (ros1_ ? 0 : 1)));
    bytes.insert(bytes.end(), text.begin(), text.end());
    if (!ros1_) bytes.push_back(0);
  }
  void raw(const Payload& payload) { bytes.insert(bytes.end(), payload.begin(), payload.end()); }
  void time(std::int64_t ns) {
    number(static_cast<std::uint32_t>(ns / 1'000'000'000));
    number(static_cast<std::uint32_t>(ns % 1'000'000'000));
  }
  void header(std::int64_t ns, const std::string& frame = "lidar") {
    if (ros1_) number(std::uint32_t{0});
    time(ns);
    words(frame);
  }
  Payload bytes;

 private:
  bool ros1_;
};

/// A text and before it its length.
std::string words(const std::string& text) {
  std::string bytes;
  append(bytes, static_cast<std::uint32_t>(text.size()), text);
  return bytes;
}

std::string compressed(const std::string& bytes, const std::string& compression) {
  std::string result;
  if (compression == "lz4") {
    result.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    result.resize(
        LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
  } else if (compression == "zstd") {
    result.resize(ZSTD_compressBound(bytes.size()));
    result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), 3));
  } else if (compression == "bz2") {
    auto size = static_cast<unsigned int>(bytes.size() + bytes.size() / 50 + 1000);
    result.resize(size);
    std::string source = bytes;
    if (BZ2_bzBuffToBuffCompress(result.data(), &size, source.data(),
                                 static_cast<unsigned int>(source.size()), 9, 0, 0) != BZ_OK) {
      throw std::runtime_error("bz2");
    }
    result.resize(size);
  } else {
    result = bytes;
  }
  return result;
}

void append_record(std::string& bytes, std::uint8_t opcode, const std::string& content) {
  append(bytes, opcode, std::uint64_t{content.size()}, content);
}

/// Calls add(topic's number, first message) for every topic that it was not called for, then
/// put(topic's number, message), message by message. Numbers count from 1.
template <typename Add, typename Put>
void write_messages(const std::vector<BagMessage>& messages, const Add& add, const Put& put) {
  std::map<std::string, std::uint16_t> ids;
  for (const BagMessage& message : messages) {
    const auto next = static_cast<std::uint16_t>(ids.size() + 1);
    const auto [id, is_new] = ids.try_emplace(message.topic, next);
    if (is_new) add(id->second, message);
    put(id->second, message);
  }
}

using Fields = std::vector<std::pair<std::string, std::string>>;

void append_ros1_record(std::string& bytes, const Fields& fields, const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += words(name + "=" + value);
  bytes += words(header) + words(data);
}

template <typename T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof(T)};
}

/// space_bytes: in which every packet stands, its length behind it; 0: as it is.
Payload scan_message(const std::vector<Captured>& packets, bool ros1, std::size_t space_bytes) {
  Writer writer(ros1);
  writer.header(packets.front().time_ns);
  writer.number(static_cast<std::uint32_t>(packets.size()));
  for (Captured packet : packets) {
    const auto bytes = static_cast<std::uint32_t>(packet.payload.size());
    if (space_bytes > 0) packet.payload.resize(space_bytes);
    writer.time(packet.time_ns);
    writer.raw(packet.payload);
    if (space_bytes > 0) writer.number(bytes);
  }
  return writer.bytes;
}

}  // namespace

Payload velodyne_scan_message(const std::vector<Captured>& packets, bool ros1) {
  return scan_message(packets, ros1, 0);
}

Payload pandar_scan_message(const std::vector<Captured>& packets, bool ros1) {
  return scan_message(packets, ros1, 1500);
}

std::vector<BagMessage> scan_messages(const std::string& topic, const std::string& type,
                                      const std::vector<Captured>& packets, std::size_t each,
                                      bool ros1,
                                      Payload (*message)(const std::vector<Captured>&, bool)) {
  std::vector<BagMessage> messages;
  for (std::size_t i = 0; i + each <= packets.size(); i += each) {
    const auto first = packets.begin() + static_cast<std::ptrdiff_t>(i);
    const std::vector<Captured> part(first, first + static_cast<std::ptrdiff_t>(each));
    messages.push_back({topic, type, part.front().time_ns, message(part, ros1)});
  }
  return messages;
}

Payload buffer_message(const Payload& packet, bool ros1) {
  Writer writer(ros1);
  writer.number(static_cast<std::uint32_t>(packet.size()));
  writer.raw(packet);
  return writer.bytes;
}

Payload text_message(const std::string& text, bool ros1) {
  Writer writer(ros1);
  writer.words(text);
  return writer.bytes;
}

std::vector<CloudPoint> round_cloud(double period_s, double unit_s, double zero_s) {
  std::vector<CloudPoint> points;
  for (int column = 0; column < 360; ++column) {
    for (int ring = 0; ring < 16; ++ring) {
      const double azimuth = -column * std::numbers::pi / 180.0;
      const double elevation = (-15.0 + 2.0 * ring) * std::numbers::pi / 180.0;
      points.push_back({static_cast<float>(5.0 * std::cos(elevation) * std::cos(azimuth)),
                        static_cast<float>(5.0 * std::cos(elevation) * std::sin(azimuth)),
                        static_cast<float>(5.0 * std::sin(elevation)),
                        static_cast<std::uint16_t>(ring),
                        (zero_s + period_s * column / 360.0) / unit_s});
    }
  }
  return points;
}

Payload cloud_message(std::int64_t stamp_ns, const std::vector<CloudPoint>& points, bool ros1,
                      std::uint8_t time_type, const std::string& time_name,
                      const std::string& ring_name) {
  Writer writer(ros1);
  writer.header(stamp_ns);
  writer.number(std::uint32_t{1});
  writer.number(static_cast<std::uint32_t>(points.size()));
  writer.number(std::uint32_t{5});
  const std::uint32_t step = 26;
  const auto field = [&](const std::string& name, std::uint32_t offset, std::uint8_t type) {
    writer.words(name);
    writer.number(offset);
    writer.number(type);
    writer.number(std::uint32_t{1});
  };
  field("x", 0, 7);
  field("y", 4, 7);
  field("z", 8, 7);
  field(ring_name, 12, 4);
  field(time_name, 18, time_type);
  writer.number(std::uint8_t{0});
  writer.number(step);
  writer.number(static_cast<std::uint32_t>(step * points.size()));
  writer.number(static_cast<std::uint32_t>(step * points.size()));
  // No two scans of a real sensor are the same.
  const float scale = 1.0F + 2e-7F * static_cast<float>(stamp_ns / 1'000'000 % 37);
  for (CloudPoint point : points) {
    for (float* const coordinate : {&point.x, &point.y, &point.z}) *coordinate *= scale;
    Payload bytes(step);
    std::memcpy(bytes.data(), &point.x, 4);
    std::memcpy(bytes.data() + 4, &point.y, 4);
    std::memcpy(bytes.data() + 8, &point.z, 4);
    std::memcpy(bytes.data() + 12, &point.ring, 2);
    const auto single = static_cast<float>(point.time);
    if (time_type == 6) put(bytes, 18, static_cast<std::uint32_t>(point.time));
    if (time_type == 7) std::memcpy(bytes.data() + 18, &single, 4);
    if (time_type == 8) std::memcpy(bytes.data() + 18, &point.time, 8);
    writer.raw(bytes);
  }
  writer.number(std::uint8_t{1});
  return writer.bytes;
}

Payload imu_message(std::int64_t stamp_ns, const std::string& frame, const ImuSample& sample,
                    bool ros1, double first_covariance) {
  Writer writer(ros1);
  writer.header(stamp_ns, frame);
  for (int i = 0; i < 4 + 9; ++i) writer.number(i == 3 ? 1.0 : 0.0);
  for (const Eigen::Vector3d& vector :
       {sample.angular_rate_rad_per_s, sample.specific_force_mps2}) {
    for (int i = 0; i < 3; ++i) writer.number(vector[i]);
    for (int i = 0; i < 9; ++i) writer.number(i == 0 ? first_covariance : 0.0);
  }
  return writer.bytes;
}

Payload transform_message(const std::string& parent, const std::string& child,
                          const Eigen::Quaterniond& q_parent_child, bool ros1) {
  Writer writer(ros1);
  writer.number(std::uint32_t{1});
  writer.header(0, parent);
  writer.words(child);
  for (const double metres : {1.0, 2.0, 3.0}) writer.number(metres);
  const auto& q = q_parent_child;
  for (const double number : {q.x(), q.y(), q.z(), q.w()}) writer.number(number);
  return writer.bytes;
}

std::string mcap_bytes(const std::vector<BagMessage>& messages, const std::string& compression) {
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string records;
  write_messages(
      messages,
      [&](std::uint16_t id, const BagMessage& message) {
        std::string schema;
        append(schema, id, words(message.type), words("ros2msg"), words(""));
        append_record(records, 3, schema);
        std::string channel;
        append(channel, id, id, words(message.topic), words("cdr"), words(""));
        append_record(records, 4, channel);
      },
      [&](std::uint16_t id, const BagMessage& message) {
        std::string content;
        append(content, id, std::uint32_t{0}, message.time_ns, message.time_ns, message.bytes);
        append_record(records, 5, content);
      });
  const std::string packed = compressed(records, compression);
  std::string chunk;
  append(chunk, std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{records.size()}, std::uint32_t{0},
         words(compression), std::uint64_t{packed.size()}, packed);
  std::string bytes = magic;
  append_record(bytes, 1, words("ros2") + words("a test"));
  append_record(bytes, 6, chunk);
  append_record(bytes, 15, std::string(4, '\0'));
  append_record(bytes, 2, std::string(20, '\0'));
  return bytes + magic;
}

std::string ros1_bytes(const std::vector<BagMessage>& messages, const std::string& compression) {
  std::string bytes = "#ROSBAG V2.0\n";
  append_ros1_record(bytes, {{"op", raw(std::uint8_t{3})}, {"index_pos", raw(std::uint64_t{0})}},
                     std::string(100, ' '));
  std::string records;
  write_messages(
      messages,
      [&](std::uint32_t id, const BagMessage& message) {
        std::string type = message.type;
        if (const auto at = type.find("/msg/"); at != std::string::npos) type.erase(at, 4);
        const std::string connection = words("topic=" + message.topic) + words("type=" + type);
        append_ros1_record(
            records, {{"op", raw(std::uint8_t{7})}, {"conn", raw(id)}, {"topic", message.topic}},
            connection);
      },
      [&](std::uint32_t id, const BagMessage& message) {
        const std::string time = raw(static_cast<std::uint32_t>(message.time_ns / 1'000'000'000)) +
                                 raw(static_cast<std::uint32_t>(message.time_ns % 1'000'000'000));
        append_ros1_record(records,
                           {{"op", raw(std::uint8_t{2})}, {"conn", raw(id)}, {"time", time}},
                           std::string(message.bytes.begin(), message.bytes.end()));
      });
  append_ros1_record(bytes,
                     {{"op", raw(std::uint8_t{5})},
                      {"compression", compression},
                      {"size", raw(static_cast<std::uint32_t>(records.size()))}},
                     compressed(records, compression));
  return bytes;
}

namespace {

/// A database that is open while it lives.
class Database {
 public:
  explicit Database(const std::string& path) {
    if (sqlite3_open(path.c_str(), &database_) != SQLITE_OK) throw std::runtime_error(path);
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void run(const char* sql) { sqlite3_exec(database_, sql, nullptr, nullptr, nullptr); }
  /// One number or text, or bytes, for each question mark.
  template <typename... Values>
  void run_with(const char* sql, const Values&... values) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database_, sql, -1, &statement, nullptr);
    int place = 0;
    (bind(statement, ++place, values), ...);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
  }

 private:
  static void bind(sqlite3_stmt* statement, int place, std::int64_t number) {
    sqlite3_bind_int64(statement, place, number);
  }
  static void bind(sqlite3_stmt* statement, int place, const std::string& text) {
    sqlite3_bind_text(statement, place, text.c_str(), -1, SQLITE_TRANSIENT);
  }
  static void bind(sqlite3_stmt* statement, int place, const Payload& bytes) {
    sqlite3_bind_blob(statement, place, bytes.data(), static_cast<int>(bytes.size()),
                      SQLITE_TRANSIENT);
  }

  sqlite3* database_ = nullptr;
};

}  // namespace

void write_db3(const std::vector<BagMessage>& messages, const std::string& path,
               const std::string& serialization_format) {
  Database database(path);
  database.run(
      "PRAGMA page_size = 512;"  // small files, of several pages all the same
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp "
      "INTEGER NOT NULL, data BLOB NOT NULL);"
      "BEGIN");
  write_messages(
      messages,
      [&](std::int64_t id, const BagMessage& message) {
        database.run_with("INSERT INTO topics VALUES(?, ?, ?, ?, '')", id, message.topic,
                          message.type, serialization_format);
      },
      [&](std::int64_t id, const BagMessage& message) {
        database.run_with("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", id,
                          message.time_ns, message.bytes);
      });
  database.run("COMMIT");
}

void write_endless_db3(const std::string& path) {
  write_db3({{"/points", "sensor_msgs/msg/PointCloud2", 1, Payload(8)}}, path);
  Database database(path);
  database.run(
      "DROP TABLE messages;"
      "CREATE VIEW messages AS WITH RECURSIVE endless(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM "
      "endless) SELECT n AS id, 1 AS topic_id, n AS timestamp, x'00' AS data FROM endless");
}

void copy_with_half_taken_back(const std::string& path, const std::string& copy) {
  Database database(path);
  database.run(
      "PRAGMA journal_mode = WAL;"
      "DELETE FROM messages WHERE id > (SELECT COUNT(*) / 2 FROM messages)");
  std::filesystem::copy_file(path, copy);
  std::filesystem::copy_file(path + "-wal", copy + "-wal");
}

}  // namespace hqslam::test
