#include "server/runtime/mailbox.h"

#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <thread>

namespace evod::runtime {
namespace {

Mail note(std::vector<int>& read, int number) {
    return QueryMail{[&read, number](const simulation::Laboratory&) { read.push_back(number); }};
}

void read_all(std::vector<Mail> mail) {
    const simulation::Laboratory laboratory;
    for (Mail& one : mail) {
        std::get<QueryMail>(one).ask(laboratory);
    }
}

TEST(Mailbox, ReturnsMailInOrder) {
    Mailbox mailbox;
    std::vector<int> read;
    EXPECT_FALSE(mailbox.pending());
    for (int i = 0; i < 3; ++i) {
        EXPECT_TRUE(mailbox.try_push(note(read, i)));
    }
    EXPECT_TRUE(mailbox.pending());
    read_all(mailbox.drain());
    EXPECT_EQ(read, (std::vector{0, 1, 2}));
    EXPECT_FALSE(mailbox.pending());
    EXPECT_TRUE(mailbox.drain().empty());
}

TEST(Mailbox, RefusesMailBeyondItsCapacity) {
    Mailbox mailbox{2};
    std::vector<int> read;
    EXPECT_TRUE(mailbox.try_push(note(read, 0)));
    EXPECT_TRUE(mailbox.try_push(note(read, 1)));
    Mail third = note(read, 2);
    EXPECT_FALSE(mailbox.try_push(std::move(third)));
    EXPECT_TRUE(std::get<QueryMail>(third).ask) << "refused mail is unchanged";
    read_all(mailbox.drain());
    EXPECT_TRUE(mailbox.try_push(std::move(third)));
    read_all(mailbox.drain());
    EXPECT_EQ(read, (std::vector{0, 1, 2}));
}

TEST(Mailbox, WakesTheWaitingThread) {
    Mailbox mailbox;
    std::vector<int> read;
    std::thread waiting{[&] {
        mailbox.wait(std::nullopt); // for mail
        read_all(mailbox.drain());
        mailbox.wait(std::nullopt); // for a call
        EXPECT_TRUE(mailbox.drain().empty());
    }};
    mailbox.try_push(note(read, 1));
    EXPECT_TRUE(wait_until([&] { return !mailbox.pending(); }));
    mailbox.wake();
    waiting.join();
    EXPECT_EQ(read, (std::vector{1}));
    mailbox.wait(Clock::time_point{}); // a time that has passed
}

} // namespace
} // namespace evod::runtime
