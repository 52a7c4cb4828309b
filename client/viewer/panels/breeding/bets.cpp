#include "client/viewer/panels/breeding/bets.h"

#include "client/viewer/text/numbers.h"

#include <functional>

namespace evod::viewer {

void Bets::toggle(std::uint32_t organism) {
    if (std::erase(organisms_, organism) == 0 && !full()) {
        organisms_.push_back(organism);
    }
}

BetScore score_of(const Bets& bets, const Comparison& comparison, std::span<const std::uint32_t> copies,
                  std::uint32_t picks) {
    BetScore score{.bets = bets.organisms().size(), .picks = picks};
    for (std::size_t rank = 0; rank < copies.size(); ++rank) {
        if (bets.has(comparison.organisms[rank])) {
            score.hits += copies[rank];
            score.law += comparison.expected.copies[rank];
        }
    }
    if (!copies.empty()) {
        score.random = static_cast<double>(score.bets) * picks / static_cast<double>(copies.size());
    }
    std::vector<std::uint32_t> sorted{copies.begin(), copies.end()};
    std::ranges::sort(sorted, std::greater<>{});
    for (std::size_t i = 0; i < std::min(score.bets, sorted.size()); ++i) {
        score.most += sorted[i];
    }
    return score;
}

std::string score_text(const BetScore& score, bool complete) {
    std::string text = print("%u of %u %s hit your %zu %s", score.hits, score.picks,
                             score.picks == 1 ? "pick" : "picks", score.bets, score.bets == 1 ? "bet" : "bets");
    text += ". Random bets: " + three_digits(score.random) + " expected.";
    if (complete) {
        text += " Your bets: " + three_digits(score.law) +
                " expected by the law of the selection. The best possible bets: " + std::to_string(score.most) + ".";
        if (score.random > 0) {
            text += " Score: " + three_digits(score.hits / score.random) + " times random betting.";
        }
    }
    return text;
}

} // namespace evod::viewer
