#include "server/runtime/mailbox.h"

#include "tests/support/waiting.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <vector>

namespace evod::runtime {
namespace {

Mail note(const char* text) {
    return CommandMail{.command = {}, .origin = {}, .request_name = text};
}

std::vector<std::string> texts_of(const std::vector<Mail>& mail) {
    std::vector<std::string> texts;
    for (const Mail& one : mail) {
        texts.push_back(std::get<CommandMail>(one).request_name);
    }
    return texts;
}

TEST(Mailbox, ReturnsMailInOrder) {
    Mailbox mailbox;
    EXPECT_FALSE(mailbox.pending());
    for (const char* text : {"first", "second", "third"}) {
        EXPECT_TRUE(mailbox.try_push(note(text), ""));
    }
    EXPECT_TRUE(mailbox.pending());
    EXPECT_EQ(texts_of(mailbox.drain()), (std::vector<std::string>{"first", "second", "third"}));
    EXPECT_FALSE(mailbox.pending());
    EXPECT_TRUE(mailbox.drain().empty());
}

TEST(Mailbox, RefusesMailBeyondItsCapacity) {
    Mailbox mailbox{2};
    EXPECT_TRUE(mailbox.try_push(note("first"), "ada"));
    EXPECT_TRUE(mailbox.try_push(note("second"), "bob"));
    Mail third = note("third");
    EXPECT_FALSE(mailbox.try_push(std::move(third), ""));
    EXPECT_EQ(std::get<CommandMail>(third).request_name, "third") << "refused mail is unchanged";
    EXPECT_EQ(texts_of(mailbox.drain()), (std::vector<std::string>{"first", "second"}));
    EXPECT_TRUE(mailbox.try_push(std::move(third), ""));
    EXPECT_EQ(texts_of(mailbox.drain()), std::vector<std::string>{"third"});
}

TEST(Mailbox, AUserHasAtMostHalfOfThePlaces) {
    Mailbox mailbox{4};
    EXPECT_TRUE(mailbox.try_push(note("first"), "eve"));
    EXPECT_TRUE(mailbox.try_push(note("second"), "eve"));
    EXPECT_FALSE(mailbox.try_push(note("third"), "eve"));
    EXPECT_TRUE(mailbox.try_push(note("third"), "ada"));
    EXPECT_EQ(mailbox.places().held("eve"), 2u);
    mailbox.push(note("of the server"));
    EXPECT_EQ(mailbox.places().held(), 3u);
    EXPECT_EQ(mailbox.drain().size(), 4u);
    EXPECT_EQ(mailbox.places().held(), 0u);
    EXPECT_TRUE(mailbox.try_push(note("fourth"), "eve"));
}

TEST(Mailbox, WakesTheWaitingThread) {
    Mailbox mailbox;
    std::vector<std::string> read;
    std::thread waiting{[&] {
        mailbox.wait(std::nullopt); // for mail
        read = texts_of(mailbox.drain());
        mailbox.wait(std::nullopt); // for a call
        EXPECT_TRUE(mailbox.drain().empty());
    }};
    mailbox.try_push(note("mail"), "");
    EXPECT_TRUE(wait_until([&] { return !mailbox.pending(); }));
    mailbox.wake();
    waiting.join();
    EXPECT_EQ(read, std::vector<std::string>{"mail"});
    mailbox.wait(Clock::time_point{}); // a time that has passed
}

} // namespace
} // namespace evod::runtime
