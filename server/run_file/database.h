// Database: the part of SQLite's interface that run files need.
//
// Errors       the object keeps the first error and skips every later call. So a caller can read or write everything
//              and call failed() once, at the end.
// Owner        one thread at a time.
#pragma once

#include "server/base/stop_check.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace evod::run_file {

class Database {
  public:
    enum class Mode {
        Create, // creates a new file; fails if the file exists
        Write,
        Read,
        ReadAtRest, // opens a file that no program writes to; needs no lock and no write access to the folder
    };
    /// vfs  name of an SQLite VFS (SQLite's interface to the operating system); nullptr: the default VFS.
    Database(const std::string& path, Mode mode, const char* vfs = nullptr);
    Database(const Database&) = delete; // SQLite stores the address of this object
    Database& operator=(const Database&) = delete;

    bool failed() const { return !error_.empty(); }
    /// The first error as one sentence; empty if there is none.
    const std::string& error() const { return error_; }
    /// Whether the error means that the file is not a database or is damaged.
    bool damaged() const { return damaged_; }

    /// Runs SQL statements that have no parameters and return no rows.
    void run(const char* sql);
    /// The integer that a query returns; 0 if it returns no row.
    std::int64_t number(const char* sql);
    /// Number of pages in the write-ahead log after the last commit of this object. SQLite does not copy them into the
    /// file on its own.
    std::uint32_t log_pages() const { return log_pages_; }
    /// Copies pages of the write-ahead log into the file, except pages that a reader of an older snapshot blocks. At
    /// most one thread at a time may call this for one file.
    void copy_log();
    /// Copies this database to a new or empty file. Within a read transaction, copies the snapshot of that transaction.
    ///
    /// stop  stops the work, which then fails.
    void copy_to(const std::string& path, const base::StopCheck& stop = {});
    /// From now on, statements fail if `stop` says so.
    void stop_when(base::StopCheck stop);

  private:
    friend class Statement;
    void check(int code);

    struct Close {
        void operator()(sqlite3* handle) const;
    };
    std::unique_ptr<sqlite3, Close> handle_;
    std::string error_;
    bool damaged_ = false;
    std::uint32_t log_pages_ = 0;
    base::StopCheck stop_;
};

/// A prepared statement. The database must outlive it.
class Statement {
  public:
    Statement(Database& database, const std::string& sql);

    // Parameters and columns are numbered from 0.
    void bind(int parameter, std::int64_t value);
    void bind(int parameter, double value);
    void bind(int parameter, std::string_view text);
    /// Does not copy the bytes, because chromosomes can be large: they must stay valid until row() or done().
    void bind(int parameter, std::span<const std::byte> bytes);
    void bind_null(int parameter);

    /// Moves to the next row. Returns false if there is none, or after an error. The next call then starts the
    /// statement again.
    bool row();
    /// Runs a statement that returns no rows.
    void done();

    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string text(int column) const;
    std::string bytes(int column) const;
    bool is_null(int column) const;

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* handle) const;
    };
    Database& database_;
    std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

} // namespace evod::run_file
