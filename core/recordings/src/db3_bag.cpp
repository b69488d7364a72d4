#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>

#include "bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam::recordings {

namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinalizeStatement>;

[[noreturn]] void fail(const std::string& path, sqlite3* database) {
  throw Error(fmt::format("{}: expected a ROS 2 bag (sqlite), found '{}'; give a whole .db3 file",
                          path, excerpt(sqlite3_errmsg(database), kNameCharacters)));
}

/// The name by which SQLite reads a bag without writing: one in write-ahead mode (rosbag2's preset
/// "resilient") would get two files beside it, and could not be read in a folder that may not be
/// written. A log that lies beside it already has what the bag has not yet: it is read, too.
std::string uri_of(const std::string& path) {
  std::string uri = path.starts_with('/') ? "file://" : "file:";
  for (const char c : path) {
    if (c == '%' || c == '?' || c == '#') {
      uri += fmt::format("%{:02x}", static_cast<int>(c));
    } else {
      uri += c;
    }
  }
  std::error_code unknown;
  const bool has_log = std::filesystem::exists(path + "-wal", unknown) ||
                       std::filesystem::exists(path + "-journal", unknown);
  return has_log ? uri : uri + "?immutable=1";
}

Database opened(const std::string& path) {
  sqlite3* raw = nullptr;
  const int status =
      sqlite3_open_v2(uri_of(path).c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
  Database database(raw);
  if (status != SQLITE_OK) fail(path, raw);
  // No bag has views, and one may have rows without end. What a file's table of contents calls a
  // table may be one all the same.
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxChunkBytes));
  return database;
}

std::string words(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : text;
}

class Db3Bag : public BagFile {
 public:
  explicit Db3Bag(const std::string& path) : path_(path), database_(opened(path)) {
    const Statement topics =
        prepared("SELECT id, name, type, serialization_format FROM topics LIMIT 10000");
    while (step(topics)) {
      const std::string format = words(topics.get(), 3);
      if (format != "cdr" && !format.empty()) continue;  // some recorders leave it empty
      topics_[static_cast<std::uint32_t>(sqlite3_column_int64(topics.get(), 0))] = {
          words(topics.get(), 1), words(topics.get(), 2)};
    }
    const Statement last = prepared("SELECT MAX(id) FROM messages");
    if (step(last)) last_id_ = sqlite3_column_int64(last.get(), 0);
    messages_ =
        prepared("SELECT timestamp, id, topic_id, data FROM messages ORDER BY timestamp, id");
  }

  std::optional<Message> next() override {
    while (step(messages_)) {
      sqlite3_stmt* const row = messages_.get();
      time_ns_ = sqlite3_column_int64(row, 0);
      id_ = sqlite3_column_int64(row, 1);
      const sqlite3_int64 topic = sqlite3_column_int64(row, 2);
      if (!topics_.contains(static_cast<std::uint32_t>(topic))) continue;
      Message message;
      message.time_ns = time_ns_;
      message.stream = static_cast<std::uint32_t>(topic);
      const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(row, 3));
      const int count = sqlite3_column_bytes(row, 3);
      if (bytes != nullptr) message.bytes = {bytes, static_cast<std::size_t>(count)};
      return message;
    }
    return std::nullopt;
  }

  /// Goes on behind the message that was read last.
  void keep_only(const std::string& topic) override {
    messages_ = prepared(
        "SELECT timestamp, id, topic_id, data FROM messages WHERE (timestamp, id) > (?1, ?2) AND "
        "topic_id IN (SELECT id FROM topics WHERE name = ?3) ORDER BY timestamp, id");
    sqlite3_bind_int64(messages_.get(), 1, time_ns_);
    sqlite3_bind_int64(messages_.get(), 2, id_);
    sqlite3_bind_text(messages_.get(), 3, topic.data(), static_cast<int>(topic.size()),
                      SQLITE_TRANSIENT);
  }

  double read_share() const override {
    return last_id_ > 0
               ? std::clamp(static_cast<double>(id_) / static_cast<double>(last_id_), 0.0, 1.0)
               : 1.0;
  }

 private:
  Statement prepared(const char* sql) const {
    sqlite3_stmt* raw = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql, -1, &raw, nullptr) != SQLITE_OK) {
      fail(path_, database_.get());
    }
    return Statement(raw);
  }

  /// Whether there is one more row.
  bool step(const Statement& statement) const {
    const int status = sqlite3_step(statement.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail(path_, database_.get());
    return status == SQLITE_ROW;
  }

  std::string path_;
  Database database_;
  Statement messages_;
  std::int64_t time_ns_ = std::numeric_limits<std::int64_t>::min();  ///< of the last message
  std::int64_t id_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t last_id_ = 0;
};

}  // namespace

std::unique_ptr<BagFile> open_db3(const std::string& path) {
  return std::make_unique<Db3Bag>(path);
}

}  // namespace hqslam::recordings
