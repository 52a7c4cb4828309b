// Row: writes and reads single rows of a table together with their checksums.
//
// Every row of a run file ends with a column `checksum`: the XXH3 hash (64 bits) of the name of its table and of its
// other columns, in order. Each column is hashed as a letter for its type, then eight bytes, then the contents of a
// text or BLOB. The eight bytes are the number itself or the length of the contents, lowest byte first.
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

/// Writes rows of one table. A new row replaces an existing row with the same key.
class RowWriter {
  public:
    /// columns  names of the columns, without `checksum`.
    RowWriter(Database& database, const std::string& table, const std::vector<std::string>& columns);

    // To write a row, call one of these functions for each column, in order, then finish().
    RowWriter& integer(std::int64_t value);
    RowWriter& integer(std::optional<std::int64_t> value);
    RowWriter& real(double value);
    RowWriter& real(std::optional<double> value);
    RowWriter& text(std::string_view value);
    RowWriter& bytes(std::span<const std::byte> value); // must stay valid until finish()
    /// Includes the checksum of another row in the checksum of this row.
    RowWriter& covers(std::int64_t checksum);
    /// Writes the row and returns its checksum.
    std::int64_t finish();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

/// Reads rows of one table, in the order of the query.
class RowReader {
  public:
    /// condition  SQL condition with one "?" for each number in `values`. ORDER BY and LIMIT may follow it.
    RowReader(Database& database, const std::string& table, const std::vector<std::string>& columns,
              const std::string& condition, const std::vector<std::int64_t>& values);

    /// Moves to the next row. Returns false if there is none, or if the database has failed.
    bool next();

    // To read a row, call one of these functions for each column, in order, then sound().
    std::int64_t integer();
    std::optional<std::int64_t> optional_integer();
    double real();
    std::optional<double> optional_real();
    std::string text();
    std::string bytes();
    /// Includes the checksum of another row, like RowWriter::covers().
    void covers(std::int64_t checksum) { checksum_.add(checksum); }
    /// The stored checksum. To be called after all columns have been read.
    std::int64_t checksum() const { return statement_.integer(column_); }
    /// Whether the stored checksum equals the computed one.
    bool sound();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

} // namespace evod::run_file
