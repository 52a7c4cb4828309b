#include "server/evolution/ranking.h"

#include "server/base/assert.h"
#include "server/base/inline_executor.h"
#include "server/evolution/distribution.h"

#include <algorithm>
#include <cmath>

namespace evod::evolution {
namespace {

constexpr std::size_t organisms_per_bucket = 4, buckets_max = 4096;
constexpr std::size_t buckets_per_piece = 64;

struct Entry {
    double fitness;
    std::uint32_t organism;

    friend bool operator<(const Entry& a, const Entry& b) {
        return a.fitness > b.fitness || (a.fitness == b.fitness && a.organism < b.organism);
    }
};

/// Divides the range of fitness into buckets of equal width. A fitter organism is never in a later bucket, despite
/// rounding: every step of the computation is monotonic.
class Buckets {
  public:
    explicit Buckets(std::span<const double> fitness) {
        const auto [least, greatest] = std::minmax_element(fitness.begin(), fitness.end());
        EVOD_ASSERT(std::isfinite(*least));
        EVOD_ASSERT(std::isfinite(*greatest));
        half_of_greatest_ = *greatest / 2; // halves, because the full difference may overflow a double
        const auto count = std::clamp<std::size_t>(fitness.size() / organisms_per_bucket, 1, buckets_max);
        const double per_unit = static_cast<double>(count) / (half_of_greatest_ - *least / 2);
        if (std::isfinite(per_unit)) {
            per_unit_ = per_unit;
            count_ = count;
        }
    }

    std::size_t count() const { return count_; }
    std::size_t of(double fitness) const {
        return std::min(static_cast<std::size_t>((half_of_greatest_ - fitness / 2) * per_unit_), count_ - 1);
    }

  private:
    double half_of_greatest_, per_unit_ = 0;
    std::size_t count_ = 1;
};

} // namespace

std::span<const std::uint32_t> Ranking::best_first() {
    const std::size_t population = fitness_.size();
    if (best_first_.size() == population) {
        return best_first_;
    }
    base::InlineExecutor own_thread;
    base::Executor& executor = executor_ == nullptr ? own_thread : *executor_;

    EVOD_ASSERT(population >= 1);
    const Buckets buckets{fitness_};
    std::vector<Entry> entries(population);
    const auto begins = distribute(
        population, buckets.count(), executor, [&](std::size_t i) { return buckets.of(fitness_[i]); },
        [&](std::size_t i, std::uint32_t place) {
            entries[place] = {fitness_[i], static_cast<std::uint32_t>(i)};
        });
    best_first_.resize(population);
    executor.parallel_for(buckets.count(), buckets_per_piece, [&](base::Range piece) {
        for (std::size_t bucket = piece.begin; bucket < piece.end; ++bucket) {
            std::sort(entries.begin() + begins[bucket], entries.begin() + begins[bucket + 1]);
        }
        for (std::size_t rank = begins[piece.begin]; rank < begins[piece.end]; ++rank) {
            best_first_[rank] = entries[rank].organism;
        }
    });
    return best_first_;
}

std::vector<double> Ranking::best_fitness(std::uint32_t count) {
    std::vector<double> fitness(count);
    std::ranges::transform(best_first().first(count), fitness.begin(),
                           [this](std::uint32_t organism) { return fitness_[organism]; });
    return fitness;
}

} // namespace evod::evolution
