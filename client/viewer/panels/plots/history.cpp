#include "client/viewer/panels/plots/history.h"

#include "client/core/change_text.h"

#include <algorithm>

namespace evod::viewer {

void History::set_run(const std::string& world, const std::string& run_id) {
    if (world == world_ && run_id == run_id_) {
        return;
    }
    world_ = world;
    run_id_ = run_id;
    table_.clear();
    changes_.clear();
    changes_until_ = whole_until_ = ended_ = 0;
    missing_ = true;
    cancel(); // any pending answer is about another run
    ++revision_;
}

void History::set_run(const evod::v1::WorldInfo& world) {
    set_run(world.name(), world.run_id());
    set_gene_names({world.gene_names().begin(), world.gene_names().end()});
}

void History::set_gene_names(const std::vector<std::string>& names) {
    if (!names.empty() && names != table_.gene_names()) {
        table_.set_gene_names(names);
    }
}

void History::apply_event(const evod::v1::Event& event) {
    using Kind = evod::v1::Event::KindCase;
    if (event.kind_case() == Kind::kEventsDropped) {
        refresh();
    }
    if (event.world() != world_ || world_.empty()) {
        return;
    }
    if (event.kind_case() == Kind::kWorldReset) {
        set_run(event.world_reset().world());
    } else if (event.kind_case() == Kind::kWorldCreated) {
        set_run(event.world_created().world());
    } else if (event.kind_case() == Kind::kParametersChanged) {
        refresh();
    } else if (event.kind_case() == Kind::kGenerationFinished && event.run_id() == run_id_) {
        add(event.generation_finished().statistics());
        if (!missing_) {
            whole_until_ = table_.last_without_gap(whole_until_);
            set_ended(table_.last_generation());
        }
    }
}

void History::set_ended(std::uint64_t generation) {
    ended_ = std::max(ended_, generation);
    missing_ = missing_ || ended_ > whole_until_;
}

std::optional<History::Query> History::next_query() {
    if (run_id_.empty() || !missing_ || asked_ != answered_) {
        return std::nullopt;
    }
    if (!next_page_) {
        next_page_ = std::min(whole_until_, changes_until_) + 1;
        ended_when_asked_ = std::max(ended_, table_.last_generation());
    }
    again_ = false;
    Query query{++asked_, {}};
    evod::v1::GetHistory& request = *query.request.mutable_get_history();
    request.set_world(world_);
    request.set_first_generation(*next_page_);
    return query;
}

void History::cancel() {
    answered_ = asked_;
    next_page_.reset();
}

void History::receive(std::uint64_t number, const evod::v1::History* answer) {
    if (number != asked_ || answered_ == asked_) {
        return; // the answer is about another run
    }
    if (answer == nullptr) {
        return cancel();
    }
    answered_ = asked_;
    add(answer->generations());
    add_changes(*next_page_, *answer);
    if (answer->has_next_generation() && answer->next_generation() > *next_page_) {
        next_page_ = answer->next_generation();
        return;
    }
    next_page_.reset();
    // If a generation had ended when the query began and is missing from the answer, the server no longer keeps it.
    if (!answer->generations().empty()) {
        ended_when_asked_ = std::max(ended_when_asked_, answer->generations().rbegin()->generation());
    }
    whole_until_ = table_.last_without_gap(std::max(whole_until_, ended_when_asked_));
    changes_until_ = whole_until_;
    missing_ = again_ || std::max(ended_, table_.last_generation()) > whole_until_;
}

template <class Generations>
void History::add(const Generations& generations) {
    std::vector<std::vector<double>> rows;
    for (const evod::v1::GenerationStatistics& statistics : generations) {
        rows.push_back(core::history_numbers(statistics));
    }
    if (!rows.empty()) {
        table_.add(rows);
        ++revision_;
    }
}

void History::add_changes(std::uint64_t first, const evod::v1::History& page) {
    const auto begin = std::ranges::lower_bound(changes_, static_cast<double>(first), {}, &Mark::x);
    changes_.erase(begin, changes_.end());
    for (const evod::v1::AppliedChange& change : page.changes()) {
        changes_.push_back({static_cast<double>(change.generation()), core::to_text(change)});
    }
}

} // namespace evod::viewer
