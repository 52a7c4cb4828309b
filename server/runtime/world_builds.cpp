#include "server/runtime/world_builds.h"

#include "server/base/inline_executor.h"
#include "server/base/within_memory.h"

#include <algorithm>
#include <utility>

namespace evod::runtime {

base::Result<BuiltWorld> WorldBuilds::build(const Order& order, base::Executor& executor,
                                            const std::function<void()>& has_read) {
    return base::within_memory([&]() -> base::Result<BuiltWorld> {
        simulation::World world = order.construction.construct(executor);
        has_read();
        return order.finish(std::move(world), executor);
    });
}

void WorldBuilds::begin(Order order) {
    if (order.at_once || order.construction.is_shared || order.construction.genes <= genes_built_at_once_max) {
        return order.adopt(build(order, executor_, [] {}));
    }
    const std::uint64_t number = ++last_number_;
    builds_.emplace(number, Build{order.name, order.original, std::exchange(order.adopt, {})});
    const std::string user = order.user;
    jobs_.add(
        [&mailbox = mailbox_, number, order = std::move(order)](const std::stop_token&) {
            base::InlineExecutor executor; // the threads of the pool belong to the worlds that advance
            auto world = build(order, executor, [&] { mailbox.push(WorldBuilt{number, nullptr}); });
            mailbox.push(WorldBuilt{number, std::make_shared<base::Result<BuiltWorld>>(std::move(world))});
        },
        user);
}

bool WorldBuilds::holds(std::string_view world) const {
    return std::ranges::any_of(builds_, [&](const auto& item) {
        return world.empty() || world == item.second.name || world == item.second.original;
    });
}

void WorldBuilds::take(const WorldBuilt& mail) {
    const auto found = builds_.find(mail.build);
    if (!mail.world) {
        return found->second.original.clear();
    }
    const auto adopt = std::move(found->second.adopt);
    builds_.erase(found);
    adopt(std::move(*mail.world));
}

} // namespace evod::runtime
