// Rows with a checksum: every row of a run file ends with a column `checksum`, XXH3 (64 bits) of the name of its table
// and of what stands in its other columns, so that a changed row is told from a right one.
//
// A row is hashed as: the table's name; per column its kind, its length if it has one, and its bytes, lowest first.
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
    void add_nothing();
    std::int64_t finish();

  private:
    void add_kind(char kind, std::uint64_t length);
    const std::string table_;
    XXH3_state_s* state_;
};

/// Writes rows of one table; what is there under the same key is replaced.
class RowWriter {
  public:
    /// columns  without `checksum`.
    RowWriter(Database& database, const std::string& table, const std::vector<std::string>& columns);

    // The columns of a row in order, then finish().
    RowWriter& integer(std::int64_t value);
    RowWriter& integer(std::optional<std::int64_t> value);
    RowWriter& natural(std::uint64_t value) { return integer(static_cast<std::int64_t>(value)); }
    RowWriter& real(double value);
    RowWriter& real(std::optional<double> value);
    RowWriter& text(std::string_view value);
    RowWriter& bytes(std::span<const std::byte> value);
    /// The checksum of another row, which that of this one covers too.
    RowWriter& covers(std::int64_t checksum);
    /// returns  its checksum.
    std::int64_t finish();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

/// Reads rows of one table, in the order of its key.
class RowReader {
  public:
    /// condition  in SQL, with "?" for the numbers of `where`; may be followed by an order.
    RowReader(Database& database, const std::string& table, const std::vector<std::string>& columns,
              const std::string& condition = "1", const std::vector<std::int64_t>& where = {});

    /// Whether there is one more row.
    bool next();

    // The columns of a row in order, then sound().
    std::int64_t integer();
    std::optional<std::int64_t> optional_integer();
    std::uint64_t natural() { return static_cast<std::uint64_t>(integer()); }
    double real();
    std::optional<double> optional_real();
    std::string text();
    std::string bytes();
    /// As RowWriter has it.
    void covers(std::int64_t checksum) { checksum_.add(checksum); }
    /// Once all columns are read.
    std::int64_t checksum() const { return statement_.integer(column_); }
    /// Whether the checksum is that of the row.
    bool sound();

  private:
    Statement statement_;
    RowChecksum checksum_;
    int column_ = 0;
};

} // namespace evod::run_file
