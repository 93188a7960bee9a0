#include "pipeline/database.h"

#include <sqlite3.h>

#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/store_error.h"

namespace morphodesic::pipeline {
namespace {

/// SQLite's result code in the words of a user, with what to do.
[[noreturn]] void fail(const std::filesystem::path& file, sqlite3* connection, int code) {
    const std::string said = connection ? sqlite3_errmsg(connection) : sqlite3_errstr(code);
    switch (code & 0xff) {
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            throw StoreError(file, "another program holds the study's store locked (" + said +
                                       "); wait until it is done, then give the same command again");
        case SQLITE_FULL:
            throw StoreError(file, "the disk is full (" + said +
                                       "); nothing that was finished is lost: free some space, then give the same "
                                       "command again");
        case SQLITE_IOERR:
            throw StoreError(file, "reading or writing failed (" + said +
                                       "); check the disk, its quota and its free space, then give the same command "
                                       "again: nothing that was finished is lost");
        case SQLITE_READONLY:
        case SQLITE_PERM:
        case SQLITE_AUTH:
            throw StoreError(file, "may not be written (" + said +
                                       "); check the permissions of the file and of its folder, or use another "
                                       "study folder");
        case SQLITE_CANTOPEN:
            throw StoreError(file, "cannot be opened (" + said +
                                       "); check that the folder exists and may be written, or use another study "
                                       "folder");
        case SQLITE_CORRUPT:
        case SQLITE_NOTADB:
            throw StoreError(file, "is damaged or not a study's store (" + said +
                                       "); move it away and run the study again, or restore a copy. What can still be "
                                       "read is shown by: sqlite3 FILE .dump");
        default:
            throw StoreError(file, "SQLite says: " + said);
    }
}

}  // namespace

Statement::Statement(sqlite3* connection, std::filesystem::path file, std::string_view sql)
    : connection_(connection), file_(std::move(file)) {
    const int code = sqlite3_prepare_v2(connection, sql.data(), static_cast<int>(sql.size()), &statement_, nullptr);
    if (code != SQLITE_OK) fail(file_, connection_, code);
}

Statement::~Statement() {
    sqlite3_finalize(statement_);
}

Statement::Statement(Statement&& other) noexcept
    : connection_(other.connection_), statement_(std::exchange(other.statement_, nullptr)), file_(other.file_) {}

Statement& Statement::bind(int parameter, std::string_view text) {
    const int code = sqlite3_bind_text64(statement_, parameter, text.data() ? text.data() : "", text.size(),
                                         SQLITE_TRANSIENT, SQLITE_UTF8);
    if (code != SQLITE_OK) fail(file_, connection_, code);
    return *this;
}

Statement& Statement::bind(int parameter, double value) {
    const int code = std::isnan(value) ? sqlite3_bind_null(statement_, parameter)
                                       : sqlite3_bind_double(statement_, parameter, value);
    if (code != SQLITE_OK) fail(file_, connection_, code);
    return *this;
}

Statement& Statement::bind(int parameter, long long value) {
    const int code = sqlite3_bind_int64(statement_, parameter, value);
    if (code != SQLITE_OK) fail(file_, connection_, code);
    return *this;
}

Statement& Statement::bind_blob(int parameter, std::string_view bytes) {
    const int code =
        sqlite3_bind_blob64(statement_, parameter, bytes.data() ? bytes.data() : "", bytes.size(), SQLITE_TRANSIENT);
    if (code != SQLITE_OK) fail(file_, connection_, code);
    return *this;
}

bool Statement::step() {
    const int code = sqlite3_step(statement_);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) fail(file_, connection_, code);
    return false;
}

void Statement::run() {
    while (step()) {
    }
    reset();
}

void Statement::reset() {
    sqlite3_reset(statement_);
    sqlite3_clear_bindings(statement_);
}

std::string Statement::text(int column) const {
    const auto* bytes = sqlite3_column_text(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes ? std::string(reinterpret_cast<const char*>(bytes), size) : std::string();
}

double Statement::number(int column) const {
    return is_null(column) ? std::numeric_limits<double>::quiet_NaN() : sqlite3_column_double(statement_, column);
}

long long Statement::integer(int column) const {
    return sqlite3_column_int64(statement_, column);
}

std::string Statement::blob(int column) const {
    const void* bytes = sqlite3_column_blob(statement_, column);
    const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
    return bytes ? std::string(static_cast<const char*>(bytes), size) : std::string();
}

bool Statement::is_null(int column) const {
    return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

Database::Database(std::filesystem::path file, bool writable) : file_(std::move(file)) {
    const int flags =
        SQLITE_OPEN_FULLMUTEX | (writable ? SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE : SQLITE_OPEN_READONLY);
    const int code = sqlite3_open_v2(file_.c_str(), &connection_, flags, nullptr);
    if (code != SQLITE_OK) {
        const std::unique_ptr<sqlite3, decltype(&sqlite3_close_v2)> closer(connection_, &sqlite3_close_v2);
        fail(file_, connection_, code);
    }
    sqlite3_extended_result_codes(connection_, 1);
    sqlite3_busy_timeout(connection_, 5000);
}

Database::~Database() {
    sqlite3_close_v2(connection_);
}

Statement Database::prepare(std::string_view sql) const {
    return Statement(connection_, file_, sql);
}

void Database::execute(const std::string& sql) const {
    const int code = sqlite3_exec(connection_, sql.c_str(), nullptr, nullptr, nullptr);
    if (code != SQLITE_OK) fail(file_, connection_, code);
}

Transaction::~Transaction() {
    if (!open_) return;
    try {
        database_.execute("ROLLBACK");
    } catch (const StoreError&) {
        // The transaction ended by itself (disk full); what failed has been reported already.
    }
}

}  // namespace morphodesic::pipeline
