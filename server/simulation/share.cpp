#include "server/simulation/share.h"

#include "server/base/assert.h"

namespace evod::simulation {
namespace {

void pack(base::Packer& packer, const std::optional<evolution::SelectionAccount>& account) {
    packer.add(account.has_value());
    if (account) {
        packer.add_list(*account);
    }
}

std::optional<evolution::SelectionAccount> unpack_account(base::Unpacker& unpacker) {
    return unpacker.next<bool>() ? std::optional{unpacker.next_list<evolution::GeneAccount>()} : std::nullopt;
}

} // namespace

base::Range share_of(std::size_t island_count, std::uint32_t rank, std::uint32_t size) {
    EVOD_ASSERT(rank < size);
    EVOD_ASSERT(size <= island_count);
    return {island_count * rank / size, island_count * (rank + 1) / size};
}

std::uint32_t rank_of(std::size_t island_count, std::size_t island, std::uint32_t size) {
    EVOD_ASSERT(island < island_count);
    return static_cast<std::uint32_t>(((island + 1) * size - 1) / island_count);
}

void pack(base::Packer& packer, const GenerationStatistics& statistics) {
    for_each_number(statistics, [&](const char*, const auto& number) { packer.add(number); });
    packer.add_list(statistics.genes);
    pack(packer, statistics.account);
}

GenerationStatistics unpack_statistics(base::Unpacker& unpacker) {
    GenerationStatistics statistics;
    for_each_number(statistics, [&](const char*, auto& number) {
        number = unpacker.next<std::remove_reference_t<decltype(number)>>();
    });
    statistics.genes = unpacker.next_list<GeneStatistics>();
    statistics.account = unpack_account(unpacker);
    return statistics;
}

void pack(base::Packer& packer, const evolution::NextGeneration& generation) {
    packer.add(std::uint64_t(generation.genes.rows()));
    packer.add(std::uint64_t(generation.genes.cols()));
    packer.add_values(std::span{generation.genes.data(), static_cast<std::size_t>(generation.genes.size())});
    packer.add_list(generation.parents);
    packer.add(generation.elite_count);
    packer.add(generation.survivor_count);
    packer.add(generation.clamped_count);
    pack(packer, generation.account);
}

evolution::NextGeneration unpack_generation(base::Unpacker& unpacker) {
    evolution::NextGeneration generation;
    const auto rows = unpacker.next<std::uint64_t>(), columns = unpacker.next<std::uint64_t>();
    generation.genes.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    unpacker.next_values(std::span{generation.genes.data(), static_cast<std::size_t>(generation.genes.size())});
    generation.parents = unpacker.next_list<evolution::Parents>();
    generation.elite_count = unpacker.next<std::uint32_t>();
    generation.survivor_count = unpacker.next<std::uint32_t>();
    generation.clamped_count = unpacker.next<std::uint64_t>();
    generation.account = unpack_account(unpacker);
    return generation;
}

} // namespace evod::simulation
