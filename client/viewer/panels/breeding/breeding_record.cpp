#include "client/viewer/panels/breeding/breeding_record.h"

#include <algorithm>

namespace evod::viewer {

namespace {

/// Number of rows to request beyond the row shown, so that playing does not wait for the server.
constexpr std::uint32_t rows_ahead = 64;

template <class Rows>
const typename Rows::value_type* row(const Rows& rows, std::uint32_t index) {
    return index < static_cast<std::uint32_t>(rows.size()) ? &rows.Get(static_cast<int>(index)) : nullptr;
}

/// Appends the rows of `page` until the list has `count` or rows_kept_max rows. Returns whether any row was added.
template <class Rows>
bool append(Rows& have, const Rows& page, std::uint32_t count) {
    const auto kept = static_cast<int>(std::min(count, BreedingRecord::rows_kept_max));
    const int added = std::min(page.size(), kept - have.size());
    have.Reserve(have.size() + std::max(added, 0));
    for (int i = 0; i < added; ++i) {
        *have.Add() = page.Get(i);
    }
    return added > 0;
}

} // namespace

std::optional<evod::v1::GetBreeding> BreedingRecord::wanted(Moment moment) const {
    evod::v1::GetBreeding request;
    request.set_world(key_.world);
    request.set_island(key_.island);
    request.set_generation(key_.generation);
    if (!known_) {
        return request;
    }
    if (no_new_row_) {
        return std::nullopt;
    }
    bool any = false;
    // A request always names a first row for every list. To receive no rows of a list, it names the end of that list.
    const auto first_of = [&any](std::uint32_t have, std::uint32_t shown, std::uint32_t count) {
        if (have >= std::min({shown, count, rows_kept_max})) {
            return count;
        }
        any = true;
        return have;
    };
    const bool picking = moment.stage == BreedingStage::Picking, breeding = moment.stage == BreedingStage::Breeding;
    request.set_first_contender(first_of(static_cast<std::uint32_t>(known_->contenders_size()),
                                         known_->contender_count(), known_->contender_count()));
    request.set_first_pick(first_of(static_cast<std::uint32_t>(known_->picks_size()),
                                    picking ? moment.index + rows_ahead : 0, known_->pick_count()));
    request.set_first_descendant(first_of(static_cast<std::uint32_t>(known_->descendants_size()),
                                          breeding ? moment.index + rows_ahead : 0, known_->descendant_count()));
    return any ? std::optional{request} : std::nullopt;
}

void BreedingRecord::add(const evod::v1::Breeding& page) {
    if (page.generation() != key_.generation || page.island() != key_.island) {
        return;
    }
    if (!known_) {
        known_ = page;
        known_->clear_contenders();
        known_->clear_picks();
        known_->clear_descendants();
    }
    bool any = append(*known_->mutable_contenders(), page.contenders(), known_->contender_count());
    any = append(*known_->mutable_picks(), page.picks(), known_->pick_count()) || any;
    any = append(*known_->mutable_descendants(), page.descendants(), known_->descendant_count()) || any;
    no_new_row_ = !any;
}

const evod::v1::Contender* BreedingRecord::contender(std::uint32_t organism) const {
    return known_ ? row(known_->contenders(), organism) : nullptr;
}

const evod::v1::Pick* BreedingRecord::pick(std::uint32_t index) const {
    return known_ ? row(known_->picks(), index) : nullptr;
}

const evod::v1::Descendant* BreedingRecord::descendant(std::uint32_t id) const {
    return known_ ? row(known_->descendants(), id) : nullptr;
}

std::uint32_t BreedingRecord::pick_count() const {
    return known_ ? std::min(known_->pick_count(), rows_kept_max) : 0;
}

std::uint32_t BreedingRecord::descendant_count() const {
    return known_ ? std::min(known_->descendant_count(), rows_kept_max) : 0;
}

const evod::v1::ParameterValue* BreedingRecord::parameter(const char* name) const {
    if (!known_) {
        return nullptr;
    }
    const auto found = std::ranges::find(known_->parameters(), name, &evod::v1::ParameterAssignment::name);
    return found == known_->parameters().end() ? nullptr : &found->value();
}

std::string BreedingRecord::choice(const char* name) const {
    const evod::v1::ParameterValue* value = parameter(name);
    return value != nullptr ? value->choice() : "";
}

std::optional<double> BreedingRecord::number(const char* name) const {
    const evod::v1::ParameterValue* value = parameter(name);
    if (value == nullptr) {
        return std::nullopt;
    }
    switch (value->kind_case()) {
    case evod::v1::ParameterValue::kReal:
        return value->real();
    case evod::v1::ParameterValue::kCount:
        return value->count();
    case evod::v1::ParameterValue::kFlag:
        return value->flag() ? 1 : 0;
    default:
        return std::nullopt;
    }
}

} // namespace evod::viewer
