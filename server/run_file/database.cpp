#include "server/run_file/database.h"

#include <sqlite3.h>

#include <cstring>
#include <utility>

namespace evod::run_file {

namespace {

/// A path as an SQLite URI with options.
std::string uri_of(const std::string& path, const char* options) {
    std::string uri = "file:";
    for (const char c : path) {
        if (c == '%' || c == '?' || c == '#') {
            uri += c == '%' ? "%25" : c == '?' ? "%3f" : "%23";
        } else {
            uri += c;
        }
    }
    return uri + options;
}

} // namespace

void Database::Close::operator()(sqlite3* handle) const {
    sqlite3_close_v2(handle);
}

Database::Database(const std::string& path, Mode mode, const char* vfs) {
    int flags = SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
    const bool reads = mode == Mode::Read || mode == Mode::ReadAtRest;
    flags |= reads ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE;
    flags |= mode == Mode::Create ? SQLITE_OPEN_CREATE : 0;
    flags |= mode == Mode::ReadAtRest ? SQLITE_OPEN_URI : 0;
    const std::string name = mode == Mode::ReadAtRest ? uri_of(path, "?immutable=1") : path;
    sqlite3* handle = nullptr;
    const int code = sqlite3_open_v2(name.c_str(), &handle, flags, vfs);
    handle_.reset(handle);
    check(code);
    if (failed()) {
        return;
    }
    // SQLite waits up to 2 s for a lock, because another program that reads the file may hold one for a short time.
    sqlite3_busy_timeout(handle, 2000);
    // SQLite must report damage instead of working around it. Nothing in a file may run code.
    sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    run("PRAGMA cell_size_check = ON");
    if (reads) {
        return;
    }
    if (sqlite3_db_readonly(handle, "main") == 1) { // SQLite then opens the file for reading
        error_ = "no permission to write the file";
        return;
    }
    // Replaces SQLite's own hook, which would copy a long log into the file during a commit.
    sqlite3_wal_hook(
        handle,
        [](void* self, sqlite3*, const char*, int pages) {
            static_cast<Database*>(self)->log_pages_ = static_cast<std::uint32_t>(pages);
            return SQLITE_OK;
        },
        this);
}

void Database::check(int code) {
    if (failed() || code == SQLITE_OK || code == SQLITE_ROW || code == SQLITE_DONE) {
        return;
    }
    error_ = handle_ ? sqlite3_errmsg(handle_.get()) : sqlite3_errstr(code);
    if (const int system = handle_ ? sqlite3_system_errno(handle_.get()) : 0;
        (code & 0xff) == SQLITE_CANTOPEN && system != 0) {
        error_ += std::string{": "} + std::strerror(system); // for example too many open files
    }
    damaged_ = (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB;
}

void Database::run(const char* sql) {
    if (!failed()) {
        check(sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr));
    }
}

std::int64_t Database::number(const char* sql) {
    Statement statement{*this, sql};
    return statement.row() ? statement.integer(0) : 0;
}

void Database::copy_log() {
    if (!failed()) {
        sqlite3_wal_checkpoint_v2(handle_.get(), nullptr, SQLITE_CHECKPOINT_PASSIVE, nullptr, nullptr);
    }
}

void Database::stop_when(base::StopCheck stop) {
    constexpr int instructions = 10'000; // of SQLite's virtual machine, between two questions
    stop_ = std::move(stop);
    if (!failed()) {
        sqlite3_progress_handler(
            handle_.get(), instructions, [](void* self) { return int{static_cast<Database*>(self)->stop_()}; }, this);
    }
}

void Database::copy_to(const std::string& path, const base::StopCheck& stop) {
    if (failed()) {
        return;
    }
    Database copy{path, Mode::Create};
    if (!copy.failed()) {
        sqlite3_backup* backup = sqlite3_backup_init(copy.handle_.get(), "main", handle_.get(), "main");
        constexpr int pages_at_once = 1000;
        int code = backup == nullptr ? SQLITE_ERROR : SQLITE_OK;
        while (code == SQLITE_OK && !stop()) {
            code = sqlite3_backup_step(backup, pages_at_once);
        }
        copy.check(backup == nullptr ? sqlite3_errcode(copy.handle_.get()) : sqlite3_backup_finish(backup));
    }
    if (copy.failed()) {
        error_ = path + ": " + copy.error();
    }
}

void Statement::Finalize::operator()(sqlite3_stmt* handle) const {
    sqlite3_finalize(handle);
}

Statement::Statement(Database& database, const std::string& sql) : database_{database} {
    if (database.failed()) {
        return;
    }
    sqlite3_stmt* handle = nullptr;
    const int code = sqlite3_prepare_v3(database.handle_.get(), sql.c_str(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &handle, nullptr);
    handle_.reset(handle);
    database.check(code);
}

void Statement::bind(int parameter, std::int64_t value) {
    if (!database_.failed()) {
        database_.check(sqlite3_bind_int64(handle_.get(), parameter + 1, value));
    }
}

void Statement::bind(int parameter, double value) {
    if (!database_.failed()) {
        database_.check(sqlite3_bind_double(handle_.get(), parameter + 1, value));
    }
}

void Statement::bind(int parameter, std::string_view text) {
    if (!database_.failed()) {
        database_.check(sqlite3_bind_text64(handle_.get(), parameter + 1, text.empty() ? "" : text.data(), text.size(),
                                            SQLITE_TRANSIENT, SQLITE_UTF8));
    }
}

void Statement::bind(int parameter, std::span<const std::byte> bytes) {
    if (!database_.failed()) {
        database_.check(sqlite3_bind_blob64(handle_.get(), parameter + 1,
                                            bytes.empty() ? "" : static_cast<const void*>(bytes.data()), bytes.size(),
                                            SQLITE_STATIC)); // nullptr would bind NULL
    }
}

void Statement::bind_null(int parameter) {
    if (!database_.failed()) {
        database_.check(sqlite3_bind_null(handle_.get(), parameter + 1));
    }
}

bool Statement::row() {
    if (database_.failed()) {
        return false;
    }
    const int code = sqlite3_step(handle_.get());
    if (code == SQLITE_ROW) {
        return true;
    }
    database_.check(code);
    sqlite3_reset(handle_.get());
    return false;
}

void Statement::done() {
    row();
}

std::int64_t Statement::integer(int column) const {
    return sqlite3_column_int64(handle_.get(), column);
}

double Statement::real(int column) const {
    return sqlite3_column_double(handle_.get(), column);
}

std::string Statement::text(int column) const {
    return bytes(column);
}

std::string Statement::bytes(int column) const {
    const auto* data = static_cast<const char*>(sqlite3_column_blob(handle_.get(), column));
    return {data, data == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(handle_.get(), column))};
}

bool Statement::is_null(int column) const {
    return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL;
}

} // namespace evod::run_file
