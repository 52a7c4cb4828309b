#include "client/viewer/world/families.h"

#include <algorithm>
#include <unordered_map>

namespace evod::viewer {

Families::Families(std::span<const std::uint32_t> founders) {
    std::unordered_map<std::uint32_t, std::size_t> sizes;
    for (const std::uint32_t founder : founders) {
        if (founder != unknown) {
            ++sizes[founder];
            ++size_;
        }
    }
    for (const auto& [founder, size] : sizes) {
        shown_.push_back({founder, size});
    }
    std::ranges::sort(shown_, [](const Family& a, const Family& b) {
        return a.size != b.size ? a.size > b.size : a.founder < b.founder;
    });
    count_ = shown_.size();
    shown_.resize(std::min(count_, shown_max));
    std::unordered_map<std::uint32_t, std::uint8_t> places;
    for (std::size_t i = 0; i < shown_.size(); ++i) {
        places[shown_[i].founder] = static_cast<std::uint8_t>(i);
    }
    of_.reserve(founders.size());
    for (const std::uint32_t founder : founders) {
        const auto place = places.find(founder);
        of_.push_back(place == places.end() ? none : place->second);
    }
}

} // namespace evod::viewer
