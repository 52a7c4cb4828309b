// Row: writes and reads single rows of a table with their checksum.
//
// Every row of a run file ends with a column `checksum`: XXH3 (64 bits) of the name of its table and of its other
// columns, in order. A column is hashed as a letter for its type, eight bytes (the number itself, or the length of what
// follows), then the text or bytes; lowest byte first.
#pragma once

#include "server/run_file/database.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

struct XXH3_state_s;

namespace evod::run_file {

class RowChecksum {
  public:
    explicit RowChecksum(std::string_view table);
    ~RowChecksum();
    RowChecksum(const RowChecksum&) = delete;
    RowChecksum& operator=(const RowChecksum&) = delete;

    void begin();
    void add(std::int64_t value);
    void add(double value);
    void add_text(std::string_view text);
    void add_bytes(std::span<const std::byte> bytes);
    void add_null();
    std::int64_t finish();

  private:
    void add_type(char type, std::uint64_t length);
    const std::string table_;
    XXH3_state_s* state_;
};

/// Writes rows of one table; a row with the same key is replaced.
class RowWriter {
  public:
    /// columns  without `checksum`.
    RowWriter(Database& database, const std::string& table, const std::vector<std::string>& columns);

    // The columns of a row in order, then finish().
    RowWriter& integer(std::int64_t value);
    RowWriter& integer(std::optional<std::int64_t> value);
    RowWriter& real(double value);
    RowWriter& real(std::optional<double> value);
    RowWriter& text(std::string_view value);
    RowWriter& bytes(std::span<const std::byte> value);
    /// Adds the checksum of another row to the checksum of this one.
    RowWriter& covers(std::int64_t checksum);
    /// returns  the checksum of the row.
    std::int64_t finish();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

/// Reads rows of one table.
class RowReader {
  public:
    /// condition  in SQL, with "?" for the numbers of `values`; may be followed by ORDER BY and LIMIT.
    RowReader(Database& database, const std::string& table, const std::vector<std::string>& columns,
              const std::string& condition, const std::vector<std::int64_t>& values);

    /// false: there are no more rows, or the database has failed.
    bool next();

    // The columns of a row in order, then sound().
    std::int64_t integer();
    std::optional<std::int64_t> optional_integer();
    double real();
    std::optional<double> optional_real();
    std::string text();
    std::string bytes();
    /// As RowWriter::covers().
    void covers(std::int64_t checksum) { checksum_.add(checksum); }
    /// The stored checksum; after all columns have been read.
    std::int64_t checksum() const { return statement_.integer(column_); }
    /// Whether the stored checksum is that of the columns.
    bool sound();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

} // namespace evod::run_file
