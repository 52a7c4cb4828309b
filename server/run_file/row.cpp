#include "server/run_file/row.h"

#include <xxhash.h>

#include <bit>
#include <cstring>

namespace evod::run_file {

static_assert(std::endian::native == std::endian::little, "numbers are hashed and stored lowest byte first");

RowChecksum::RowChecksum(std::string_view table) : table_{table}, state_{XXH3_createState()} {
    begin();
}

RowChecksum::~RowChecksum() {
    XXH3_freeState(state_);
}

void RowChecksum::begin() {
    XXH3_64bits_reset(state_);
    XXH3_64bits_update(state_, table_.data(), table_.size());
}

void RowChecksum::add_type(char type, std::uint64_t length) {
    char head[1 + sizeof length] = {type};
    std::memcpy(head + 1, &length, sizeof length);
    XXH3_64bits_update(state_, head, sizeof head);
}

void RowChecksum::add(std::int64_t value) {
    add_type('i', static_cast<std::uint64_t>(value));
}

void RowChecksum::add(double value) {
    // Adding 0.0 turns −0 into 0, because SQLite stores −0 as 0.
    add_type('r', std::bit_cast<std::uint64_t>(value + 0.0));
}

void RowChecksum::add_text(std::string_view text) {
    add_type('t', text.size());
    XXH3_64bits_update(state_, text.data(), text.size());
}

void RowChecksum::add_bytes(std::span<const std::byte> bytes) {
    add_type('b', bytes.size());
    XXH3_64bits_update(state_, bytes.data(), bytes.size());
}

void RowChecksum::add_null() {
    add_type('n', 0);
}

std::int64_t RowChecksum::finish() {
    const auto sum = static_cast<std::int64_t>(XXH3_64bits_digest(state_));
    begin();
    return sum;
}

namespace {

std::string joined(const std::vector<std::string>& columns) {
    std::string text;
    for (const std::string& column : columns) {
        text += column + ", ";
    }
    return text + "checksum";
}

std::string insertion(const std::string& table, const std::vector<std::string>& columns) {
    std::string places;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        places += "?, ";
    }
    return "INSERT OR REPLACE INTO " + table + " (" + joined(columns) + ") VALUES (" + places + "?)";
}

} // namespace

RowWriter::RowWriter(Database& database, const std::string& table, const std::vector<std::string>& columns)
    : statement_{database, insertion(table, columns)}, checksum_{table} {}

RowWriter& RowWriter::integer(std::int64_t value) {
    statement_.bind(column_++, value);
    checksum_.add(value);
    return *this;
}

RowWriter& RowWriter::integer(std::optional<std::int64_t> value) {
    if (value) {
        return integer(*value);
    }
    statement_.bind_null(column_++);
    checksum_.add_null();
    return *this;
}

RowWriter& RowWriter::real(double value) {
    statement_.bind(column_++, value);
    checksum_.add(value);
    return *this;
}

RowWriter& RowWriter::real(std::optional<double> value) {
    if (value) {
        return real(*value);
    }
    statement_.bind_null(column_++);
    checksum_.add_null();
    return *this;
}

RowWriter& RowWriter::text(std::string_view value) {
    statement_.bind(column_++, value);
    checksum_.add_text(value);
    return *this;
}

RowWriter& RowWriter::bytes(std::span<const std::byte> value) {
    statement_.bind(column_++, value);
    checksum_.add_bytes(value);
    return *this;
}

RowWriter& RowWriter::covers(std::int64_t checksum) {
    checksum_.add(checksum);
    return *this;
}

std::int64_t RowWriter::finish() {
    const std::int64_t checksum = checksum_.finish();
    statement_.bind(column_, checksum);
    statement_.done();
    column_ = 0;
    return checksum;
}

RowReader::RowReader(Database& database, const std::string& table, const std::vector<std::string>& columns,
                     const std::string& condition, const std::vector<std::int64_t>& values)
    : statement_{database, "SELECT " + joined(columns) + " FROM " + table + " WHERE " + condition}, checksum_{table} {
    for (std::size_t i = 0; i < values.size(); ++i) {
        statement_.bind(static_cast<int>(i), values[i]);
    }
}

bool RowReader::next() {
    column_ = 0;
    checksum_.begin();
    return statement_.row();
}

std::int64_t RowReader::integer() {
    const std::int64_t value = statement_.integer(column_++);
    checksum_.add(value);
    return value;
}

std::optional<std::int64_t> RowReader::optional_integer() {
    if (!statement_.is_null(column_)) {
        return integer();
    }
    ++column_;
    checksum_.add_null();
    return std::nullopt;
}

double RowReader::real() {
    const double value = statement_.real(column_++);
    checksum_.add(value);
    return value;
}

std::optional<double> RowReader::optional_real() {
    if (!statement_.is_null(column_)) {
        return real();
    }
    ++column_;
    checksum_.add_null();
    return std::nullopt;
}

std::string RowReader::text() {
    std::string value = statement_.text(column_++);
    checksum_.add_text(value);
    return value;
}

std::string RowReader::bytes() {
    std::string value = statement_.bytes(column_++);
    checksum_.add_bytes(std::as_bytes(std::span{value}));
    return value;
}

bool RowReader::sound() {
    return statement_.integer(column_) == checksum_.finish();
}

} // namespace evod::run_file
