// machine: what the machine itself can do, as roofs over what evod does on it: bandwidth of memory and caches, and
// instructions a second. One line of JSON.
//
// Source  the triad of McCalpin's STREAM (a = b + s · c), 24 bytes an element counted as there, without the read of
//         what is overwritten; written.
#include <boost/json.hpp>

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <thread>
#include <utility>
#include <vector>

namespace evod::bench {
namespace {

/// Runs work(thread) on every thread at once; seconds from the first one's start to the last one's end.
template <class Work>
double at_once(unsigned threads, Work&& work) {
    using Clock = std::chrono::steady_clock;
    struct Span {
        Clock::time_point begin, end;
    };
    std::vector<Span> spans(threads);
    std::barrier ready{threads};
    {
        std::vector<std::jthread> pool;
        for (unsigned thread = 0; thread < threads; ++thread) {
            pool.emplace_back([&, thread] {
                ready.arrive_and_wait();
                spans[thread].begin = Clock::now();
                work(thread);
                spans[thread].end = Clock::now();
            });
        }
    }
    const auto first = std::ranges::min_element(spans, {}, &Span::begin)->begin;
    const auto last = std::ranges::max_element(spans, {}, &Span::end)->end;
    return std::chrono::duration<double>(last - first).count();
}

/// GB/s of the triad over three arrays of `array_bytes` a thread, the best of several passes.
double triad(unsigned threads, std::size_t array_bytes) {
    const std::size_t n = array_bytes / sizeof(double);
    struct Arrays {
        std::vector<double> a, b, c;
    };
    std::vector<Arrays> arrays(threads);
    // Each thread touches its own first, for where memory belongs to a processor.
    at_once(threads, [&](unsigned thread) {
        arrays[thread] = {std::vector<double>(n, 1), std::vector<double>(n, 2), std::vector<double>(n, 3)};
    });
    const std::size_t repeats = std::max<std::size_t>(1, (std::size_t{256} << 20) / array_bytes);
    double best = 0;
    for (int pass = 0; pass < 10; ++pass) {
        const double seconds = at_once(threads, [&](unsigned thread) {
            double *a = arrays[thread].a.data(), *b = arrays[thread].b.data(), *c = arrays[thread].c.data();
            for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
                for (std::size_t i = 0; i < n; ++i) {
                    a[i] = b[i] + 3.0 * c[i];
                }
                std::swap(a, b); // so that no pass can be left out
            }
        });
        best = std::max(best, 24e-9 * static_cast<double>(n * repeats * threads) / seconds);
    }
    return best;
}

/// Instructions a second, in 10^9, of eight chains of additions that do not wait for each other; 0 where unknown.
double instructions_g_per_s(unsigned threads) {
#ifdef __x86_64__
    constexpr std::uint64_t rounds = 20'000'000, per_round = 66;
    double best = 0;
    for (int pass = 0; pass < 5; ++pass) {
        const double seconds = at_once(threads, [](unsigned) {
            std::uint64_t left = rounds;
            // 64 additions, the counter and the jump, which are one operation to the processor but two instructions.
            asm volatile(".balign 64\n"
                         "1:\n"
                         ".rept 8\n"
                         "add $1, %%rax\n add $1, %%rbx\n add $1, %%rcx\n add $1, %%rdx\n"
                         "add $1, %%r8\n add $1, %%r9\n add $1, %%r10\n add $1, %%r11\n"
                         ".endr\n"
                         "dec %0\n"
                         "jnz 1b\n"
                         : "+r"(left)
                         :
                         : "rax", "rbx", "rcx", "rdx", "r8", "r9", "r10", "r11", "cc");
        });
        best = std::max(best, 1e-9 * static_cast<double>(rounds * per_round * threads) / seconds);
    }
    return best;
#else
    return 0 * threads;
#endif
}

} // namespace
} // namespace evod::bench

int main() {
    using namespace evod::bench;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    boost::json::object line{{"cores", cores}};
    for (const auto& [threads, name] : {std::pair{1u, "one_thread"}, std::pair{2u, "two_threads"}}) {
        line[name] = {{"memory_gb_per_s", triad(threads, std::size_t{256} << 20)},
                      {"cache_8_mib_gb_per_s", triad(threads, (std::size_t{8} << 20) / 3)},
                      {"cache_192_kib_gb_per_s", triad(threads, std::size_t{64} << 10)},
                      {"instructions_g_per_s", instructions_g_per_s(threads)}};
    }
    std::cout << line << '\n';
}
