#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "wayfuse/proto/fault.hpp"
#include "wayfuse/proto/result.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace wayfuse {

/// The world broke under the store. Thrown inside this room only: its public calls hand it on as a fault.
class StoreError : public std::exception {
 public:
  explicit StoreError(Fault fault) : fault_(std::move(fault)), text_(to_string(fault_)) {}
  const Fault& fault() const { return fault_; }
  const char* what() const noexcept override { return text_.c_str(); }

 private:
  Fault fault_;
  std::string text_;
};

/// A prepared statement borrowed from its connection; reset when it goes out of scope. Positions count from 1, columns from 0.
class Statement {
 public:
  Statement(sqlite3* connection, sqlite3_stmt* statement, std::string_view file) : connection_(connection), statement_(statement), file_(file) {}
  Statement(Statement&& other) noexcept;
  Statement& operator=(Statement&&) = delete;
  ~Statement();

  Statement& bind(int position, std::int64_t value);
  Statement& bind(int position, double value);
  /// Text and blobs are borrowed: they must outlive the next step.
  Statement& bind_text(int position, std::string_view value);
  Statement& bind_blob(int position, std::string_view value);
  Statement& bind_null(int position);

  /// True while there is a row.
  bool step();
  /// Steps to the end and resets, for statements without rows; answers how many rows changed.
  std::int64_t run();

  bool is_null(int column) const;
  std::int64_t integer(int column) const;
  double real(int column) const;
  /// Valid until the next step.
  std::string_view text(int column) const;
  std::string_view blob(int column) const;

 private:
  sqlite3* connection_;
  sqlite3_stmt* statement_;
  std::string_view file_;
};

/// One SQLite connection; everything throws StoreError. The only place that sees sqlite3.h. Thread: confined.
class SqliteConnection {
 public:
  enum class Mode { kReadOnly, kReadWrite, kCreate };
  /// Through the named VFS; empty = the default one. Only kCreate makes a file that is not there.
  SqliteConnection(const std::filesystem::path& file, const std::string& vfs, Mode mode);
  ~SqliteConnection();
  SqliteConnection(const SqliteConnection&) = delete;
  SqliteConnection& operator=(const SqliteConnection&) = delete;

  /// Runs statements without rows.
  void execute(const std::string& sql);
  /// Prepared once a text, then reused. One user of the same text at a time.
  Statement prepare(std::string_view sql);
  /// The first column of the first row; for pragmas.
  std::int64_t integer(std::string_view sql);
  std::string text(std::string_view sql);

  std::int64_t last_insert_id() const;
  bool in_transaction() const;
  /// Copies the whole database, consistently, into a new file.
  void back_up_to(const std::filesystem::path& file, const std::string& vfs);
  /// Leaves the write-ahead log as it is when closing: evidence for a quarantine.
  void keep_log_on_close();

  const std::string& name() const { return name_; }

 private:
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* connection_ = nullptr;
  std::string name_;  ///< file name without its folder, for faults
  std::map<std::string, std::unique_ptr<sqlite3_stmt, Finalize>, std::less<>> statements_;
};

/// Writes a database's log anew in place and syncs it; call before opening. After a failed fsync the kernel may count pages as
/// clean that never reached the disk: SQLite's recovery would believe a commit that a power cut still takes away, and a retry
/// would be acknowledged on the strength of it. Throws StoreError. No connection may be open.
void make_log_durable(const std::filesystem::path& database, const std::string& vfs);

/// BEGIN IMMEDIATE until commit(); rolls back when it was not reached.
class Transaction {
 public:
  explicit Transaction(SqliteConnection& connection);
  ~Transaction();
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  /// Durable when it returns (under synchronous=FULL).
  void commit();

 private:
  SqliteConnection& connection_;
};

/// A nested transaction, ended by release() or undo(); without either the enclosing transaction must be given up.
class Savepoint {
 public:
  explicit Savepoint(SqliteConnection& connection);
  Savepoint(const Savepoint&) = delete;
  Savepoint& operator=(const Savepoint&) = delete;
  void release();
  void undo();

 private:
  SqliteConnection& connection_;
};

/// Runs a room's public call and turns what broke into a fault.
template <typename Call>
auto as_result(Call&& call) -> Result<decltype(call())> {
  try {
    if constexpr (std::is_void_v<decltype(call())>) {
      call();
      return {};
    } else {
      return call();
    }
  } catch (const StoreError& error) {
    return error.fault();
  }
}

}  // namespace wayfuse
