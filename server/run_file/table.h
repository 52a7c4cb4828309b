// Table: one declaration per table of a run file. The CREATE, INSERT and SELECT statements of the table and the
// checksum of its rows are derived from the declaration.
//
// A table is a type with these members (rows.h declares all tables):
//
//   name                   the table's name in the file
//   key_columns            number of columns, from the first, that form the primary key
//   Row                    the contents of one row, as read from the table
//   columns(row, column)   calls column("name", member) for each column, in order. This is a template, so it can write
//                          any struct that has the same member names, without copying it to a Row.
//
// The type of a member determines the type of its column. Whole numbers, bool and enumerators are INTEGER, double is
// REAL, std::string is TEXT, and Blob is BLOB. std::optional allows NULL.
#pragma once

#include "server/evolution/chromosome.h"
#include "server/evolution/price.h"
#include "server/run_file/row.h"

#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace evod::run_file {

/// A member that is stored as a BLOB, lowest byte first. It may be a string, a span or a vector of numbers.
template <class Container>
struct Blob {
    Container& value;
};
template <class Container>
Blob(Container&) -> Blob<Container>;

/// A member that is stored as a BLOB: the genes of `organism_count` organisms, whose number of genes follows from the
/// size of the BLOB.
template <class Matrix>
struct GeneBlob {
    Matrix& value;
    const std::uint64_t& organism_count;
};
template <class Matrix>
GeneBlob(Matrix&, const std::uint64_t&) -> GeneBlob<Matrix>;

/// One INTEGER column for the two pause flags of a run: 0 running, 1 paused, 2 paused until a lease ends.
template <class Flag>
struct PauseColumn {
    Flag &paused, &leased;
};

/// The columns of a selection account, which are those of the body genes; all are NULL if there is no account.
template <class Account>
struct AccountColumns {
    Account& account;
};

/// Checksums of other rows, which the checksum of this row covers at this position. This member adds no column.
struct CoveredChecksums {
    std::vector<std::int64_t> values;
    // Fills in `values` when a row is read; called after the columns before this position.
    std::function<void()> read = {};
};

struct Column {
    std::string name, type; // type: SQL type, such as "REAL NOT NULL"
};

/// Collects the columns of a table.
class DescribeColumns {
  public:
    template <class T>
    void operator()(const std::string& name, const T&) {
        columns.push_back({name, type_of(static_cast<T*>(nullptr))});
    }
    template <class Account>
    void operator()(const std::string&, const AccountColumns<Account>&) {
        evolution::for_each_number(std::nullopt, evolution::body_gene_names, [&](const std::string& name, auto) {
            columns.push_back({name, "REAL"});
        });
    }
    void operator()(const std::string&, const CoveredChecksums&) {}

    std::vector<Column> columns;

  private:
    template <class T>
    static std::string type_of(T*) {
        return std::is_floating_point_v<T> ? "REAL NOT NULL" : "INTEGER NOT NULL";
    }
    template <class T>
    static std::string type_of(std::optional<T>*) {
        return std::is_floating_point_v<T> ? "REAL" : "INTEGER";
    }
    template <class T>
    static std::string type_of(Blob<T>*) {
        return "BLOB NOT NULL";
    }
    template <class T>
    static std::string type_of(GeneBlob<T>*) {
        return "BLOB NOT NULL";
    }
    static std::string type_of(std::string*) { return "TEXT NOT NULL"; }
};

template <class Table>
std::vector<Column> columns_of() {
    DescribeColumns describe;
    typename Table::Row row{};
    Table::columns(row, describe);
    return std::move(describe.columns);
}

template <class Table>
std::vector<std::string> column_names() {
    std::vector<std::string> names;
    for (Column& column : columns_of<Table>()) {
        names.push_back(std::move(column.name));
    }
    return names;
}

/// The CREATE statement. SQLite stores its text in every file. A file with any other text is refused.
std::string create_statement(const std::string& table, const std::vector<Column>& columns, std::size_t key_columns,
                             bool one_line);

template <class Table>
std::string create_statement() {
    return create_statement(
        Table::name, columns_of<Table>(), Table::key_columns, requires { Table::one_line; });
}

/// Binds the columns of a row.
class PutColumns {
  public:
    explicit PutColumns(RowWriter& writer) : writer_{writer} {}

    template <class T>
    void operator()(const std::string&, const T& value) {
        if constexpr (std::is_floating_point_v<T>) {
            writer_.real(value);
        } else {
            writer_.integer(static_cast<std::int64_t>(value));
        }
    }
    void operator()(const std::string&, const std::string& value) { writer_.text(value); }
    void operator()(const std::string&, const std::optional<double>& value) { writer_.real(value); }
    void operator()(const std::string&, const std::optional<std::uint64_t>& value) {
        writer_.integer(value ? std::optional{static_cast<std::int64_t>(*value)} : std::nullopt);
    }
    template <class T>
    void operator()(const std::string&, const Blob<T>& blob) {
        writer_.bytes(bytes_of(blob.value));
    }
    template <class T>
    void operator()(const std::string&, const GeneBlob<T>& blob) {
        writer_.bytes(std::as_bytes(std::span{blob.value.data(), static_cast<std::size_t>(blob.value.size())}));
    }
    template <class T>
    void operator()(const std::string&, const PauseColumn<T>& pause) {
        writer_.integer(std::int64_t{pause.paused} + pause.leased);
    }
    template <class T>
    void operator()(const std::string&, const AccountColumns<T>& columns) {
        evolution::for_each_number(columns.account, evolution::body_gene_names,
                                   [&](const std::string&, std::optional<double> value) { writer_.real(value); });
    }
    void operator()(const std::string&, const CoveredChecksums& covered) {
        for (const std::int64_t checksum : covered.values) {
            writer_.covers(checksum);
        }
    }

  private:
    static std::span<const std::byte> bytes_of(const std::span<const std::byte>& bytes) { return bytes; }
    static std::span<const std::byte> bytes_of(const std::string& bytes) { return std::as_bytes(std::span{bytes}); }
    template <class T>
    static std::span<const std::byte> bytes_of(const std::vector<T>& values) {
        return std::as_bytes(std::span{values});
    }

    RowWriter& writer_;
};

/// Reads the columns of a row. well_formed is false if the size of a BLOB is invalid for the type of its member.
class GetColumns {
  public:
    explicit GetColumns(RowReader& reader) : reader_{reader} {}

    template <class T>
    void operator()(const std::string&, T& value) {
        if constexpr (std::is_floating_point_v<T>) {
            value = reader_.real();
        } else if constexpr (std::is_same_v<T, bool>) {
            value = reader_.integer() != 0;
        } else {
            value = static_cast<T>(reader_.integer());
        }
    }
    void operator()(const std::string&, std::string& value) { value = reader_.text(); }
    void operator()(const std::string&, std::optional<double>& value) { value = reader_.optional_real(); }
    void operator()(const std::string&, std::optional<std::uint64_t>& value) {
        const auto read = reader_.optional_integer();
        value = read ? std::optional{static_cast<std::uint64_t>(*read)} : std::nullopt;
    }
    template <class T>
    void operator()(const std::string&, const Blob<T>& blob) {
        well_formed &= read_into(blob.value, reader_.bytes());
    }
    template <class T>
    void operator()(const std::string&, const GeneBlob<T>& blob) {
        well_formed &= read_genes(blob.value, blob.organism_count, reader_.bytes());
    }
    template <class T>
    void operator()(const std::string&, const PauseColumn<T>& pause) {
        const std::int64_t value = reader_.integer();
        pause.paused = value != 0;
        pause.leased = value == 2;
    }
    template <class T>
    void operator()(const std::string&, const AccountColumns<T>& columns) {
        columns.account = evolution::account_from(evolution::body_gene_count, [&] { return reader_.optional_real(); });
    }
    void operator()(const std::string&, CoveredChecksums& covered) {
        covered.values.clear();
        if (covered.read) {
            covered.read();
        }
        for (const std::int64_t checksum : covered.values) {
            reader_.covers(checksum);
        }
    }

    bool well_formed = true;

  private:
    static bool read_into(std::string& to, std::string bytes) {
        to = std::move(bytes);
        return true;
    }
    template <class T>
    static bool read_into(std::vector<T>& to, const std::string& bytes) {
        to.resize(bytes.size() / sizeof(T));
        if (!to.empty()) {
            std::memcpy(to.data(), bytes.data(), to.size() * sizeof(T));
        }
        return bytes.size() % sizeof(T) == 0;
    }
    static bool read_genes(evolution::GeneMatrix& to, std::uint64_t organism_count, const std::string& bytes) {
        const std::size_t numbers = bytes.size() / sizeof(float);
        if (organism_count == 0 || bytes.size() % sizeof(float) != 0 || numbers % organism_count != 0 || numbers == 0) {
            to.resize(evolution::body_gene_count, 0);
            return bytes.empty();
        }
        to.resize(static_cast<Eigen::Index>(numbers / organism_count), static_cast<Eigen::Index>(organism_count));
        std::memcpy(to.data(), bytes.data(), bytes.size());
        return true;
    }

    RowReader& reader_;
};

/// Writes rows of a table. A new row replaces an existing row with the same key.
template <class Table>
class TableWriter {
  public:
    explicit TableWriter(Database& database, const std::string& table = Table::name)
        : writer_{database, table, column_names<Table>()} {}

    /// row  a Table::Row, or a struct with members of the same names.
    ///
    /// returns  the checksum of the row.
    template <class Row>
    std::int64_t write(const Row& row) {
        PutColumns put{writer_};
        Table::columns(row, put);
        return writer_.finish();
    }

  private:
    RowWriter writer_;
};

/// Reads rows of a table.
template <class Table>
class TableReader {
  public:
    /// condition  SQL condition with one "?" for each number in `values`. ORDER BY and LIMIT may follow it.
    TableReader(Database& database, const std::string& condition, const std::vector<std::int64_t>& values = {},
                const std::string& table = Table::name)
        : reader_{database, table, column_names<Table>(), condition, values} {}

    /// Reads the next row. Returns false if there is none, or if the database has failed.
    bool next(typename Table::Row& row) {
        if (!reader_.next()) {
            return false;
        }
        GetColumns get{reader_};
        Table::columns(row, get);
        checksum_ = reader_.checksum();
        sound_ = reader_.sound() && get.well_formed;
        return true;
    }
    /// Whether the stored checksum of the last row equals the computed one.
    bool sound() const { return sound_; }
    std::int64_t checksum() const { return checksum_; }

  private:
    RowReader reader_;
    bool sound_ = false;
    std::int64_t checksum_ = 0;
};

} // namespace evod::run_file
