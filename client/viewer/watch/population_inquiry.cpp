#include "client/viewer/watch/population_inquiry.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

bool PopulationInquiry::update(Watch& watch, const Of& of, bool wanted, Clock::time_point now) {
    if (of != of_) {
        of_ = of;
        inquiry_.forget();
        whole_.reset();
        unreadable_.clear();
        begin_anew();
    }
    if (!inquiry_.due(watch, now)) {
        return false;
    }
    if (inquiry_.under_way()) { // and never answered
        begin_anew();
    }
    const bool first_page = coming_.next() == 0;
    if (first_page && !wanted) {
        return false;
    }
    if (first_page) {
        begun_ = Clock::now();
    }
    evod::v1::Request request;
    request.mutable_get_population()->set_world(of_.world);
    request.mutable_get_population()->set_island(of_.island);
    request.mutable_get_population()->set_first_organism(coming_.next());
    inquiry_.ask(watch, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            take(response->population());
        } else {
            begin_anew();
        }
    });
    return first_page;
}

void PopulationInquiry::take(const evod::v1::Population& page) {
    const bool ended = coming_.next() > 0 && page.generation() != coming_.generation();
    const auto wrong = ended ? std::nullopt : coming_.add(page);
    unreadable_ = wrong ? "The server's answer cannot be read: " + *wrong : "";
    if (wrong) {
        begin_anew();
        return inquiry_.wait(Inquiry::after_refusal);
    }
    if (!ended && !coming_.whole()) {
        return inquiry_.hurry(); // the next page
    }
    if (!ended) {
        whole_ = std::move(coming_);
        ++whole_count_;
    }
    begin_anew();
    inquiry_.wait(std::max<Clock::duration>(pause_, 4 * (Clock::now() - begun_)));
}

std::string PopulationInquiry::trouble() const {
    return inquiry_.is_unknown()        ? "This server does not tell of genes, lineages and forces; a newer one does"
           : inquiry_.trouble().empty() ? unreadable_
                                        : inquiry_.trouble();
}

} // namespace evod::viewer
