#include <fmt/format.h>
#include <sqlite3.h>

#include <filesystem>
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

Statement prepared(sqlite3* database, const std::string& path, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql, -1, &raw, nullptr) != SQLITE_OK) fail(path, database);
  return Statement(raw);
}

std::string words(sqlite3_stmt* statement, int column) {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  return text == nullptr ? "" : text;
}

class Db3Messages : public MessageSource {
 public:
  Db3Messages(const std::string& path, const std::string& topic)
      : path_(path), database_(opened(path)) {
    statement_ = prepared(database_.get(), path_,
                          "SELECT messages.timestamp, messages.data FROM messages "
                          "JOIN topics ON topics.id = messages.topic_id WHERE topics.name = ?1 "
                          "ORDER BY messages.timestamp, messages.id");
    sqlite3_bind_text(statement_.get(), 1, topic.data(), static_cast<int>(topic.size()),
                      SQLITE_TRANSIENT);
  }

  std::optional<Message> next() override {
    const int status = sqlite3_step(statement_.get());
    if (status == SQLITE_DONE) return std::nullopt;
    if (status != SQLITE_ROW) fail(path_, database_.get());
    Message message;
    message.time_ns = sqlite3_column_int64(statement_.get(), 0);
    const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_.get(), 1));
    const int count = sqlite3_column_bytes(statement_.get(), 1);
    if (bytes != nullptr) message.bytes = {bytes, static_cast<std::size_t>(count)};
    return message;
  }

 private:
  std::string path_;
  Database database_;
  Statement statement_;
};

class Db3Bag : public Bag {
 public:
  explicit Db3Bag(const std::string& path) : path_(path) {
    const Database database = opened(path);
    const Statement statement = prepared(
        database.get(), path,
        "SELECT topics.name, topics.type, COUNT(messages.id), topics.serialization_format FROM "
        "topics LEFT JOIN messages ON messages.topic_id = topics.id GROUP BY topics.id "
        "ORDER BY topics.name LIMIT 10000");
    int status = sqlite3_step(statement.get());
    for (; status == SQLITE_ROW; status = sqlite3_step(statement.get())) {
      if (words(statement.get(), 3) != "cdr") continue;
      topics_.push_back({words(statement.get(), 0), words(statement.get(), 1),
                         sqlite3_column_int64(statement.get(), 2)});
    }
    if (status != SQLITE_DONE) fail(path, database.get());
  }

  std::string kind() const override { return "ROS 2 bag (sqlite)"; }
  const std::vector<Topic>& topics() const override { return topics_; }
  std::unique_ptr<MessageSource> messages(const std::string& topic) const override {
    return std::make_unique<Db3Messages>(path_, topic);
  }

 private:
  std::string path_;
  std::vector<Topic> topics_;
};

}  // namespace

std::unique_ptr<Bag> open_db3(const std::string& path) { return std::make_unique<Db3Bag>(path); }

}  // namespace hqslam::recordings
