#include "client/viewer/panels/breeding/tournament.h"

#include <algorithm>

namespace evod::viewer {

std::vector<Contestant> contestants_of(const BreedingRecord& record, std::uint32_t index) {
    const evod::v1::Pick* pick = record.pick(index);
    std::vector<Contestant> contestants;
    if (pick == nullptr || !pick->has_tournament()) {
        return contestants;
    }
    for (const std::uint32_t organism : pick->contestants()) {
        contestants.push_back({.organism = organism});
    }
    const auto in_same_tournament = [&](std::uint32_t i) {
        const evod::v1::Pick* other = record.pick(i);
        return other != nullptr && other->has_tournament() && other->tournament() == pick->tournament();
    };
    std::uint32_t first = index;
    while (first > 0 && in_same_tournament(first - 1)) {
        --first;
    }
    for (std::uint32_t i = first; in_same_tournament(i); ++i) {
        const auto winner = std::ranges::find_if(contestants, [&](const Contestant& contestant) {
            return !contestant.won && contestant.organism == record.pick(i)->organism();
        });
        if (winner != contestants.end()) {
            winner->won = true;
            winner->picked_now = i == index;
        }
    }
    return contestants;
}

} // namespace evod::viewer
