#include "server/run_file/write_ahead_log.h"

#include "server/files/regular_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

namespace evod::run_file {
namespace {

using base::RefusalCode;
using base::Result;
using Bytes = std::span<const std::byte>;

constexpr std::size_t log_head_bytes = 32, frame_head_bytes = 24;

std::uint32_t big_endian(Bytes bytes, std::size_t at) {
    std::uint32_t number = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
        number = number << 8 | std::to_integer<std::uint32_t>(bytes[i]);
    }
    return number;
}

std::uint32_t little_endian(Bytes bytes, std::size_t at) {
    static_assert(std::endian::native == std::endian::little);
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

struct Checksum {
    std::uint32_t first = 0, second = 0;
    friend bool operator==(const Checksum&, const Checksum&) = default;
};

/// Extends a checksum by more bytes. The number of bytes must be a multiple of 8.
Checksum add(Checksum sum, Bytes bytes, bool words_are_big_endian) {
    const auto add_words = [&](auto word) {
        for (std::size_t at = 0; at < bytes.size(); at += 8) {
            sum.first += word(bytes, at) + sum.second;
            sum.second += word(bytes, at + 4) + sum.first;
        }
    };
    words_are_big_endian ? add_words(big_endian) : add_words(little_endian);
    return sum;
}

using Salts = std::array<std::byte, 8>;

Salts salts_at(Bytes bytes, std::size_t at) {
    Salts salts;
    std::ranges::copy(bytes.subspan(at, salts.size()), salts.begin());
    return salts;
}

struct LogHead {
    bool sound = false;
    bool words_are_big_endian = false;
    std::size_t page_bytes = 4096; // page size of evod's files, for a log with a damaged header
    Salts salts{};
    Checksum checksum;
};

LogHead read_head(Bytes bytes) {
    constexpr std::uint32_t magic = 0x377f0682, version = 3007000; // the last bit of the magic is the byte order
    const std::uint32_t begin = big_endian(bytes, 0), page_bytes = big_endian(bytes, 8);
    LogHead head{.words_are_big_endian = (begin & 1) != 0, .salts = salts_at(bytes, 16), .checksum = {}};
    head.checksum = add({}, bytes.first(24), head.words_are_big_endian);
    head.sound = (begin & ~1u) == magic && big_endian(bytes, 4) == version && std::has_single_bit(page_bytes) &&
                 page_bytes >= 512 && page_bytes <= 65536 &&
                 head.checksum == Checksum{big_endian(bytes, 24), big_endian(bytes, 28)};
    if (head.sound) {
        head.page_bytes = page_bytes;
    } else {
        head.words_are_big_endian = false;
    }
    return head;
}

class Frame {
  public:
    explicit Frame(const LogHead& head)
        : bytes_(frame_head_bytes + head.page_bytes), words_are_big_endian_{head.words_are_big_endian} {}

    /// Reads a frame. Returns false if the log ends before the end of the frame.
    bool read(ReadAt log, std::uint64_t index) { return log(offset(index), bytes_) == bytes_.size(); }
    std::uint64_t offset(std::uint64_t index) const { return log_head_bytes + index * bytes_.size(); }

    bool has_page() const { return big_endian(bytes_, 0) != 0; }
    bool is_commit() const { return big_endian(bytes_, 4) != 0; }
    Salts salts() const { return salts_at(bytes_, 8); }
    Checksum stored() const { return {big_endian(bytes_, 16), big_endian(bytes_, 20)}; }
    /// Computes the checksum of this frame from the checksum of the previous frame.
    Checksum computed(Checksum before) const {
        const Bytes bytes{bytes_};
        return add(add(before, bytes.first(8), words_are_big_endian_), bytes.subspan(frame_head_bytes),
                   words_are_big_endian_);
    }

  private:
    std::vector<std::byte> bytes_;
    bool words_are_big_endian_;
};

/// The number of frames with these salts according to the log's index; 0 if the index belongs to another log.
std::uint64_t frames_known_to(ReadAt index, const Salts& salts) {
    constexpr std::size_t head_bytes = 48;
    std::array<std::byte, 2 * head_bytes> both; // the index has two copies of its header
    if (index(0, both) != both.size()) {
        return 0;
    }
    const Bytes head = Bytes{both}.first(head_bytes);
    const bool sound = std::ranges::equal(head, Bytes{both}.subspan(head_bytes)) && head[12] != std::byte{0} &&
                       add({}, head.first(40), false) == Checksum{little_endian(head, 40), little_endian(head, 44)};
    return sound && salts_at(head, 32) == salts ? little_endian(head, 16) : 0;
}

} // namespace

std::optional<std::uint64_t> damage_of_log(ReadAt log, ReadAt index) {
    std::array<std::byte, log_head_bytes> head_bytes;
    if (log(0, head_bytes) != head_bytes.size()) {
        return std::nullopt;
    }
    const LogHead head = read_head(head_bytes);
    Frame frame{head};
    if (!frame.read(log, 0)) {
        return std::nullopt;
    }
    const Salts salts = head.sound ? head.salts : frame.salts();
    const std::uint64_t frames_known = frames_known_to(index, salts);

    // Finds the first frame with a wrong checksum.
    Checksum sum = head.checksum;
    std::uint64_t bad = 0;
    while (head.sound && frame.has_page() && frame.salts() == salts && frame.computed(sum) == frame.stored()) {
        sum = frame.stored();
        if (!frame.read(log, ++bad)) {
            return std::nullopt;
        }
    }
    const std::uint64_t damage = head.sound ? frame.offset(bad) : 0;
    if (bad < frames_known) {
        return damage;
    }

    // Checks whether a frame after the bad one continues a commit.
    struct {
        bool is_commit;
        Checksum stored, computed; // checksums of the bad frame; either may be the right one
    } before{frame.is_commit(), frame.stored(), frame.computed(sum)};
    for (std::uint64_t next = bad + 1; frame.read(log, next); ++next) {
        const Checksum stored = frame.stored();
        const bool continues = frame.salts() == salts &&
                               (frame.computed(before.stored) == stored || frame.computed(before.computed) == stored);
        if (continues && before.is_commit) {
            return damage;
        }
        before = {frame.is_commit(), stored, stored};
    }
    return std::nullopt;
}

Result<void> check_log(const std::string& path_of_run_file, LogIndex index) {
    const std::string path = path_of_run_file + "-wal";
    const auto log = files::RegularFile::open(path, "a write-ahead log");
    if (!log) {
        // SQLite reports a log that cannot be read.
        return log.error().code == RefusalCode::InvalidArgument ? Result<void>{log.error()} : Result<void>{};
    }
    const auto index_file =
        index == LogIndex::Read
            ? std::optional{files::RegularFile::open(path_of_run_file + "-shm", "the index of a write-ahead log")}
            : std::nullopt;
    const auto read_log = [&](std::uint64_t offset, std::span<std::byte> bytes) { return log->read_at(offset, bytes); };
    const auto read_index = [&](std::uint64_t offset, std::span<std::byte> bytes) {
        return index_file && *index_file ? (*index_file)->read_at(offset, bytes) : 0;
    };
    // While a server writes, this code may read a frame before it is complete, and later frames after they are
    // complete. A second reading then finds the frame complete.
    std::optional<std::uint64_t> damage;
    Salts salts{};
    constexpr int attempts = 5;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        std::array<std::byte, log_head_bytes> head{};
        read_log(0, head);
        const auto before = std::exchange(damage, damage_of_log(read_log, read_index));
        if (!damage) {
            return {};
        }
        if (std::exchange(salts, salts_at(head, 16)) == salts_at(head, 16) && before == damage) {
            const std::string at = std::to_string(*damage);
            return refusal(RefusalCode::DataLoss,
                           path + " is damaged at byte " + at +
                               ": evod would lose all data after this byte, although it was on the disk; to accept "
                               "the loss, truncate the file: truncate -s " +
                               at + " " + path);
        }
    }
    return {};
}

} // namespace evod::run_file
