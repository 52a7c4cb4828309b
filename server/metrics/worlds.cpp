#include "server/metrics/worlds.h"

#include <algorithm>
#include <utility>

namespace evod::metrics {

std::shared_ptr<World> Worlds::add(std::string name) {
    auto world = std::make_shared<World>();
    world->name = std::move(name);
    const std::lock_guard lock{mutex_};
    std::erase_if(worlds_, [](const auto& weak) { return weak.expired(); });
    worlds_.push_back(world);
    return world;
}

std::vector<std::shared_ptr<const World>> Worlds::list() const {
    std::vector<std::shared_ptr<const World>> listed;
    {
        const std::lock_guard lock{mutex_};
        for (const auto& weak : worlds_) {
            if (auto world = weak.lock()) {
                listed.push_back(std::move(world));
            }
        }
    }
    std::ranges::sort(listed, {}, [](const auto& world) -> const std::string& { return world->name; });
    return listed;
}

void Worlds::set_damaged(std::vector<std::string> names) {
    std::ranges::sort(names);
    const std::lock_guard lock{mutex_};
    damaged_ = std::move(names);
}

std::vector<std::string> Worlds::damaged() const {
    const std::lock_guard lock{mutex_};
    return damaged_;
}

} // namespace evod::metrics
