#include "db/sqlite.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstring>

namespace wayfuse {
namespace {

constexpr int kBusyTimeoutMs = 5000;

// What an extended result code and the errno behind it mean to the caller.
FaultCode code_of(int extended, int system_errno) {
  if (system_errno == ENOSPC || system_errno == EDQUOT || system_errno == EROFS || system_errno == EFBIG) {
    return FaultCode::kStorageFull;
  }
  switch (extended & 0xff) {
    case SQLITE_FULL:
    case SQLITE_READONLY: return FaultCode::kStorageFull;
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return FaultCode::kStoreBusy;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: return FaultCode::kStoreCorrupt;
    case SQLITE_CONSTRAINT:
    case SQLITE_TOOBIG: return FaultCode::kOutOfRange;
    default: return FaultCode::kStorageFailed;
  }
}

// Asked of the VFS itself where a file is open: sqlite3_system_errno() is not set when a COMMIT fails.
int system_errno_of(sqlite3* connection, int extended) {
  const int primary = extended & 0xff;
  if (connection == nullptr || (primary != SQLITE_IOERR && primary != SQLITE_CANTOPEN)) return 0;
  sqlite3_vfs* vfs = nullptr;
  const bool opened = sqlite3_file_control(connection, "main", SQLITE_FCNTL_VFS_POINTER, &vfs) == SQLITE_OK && vfs != nullptr;
  return opened && vfs->xGetLastError != nullptr ? vfs->xGetLastError(vfs, 0, nullptr) : sqlite3_system_errno(connection);
}

[[noreturn]] void fail(sqlite3* connection, int code, std::string_view file) {
  const int extended = connection != nullptr ? sqlite3_extended_errcode(connection) : code;
  std::string cause = connection != nullptr ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
  const int system_errno = system_errno_of(connection, extended);
  cause += " (SQLite " + std::to_string(extended);
  if (system_errno != 0) cause += std::string(", ") + std::strerror(system_errno);
  cause += ")";
  throw StoreError(Fault{code_of(extended, system_errno), std::string(file), std::move(cause)});
}

}  // namespace

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), statement_(other.statement_), file_(other.file_) {
  other.statement_ = nullptr;
}

Statement::~Statement() {
  if (statement_ == nullptr) return;
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

Statement& Statement::bind(int position, std::int64_t value) {
  const int code = sqlite3_bind_int64(statement_, position, value);
  if (code != SQLITE_OK) fail(connection_, code, file_);
  return *this;
}

Statement& Statement::bind(int position, double value) {
  const int code = sqlite3_bind_double(statement_, position, value);
  if (code != SQLITE_OK) fail(connection_, code, file_);
  return *this;
}

Statement& Statement::bind_text(int position, std::string_view value) {
  const char* data = value.data() != nullptr ? value.data() : "";
  const int code = sqlite3_bind_text64(statement_, position, data, value.size(), SQLITE_STATIC, SQLITE_UTF8);
  if (code != SQLITE_OK) fail(connection_, code, file_);
  return *this;
}

Statement& Statement::bind_blob(int position, std::string_view value) {
  const char* data = value.data() != nullptr ? value.data() : "";
  const int code = sqlite3_bind_blob64(statement_, position, data, value.size(), SQLITE_STATIC);
  if (code != SQLITE_OK) fail(connection_, code, file_);
  return *this;
}

Statement& Statement::bind_null(int position) {
  const int code = sqlite3_bind_null(statement_, position);
  if (code != SQLITE_OK) fail(connection_, code, file_);
  return *this;
}

bool Statement::step() {
  errno = 0;  // so that what fail() finds there is of this call
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) fail(connection_, code, file_);
  return false;
}

std::int64_t Statement::run() {
  while (step()) {
  }
  const std::int64_t changed = sqlite3_changes64(connection_);
  sqlite3_reset(statement_);
  return changed;
}

bool Statement::is_null(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }
double Statement::real(int column) const { return sqlite3_column_double(statement_, column); }

std::string_view Statement::text(int column) const {
  const auto* data = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return {data != nullptr ? data : "", static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

std::string_view Statement::blob(int column) const {
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_, column));
  return {data != nullptr ? data : "", static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
}

SqliteConnection::SqliteConnection(const std::filesystem::path& file, const std::string& vfs, Mode mode)
    : name_(file.filename().string()) {
  const int access = mode == Mode::kReadOnly ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
  const int flags = access | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE | (mode == Mode::kCreate ? SQLITE_OPEN_CREATE : 0);
  const int code = sqlite3_open_v2(file.c_str(), &connection_, flags, vfs.empty() ? nullptr : vfs.c_str());
  if (code != SQLITE_OK) {
    try {
      fail(connection_, code, name_);
    } catch (...) {
      sqlite3_close_v2(connection_);
      throw;
    }
  }
  sqlite3_busy_timeout(connection_, kBusyTimeoutMs);
  sqlite3_db_config(connection_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(connection_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
}

SqliteConnection::~SqliteConnection() {
  statements_.clear();
  sqlite3_close_v2(connection_);
}

void SqliteConnection::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

void SqliteConnection::execute(const std::string& sql) {
  errno = 0;
  const int code = sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(connection_, code, name_);
}

Statement SqliteConnection::prepare(std::string_view sql) {
  auto found = statements_.find(sql);
  if (found == statements_.end()) {
    sqlite3_stmt* statement = nullptr;
    const int code = sqlite3_prepare_v3(connection_, sql.data(), static_cast<int>(sql.size()), SQLITE_PREPARE_PERSISTENT,
                                        &statement, nullptr);
    if (code != SQLITE_OK) fail(connection_, code, name_);
    found = statements_.emplace(std::string(sql), statement).first;
  }
  assert(sqlite3_stmt_busy(found->second.get()) == 0);
  return Statement(connection_, found->second.get(), name_);
}

std::int64_t SqliteConnection::integer(std::string_view sql) {
  Statement statement = prepare(sql);
  return statement.step() ? statement.integer(0) : 0;
}

std::string SqliteConnection::text(std::string_view sql) {
  Statement statement = prepare(sql);
  return statement.step() ? std::string(statement.text(0)) : std::string();
}

std::int64_t SqliteConnection::last_insert_id() const { return sqlite3_last_insert_rowid(connection_); }
bool SqliteConnection::in_transaction() const { return sqlite3_get_autocommit(connection_) == 0; }

void SqliteConnection::keep_log_on_close() { sqlite3_db_config(connection_, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr); }

void SqliteConnection::back_up_to(const std::filesystem::path& file, const std::string& vfs) {
  SqliteConnection copy(file, vfs, Mode::kCreate);
  sqlite3_backup* backup = sqlite3_backup_init(copy.connection_, "main", connection_, "main");
  if (backup == nullptr) fail(copy.connection_, SQLITE_ERROR, copy.name_);
  sqlite3_backup_step(backup, -1);
  const int code = sqlite3_backup_finish(backup);
  if (code != SQLITE_OK) fail(copy.connection_, code, copy.name_);
}

namespace {

constexpr sqlite3_int64 kPieceBytes = 64 * 1024;  // SQLite's unix VFS takes less than 128 KiB in one write

struct CloseFile {
  void operator()(sqlite3_file* file) const {
    if (file->pMethods != nullptr) file->pMethods->xClose(file);
    delete[] reinterpret_cast<char*>(file);
  }
};

}  // namespace

void make_log_durable(const std::filesystem::path& database, const std::string& vfs_name) {
  sqlite3_vfs* vfs = sqlite3_vfs_find(vfs_name.empty() ? nullptr : vfs_name.c_str());
  const std::string log = database.string() + "-wal";
  const auto check = [&](int code) {
    if (code != SQLITE_OK) {
      const int system_errno = vfs->xGetLastError != nullptr ? vfs->xGetLastError(vfs, 0, nullptr) : 0;
      throw StoreError({code_of(code, system_errno), database.filename().string() + "-wal", sqlite3_errstr(code)});
    }
  };
  int there = 0;
  check(vfs->xAccess(vfs, log.c_str(), SQLITE_ACCESS_EXISTS, &there));
  if (there == 0) return;
  std::unique_ptr<sqlite3_file, CloseFile> file(reinterpret_cast<sqlite3_file*>(new char[static_cast<std::size_t>(vfs->szOsFile)]()));
  // SQLite hands file names over with a list of URI parameters behind them: here it is empty.
  const std::string name = log + std::string(4, '\0');
  check(vfs->xOpen(vfs, name.c_str(), file.get(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_WAL, nullptr));
  sqlite3_int64 size = 0;
  check(file->pMethods->xFileSize(file.get(), &size));
  std::string piece;
  for (sqlite3_int64 at = 0; at < size; at += static_cast<sqlite3_int64>(piece.size())) {
    piece.resize(static_cast<std::size_t>(std::min<sqlite3_int64>(size - at, kPieceBytes)));
    check(file->pMethods->xRead(file.get(), piece.data(), static_cast<int>(piece.size()), at));
    check(file->pMethods->xWrite(file.get(), piece.data(), static_cast<int>(piece.size()), at));
  }
  check(file->pMethods->xSync(file.get(), SQLITE_SYNC_NORMAL));
}

Transaction::Transaction(SqliteConnection& connection) : connection_(connection) { connection_.execute("BEGIN IMMEDIATE"); }

Transaction::~Transaction() {
  if (!connection_.in_transaction()) return;  // committed, or SQLite rolled back by itself when the disk failed
  try {
    connection_.execute("ROLLBACK");
  } catch (const StoreError&) {
    // The fault that led here is already on its way; the owner drops a connection after any fault.
  }
}

void Transaction::commit() { connection_.execute("COMMIT"); }

Savepoint::Savepoint(SqliteConnection& connection) : connection_(connection) { connection_.execute("SAVEPOINT one"); }

void Savepoint::undo() {
  connection_.execute("ROLLBACK TO one");
  connection_.execute("RELEASE one");
}

void Savepoint::release() { connection_.execute("RELEASE one"); }

}  // namespace wayfuse
