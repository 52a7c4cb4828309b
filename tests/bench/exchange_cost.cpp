// How long processes need to exchange bytes: mpirun -n N exchange_cost. tests/bench/exchange_cost.py starts it.
//
// Rank 0 prints one line a size: operation, bytes of each process, shortest and median time of a call in microseconds.
#include "server/base/result.h"
#include "server/runtime/processes.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

namespace evod {
namespace {

using Clock = std::chrono::steady_clock;

template <class Call>
void measure(const char* operation, std::size_t bytes, int calls, const runtime::Processes& processes, Call&& call) {
    std::vector<double> times_us;
    for (int i = 0; i < calls; ++i) {
        const auto begun = Clock::now();
        call();
        times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begun).count());
    }
    std::ranges::sort(times_us);
    if (processes.rank() == 0) {
        std::printf("%s %zu %.2f %.2f\n", operation, bytes, times_us.front(), times_us[times_us.size() / 2]);
    }
}

} // namespace
} // namespace evod

int main() {
    using namespace evod;
    const auto joined = runtime::join_processes(std::chrono::seconds{60});
    if (!joined) {
        std::fprintf(stderr, "exchange_cost: %s\n", base::to_text(joined.error()).c_str());
        return 1;
    }
    runtime::Processes& processes = **joined;
    for (const std::size_t bytes : {std::size_t{8}, std::size_t{600}, std::size_t{1} << 16, std::size_t{1} << 20,
                                    std::size_t{1} << 23}) {
        const int calls = bytes < 1000 ? 5000 : bytes < 2'000'000 ? 200 : 30;
        const std::string part(bytes, 'x');
        measure("broadcast", bytes, calls, processes, [&] { (void)processes.broadcast(part); });
        measure("gather", bytes, calls, processes, [&] { (void)processes.gather(part); });
        measure("swap", bytes, calls, processes,
                [&] { (void)processes.swap(std::vector<std::string>(processes.size(), part)); });
    }
    return 0;
}
