// A tick allocates nothing once its working memory is warm.
#include "server/base/inline_executor.h"
#include "server/simulation/experiment.h"
#include "server/simulation/world.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

// g++ does not see that both halves of a pair are replaced.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {
std::size_t allocations = 0; // by this program, which has one thread
}

void* operator new(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size > 0 ? size : 1))
        return memory;
    throw std::bad_alloc{};
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    ++allocations;
    const auto align = static_cast<std::size_t>(alignment);
    if (void* memory = std::aligned_alloc(align, (size + align - 1) / align * align))
        return memory;
    throw std::bad_alloc{};
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace evod::simulation {
namespace {

class AWarmTick : public testing::TestWithParam<const char*> {};

TEST_P(AWarmTick, AllocatesNothing) {
    World world{parse_experiment(GetParam()).value().parameters, base::Seed{1}};
    base::InlineExecutor executor;
    // A generation, its turnover, and part of the next: everything has been as large as it gets.
    while (world.moment().generation < 2 || world.moment().generation_tick < 300)
        world.advance_tick(executor);
    for (int tick = 0; tick < 300; ++tick) {
        const std::size_t before = allocations;
        world.advance_tick(executor);
        ASSERT_EQ(allocations, before) << "in tick " << world.moment().generation_tick;
    }
    ASSERT_EQ(world.moment().generation, 2u);
}

INSTANTIATE_TEST_SUITE_P(
    Worlds, AWarmTick,
    testing::Values(
        R"({})",
        R"({"population_size": 5000, "scale_with_population": true, "reference_population": 50, "generation_s": 15})",
        R"({"crate_count": 12, "obstacle_count": 12, "integrator": "explicit_euler", "respawn_s": 2})",
        R"({"island_count": 4, "generation_s": 15})"));

} // namespace
} // namespace evod::simulation
