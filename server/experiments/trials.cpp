#include "server/experiments/trials.h"

#include "server/base/assert.h"
#include "server/base/exact_number.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace evod::experiments {

void for_each_trial(std::size_t count, std::size_t jobs, const std::function<void(std::size_t index)>& work,
                    const std::function<bool()>& stopped) {
    EVOD_ASSERT(jobs >= 1);
    std::atomic<std::size_t> next = 0;
    const auto take_trials = [&] {
        while (!stopped()) {
            const std::size_t index = next.fetch_add(1, std::memory_order_relaxed);
            if (index >= count) {
                return;
            }
            work(index);
        }
    };
    std::vector<std::thread> threads(std::min(jobs, count));
    for (std::thread& thread : threads) {
        thread = std::thread{take_trials};
    }
    for (std::thread& thread : threads) {
        thread.join();
    }
}

base::Seed replicate_seed(base::Seed seed, std::uint32_t replicate) {
    return base::portable_seed(base::RandomStream{{seed, base::Purpose::Replicate, 0, 0}, replicate}.long_word());
}

} // namespace evod::experiments
