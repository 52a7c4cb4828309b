// Database: the part of SQLite's interface that run files need.
//
// Errors       the first error is kept, and every later call is skipped. So a caller reads or writes everything and calls
//              failed() once, at the end.
// Owner        one thread at a time.
#pragma once

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
        Create, // a new file; fails if there is one
        Write,
        Read,
        ReadAtRest, // a file to which no program writes: takes no lock and needs no write access to its folder
    };
    /// vfs  the name of an SQLite VFS (its interface to the disk); nullptr is the default one.
    Database(const std::string& path, Mode mode, const char* vfs = nullptr);
    Database(const Database&) = delete; // SQLite keeps its address
    Database& operator=(const Database&) = delete;

    bool failed() const { return !error_.empty(); }
    /// One sentence; empty for none.
    const std::string& error() const { return error_; }
    /// Whether the error is that the file is no database, or a damaged one.
    bool damaged() const { return damaged_; }

    /// Runs statements without parameters or rows.
    void run(const char* sql);
    /// The whole number that a query returns; 0 for none.
    std::int64_t number(const char* sql);
    /// How many pages the write-ahead log has after the last commit here. SQLite does not copy it into the file by itself.
    std::uint32_t log_pages() const { return log_pages_; }
    /// Copies pages of the log into the file, except those that a reader of an older snapshot prevents. At most one
    /// thread at a time may do it for a file.
    void copy_log();
    /// Copies this database to a new file; within a read transaction, its snapshot.
    void copy_to(const std::string& path);

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
};

/// A prepared statement; the database outlives it.
class Statement {
  public:
    Statement(Database& database, const std::string& sql);

    // Parameters and columns count from 0.
    void bind(int parameter, std::int64_t value);
    void bind(int parameter, double value);
    void bind(int parameter, std::string_view text);
    void bind(int parameter, std::span<const std::byte> bytes);
    void bind_null(int parameter);

    /// Steps to the next row. false: there is none, or an error; then the statement may be run again.
    bool row();
    /// Runs a statement without rows.
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
