#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "bags/bag.h"
#include "hqslam/core/error.h"
#include "hqslam/core/excerpt.h"

namespace hqslam::recordings {

namespace {

using Database = std::unique_ptr<sqlite3, decltype([](sqlite3* raw) { sqlite3_close_v2(raw); })>;
using Statement =
    std::unique_ptr<sqlite3_stmt, decltype([](sqlite3_stmt* raw) { sqlite3_finalize(raw); })>;

[[noreturn]] void fail(const std::string& path, sqlite3* database) {
  throw Error("{}: expected a ROS 2 bag (sqlite), found '{}'; give a whole .db3 file", path,
              excerpt(sqlite3_errmsg(database), kNameCharacters));
}

/// The name by which SQLite reads a bag without writing: one in write-ahead mode (rosbag2's preset
/// "resilient") would get two files beside it, and could not be read in a folder that may not be
/// written. A log beside it has what the bag does not have yet: SQLite reads it, too.
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
  // What putting messages in order has read of the file is there when their bytes are.
  sqlite3_exec(raw, "PRAGMA cache_size = -65536", nullptr, nullptr, nullptr);
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
      add_topic(static_cast<std::uint32_t>(sqlite3_column_int64(topics.get(), 0)),
                {words(topics.get(), 1), words(topics.get(), 2)});
    }
    const Statement last = prepared("SELECT MAX(id) FROM messages");
    if (step(last)) last_id_ = sqlite3_column_int64(last.get(), 0);
    // Messages are put in order without their bytes, which are fetched one by one: a bag may have
    // no index, and what is sorted is written to a file and read again.
    order_ = prepared("SELECT id, timestamp, topic_id FROM messages ORDER BY timestamp, id");
    bytes_ = prepared("SELECT data FROM messages WHERE id = ?1");
  }

  std::optional<Message> next() override {
    while (order_ && step(order_)) {
      id_ = sqlite3_column_int64(order_.get(), 0);
      const auto topic = static_cast<std::uint32_t>(sqlite3_column_int64(order_.get(), 2));
      const auto found = topics_.find(topic);
      if (found == topics_.end() || !is_kept(found->second.name)) continue;
      Message message;
      message.time_ns = sqlite3_column_int64(order_.get(), 1);
      message.stream = topic;
      message.bytes = bytes_of(id_);
      return message;
    }
    order_.reset();  // one more step would begin anew
    return std::nullopt;
  }

  void keep_only(const std::vector<std::string>& topics) override { kept_ = topics; }

  double read_share() const override {
    return last_id_ > 0
               ? std::clamp(static_cast<double>(id_) / static_cast<double>(last_id_), 0.0, 1.0)
               : 1.0;
  }

 private:
  bool is_kept(const std::string& topic) const {
    return kept_.empty() || std::ranges::find(kept_, topic) != kept_.end();
  }

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

  Bytes bytes_of(std::int64_t id) {
    sqlite3_reset(bytes_.get());
    sqlite3_bind_int64(bytes_.get(), 1, id);
    if (!step(bytes_)) return {};
    const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(bytes_.get(), 0));
    const int count = sqlite3_column_bytes(bytes_.get(), 0);
    return bytes == nullptr ? Bytes{} : Bytes{bytes, static_cast<std::size_t>(count)};
  }

  std::string path_;
  Database database_;
  Statement order_;                ///< of the messages
  Statement bytes_;                ///< of one of them
  std::vector<std::string> kept_;  ///< topics; none: all
  std::int64_t id_ = 0;            ///< of the message that was read last
  std::int64_t last_id_ = 0;
};

}  // namespace

std::unique_ptr<BagFile> open_db3(const std::string& path) {
  return std::make_unique<Db3Bag>(path);
}

}  // namespace hqslam::recordings
