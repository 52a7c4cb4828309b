#include "server/run_file/checkpoint.h"

#include "server/base/assert.h"
#include "server/simulation/state_bytes.h"

#include <zstd.h>

#include <memory>
#include <utility>

namespace evod::run_file {

using base::RefusalCode;
using base::Result;

namespace {

constexpr int compression_level = 1; // higher levels take much longer and save little: most values are positions

class Compressor {
  public:
    Compressor() : context_{ZSTD_createCCtx(), ZSTD_freeCCtx} {
        EVOD_ASSERT(context_ != nullptr);
        ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, compression_level);
    }
    /// Makes zstd store the uncompressed size, so that a reader can check it before it allocates memory.
    void expect(std::size_t bytes) { ZSTD_CCtx_setPledgedSrcSize(context_.get(), bytes); }

    void add(std::string_view bytes) { run({bytes.data(), bytes.size(), 0}, ZSTD_e_continue); }
    std::string finish() && {
        run({nullptr, 0, 0}, ZSTD_e_end);
        return std::move(packed_);
    }

  private:
    void run(ZSTD_inBuffer in, ZSTD_EndDirective directive) {
        for (;;) {
            if (used_ == packed_.size()) {
                packed_.resize(packed_.size() + packed_.size() / 2 + ZSTD_CStreamOutSize());
            }
            ZSTD_outBuffer out{packed_.data(), packed_.size(), used_};
            const std::size_t left = ZSTD_compressStream2(context_.get(), &out, &in, directive);
            EVOD_ASSERT(!ZSTD_isError(left));
            used_ = out.pos;
            if (directive == ZSTD_e_end ? left == 0 : in.pos == in.size) {
                break;
            }
        }
        if (directive == ZSTD_e_end) {
            packed_.resize(used_);
        }
    }

    std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> context_;
    std::string packed_;
    std::size_t used_ = 0; // bytes used in packed_
};

} // namespace

std::string pack(const simulation::WorldState& state) {
    Compressor compressor;
    compressor.expect(bytes_of_state(state));
    write_state(state, [&](std::string_view bytes) { compressor.add(bytes); });
    return std::move(compressor).finish();
}

std::string pack(const simulation::IslandOpening& opening) {
    const std::string bytes = simulation::bytes_of_opening(opening);
    Compressor compressor;
    compressor.expect(bytes.size());
    compressor.add(bytes);
    return std::move(compressor).finish();
}

StoredCheckpoint pack(const Checkpoint& checkpoint) {
    return {.moment = checkpoint.state.moment,
            .parameters = checkpoint.state.parameters,
            .hash = checkpoint.hash,
            .journal_entries = checkpoint.journal_entries,
            .state = pack(checkpoint.state)};
}

namespace {

Result<std::string> decompress(std::string_view packed, std::size_t bytes) {
    std::string columns(bytes, '\0');
    const std::size_t unpacked = ZSTD_decompress(columns.data(), columns.size(), packed.data(), packed.size());
    if (ZSTD_isError(unpacked) || unpacked != columns.size()) {
        return refusal(RefusalCode::DataLoss, "it cannot be decompressed");
    }
    return columns;
}

/// Refuses a number of bytes that no packed part of a colony has. Positions and genes differ, so zstd compresses them
/// to no less than a few bytes each.
Result<void> check_ratio(std::string_view packed, std::size_t bytes) {
    constexpr std::size_t small = 1 << 20, ratio_max = 256;
    if (bytes > small && bytes / ratio_max > packed.size()) {
        return refusal(RefusalCode::DataLoss, "it contains more than organisms of a colony can need");
    }
    return {};
}

} // namespace

Result<void> unpack(std::string_view packed, std::span<const simulation::IslandShape> shapes,
                    simulation::WorldState& state) {
    // The size is checked before any memory is allocated.
    const unsigned long long bytes = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (auto checked = simulation::check_state_size(bytes, shapes); !checked) {
        return checked;
    }
    if (!shapes.empty() && shapes.front().is_colony) {
        if (auto checked = check_ratio(packed, bytes); !checked) {
            return checked;
        }
    }
    const auto columns = decompress(packed, bytes);
    if (!columns) {
        return columns.error();
    }
    return read_state(*columns, shapes, state);
}

Result<simulation::IslandOpening> unpack_opening(std::string_view packed) {
    const unsigned long long bytes = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (auto checked = check_ratio(packed, bytes); !checked) {
        return checked.error();
    }
    const auto columns = decompress(packed, bytes);
    if (!columns) {
        return columns.error();
    }
    return simulation::read_opening(*columns);
}

} // namespace evod::run_file
