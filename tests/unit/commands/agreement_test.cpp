#include "server/commands/agreement.h"
#include "tests/support/threaded_exchange.h"

#include <gmock/gmock.h>

#include <functional>
#include <string>
#include <vector>

namespace evod::commands {
namespace {

using base::RefusalCode;
using base::Result;
using testing::AllOf;
using testing::HasSubstr;

/// One of several processes, which a thread plays.
class Played final : public runtime::Processes {
  public:
    explicit Played(base::Exchange& exchange) : exchange_{exchange} {}
    std::uint32_t rank() const override { return exchange_.rank(); }
    std::uint32_t size() const override { return exchange_.size(); }
    std::vector<std::string> gather(std::string part) override { return exchange_.gather(std::move(part)); }
    std::vector<std::string> swap(std::vector<std::string> parts) override { return exchange_.swap(std::move(parts)); }
    std::string broadcast(std::string from_first) override { return exchange_.broadcast(std::move(from_first)); }
    std::uint32_t on_this_machine() const override { return size(); }
    std::string name_of(std::uint32_t rank) const override { return "rank " + std::to_string(rank) + " on node"; }
    double exchange_s() const override { return 0; }

  private:
    base::Exchange& exchange_;
};

/// What agree() returns in each process, as text; "" means that they agree.
std::vector<std::string> agreed(const std::vector<Result<std::string>>& read) {
    const auto size = static_cast<std::uint32_t>(read.size());
    std::vector<std::string> results(size);
    support::ThreadedExchange{size}.run([&](base::Exchange& exchange) {
        Played processes{exchange};
        const Result<void> result = agree(read[exchange.rank()], processes);
        results[exchange.rank()] = result ? "" : base::to_text(result.error());
    });
    return results;
}

TEST(Agreement, ProcessesThatReadTheSameAgree) {
    EXPECT_THAT(agreed({"text", "text", "text"}), testing::Each(""));
}

TEST(Agreement, NamesTheFirstProcessThatReadSomethingElse) {
    EXPECT_THAT(agreed({"text", "text", "another text", "a third one"}),
                testing::Each(AllOf(HasSubstr("rank 2 on node has read other files"), HasSubstr("rank 0 on node"))));
}

TEST(Agreement, AllProcessesGetARefusalOfOne) {
    EXPECT_THAT(agreed({"text", refusal(RefusalCode::NotFound, "no such file"), "another text"}),
                testing::Each(HasSubstr("rank 1 on node: no such file")));
}

TEST(Agreement, KeepsTheCodeOfARefusal) {
    support::ThreadedExchange{2}.run([](base::Exchange& exchange) {
        Played processes{exchange};
        const auto mine = exchange.rank() == 1 ? Result<std::string>{refusal(RefusalCode::InvalidArgument, "got 7")}
                                               : Result<std::string>{"text"};
        const Result<void> result = agree(mine, processes);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().code, RefusalCode::InvalidArgument);
    });
}

TEST(Agreement, AProcessThatIsAloneGetsItsOwnRefusal) {
    support::ThreadedExchange{1}.run([](base::Exchange& exchange) {
        Played alone{exchange};
        EXPECT_TRUE(agree(Result<std::string>{"text"}, alone));
        const Result<void> result = agree(refusal(RefusalCode::NotFound, "no such file"), alone);
        ASSERT_FALSE(result);
        EXPECT_EQ(result.error().message, "no such file");
    });
}

TEST(Agreement, AnyLooksAtAllProcesses) {
    for (const std::uint32_t chosen : {0U, 2U, 3U}) { // 3: none of them
        support::ThreadedExchange{3}.run([&](base::Exchange& exchange) {
            Played processes{exchange};
            EXPECT_EQ(any(exchange.rank() == chosen, processes), chosen < 3);
        });
    }
}

} // namespace
} // namespace evod::commands
