#include "server/runtime/past_reader.h"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <vector>

namespace evod::runtime {
namespace {

TEST(PastReader, ReadsOnAThreadOfItsOwnAndTellsInOrderWhereMailIsRead) {
    Mailbox mailbox;
    PastReader reader{mailbox};
    std::vector<int> told;
    std::set<std::thread::id> read_on;
    for (int i = 0; i < 3; ++i) {
        reader.ask([&told, &read_on, i]() -> PastReader::Then {
            return [&told, &read_on, i, on = std::this_thread::get_id()] {
                told.push_back(i);
                read_on.insert(on);
            };
        });
    }
    while (told.size() < 3) {
        mailbox.wait(std::nullopt);
        for (const Mail& mail : mailbox.drain()) {
            std::get<CallMail>(mail).call();
        }
    }
    EXPECT_EQ(told, (std::vector{0, 1, 2}));
    EXPECT_EQ(read_on.size(), 1u);
    EXPECT_FALSE(read_on.contains(std::this_thread::get_id()));
}

} // namespace
} // namespace evod::runtime
