// Database: SQLite, as little of it as run files need.
//
// Errors       the first thing that goes wrong is kept, and everything after it is skipped: whoever has read or written
//              asks failed() once, at the end.
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
        ReadAtRest, // a file to which nobody writes, wherever it lies: no lock is taken
    };
    /// vfs  SQLite's name of the way to the disk; nullptr is the usual one.
    Database(const std::string& path, Mode mode, const char* vfs = nullptr);
    Database(const Database&) = delete; // SQLite knows where it is
    Database& operator=(const Database&) = delete;

    bool failed() const { return !error_.empty(); }
    /// One sentence; empty if nothing has gone wrong.
    const std::string& error() const { return error_; }
    /// Whether what went wrong is that the file is not, or no longer, a sound database.
    bool damaged() const { return damaged_; }

    /// Statements without parameters or rows.
    void run(const char* sql);
    /// The whole number that a query gives; 0 if it gives none.
    std::int64_t number(const char* sql);
    /// How many pages the write-ahead log holds, as of the last commit here. It is not copied into the file by itself.
    std::uint32_t log_pages() const { return log_pages_; }
    /// Copies into the file what the log holds, as far as nobody reads what was before. What cannot be copied stays in
    /// the log. At most one of all who have the file open may be at it.
    void copy_log();
    /// Makes a file with all that is in this database; if it is being read, what was there when that began.
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

/// A prepared statement; lives no longer than its database.
class Statement {
  public:
    Statement(Database& database, const std::string& sql);

    // Parameters and columns count from 0.
    void bind(int parameter, std::int64_t value);
    void bind(int parameter, double value);
    void bind(int parameter, std::string_view text);
    void bind(int parameter, std::span<const std::byte> bytes);
    void bind_nothing(int parameter);

    /// Whether there is a row, or one more. After the last, and after a failure, the statement may be used anew.
    bool row();
    /// For statements without rows.
    void done();

    std::int64_t integer(int column) const;
    double real(int column) const;
    std::string text(int column) const;
    std::string bytes(int column) const;
    bool is_nothing(int column) const;

  private:
    struct Finalize {
        void operator()(sqlite3_stmt* handle) const;
    };
    Database& database_;
    std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

} // namespace evod::run_file
