#include "bags.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zstd.h>

namespace hqslam::test {
namespace {

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
void write_messages(const std::vector<BagMessage>& messages, const auto& add, const auto& put) {
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

}  // namespace

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
  void run_with(const char* sql, const auto&... values) {
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
