#include "client/viewer/world/lineage_poll.h"

#include <algorithm>
#include <utility>

namespace evod::viewer {

void LineagePoll::update(ViewedWorld& world, bool wanted, Clock::time_point now) {
    const codec::ReceivedSnapshot* snapshot = world.feed.snapshot();
    if (snapshot == nullptr) {
        return;
    }
    if (std::exchange(place_, world.feed.place_number()) != world.feed.place_number()) {
        export_id_ = 0; // the server ends the export of a replay that is closed
        poll_.reset();
    }
    if (run_id_ != snapshot->about.run_id()) {
        run_id_ = snapshot->about.run_id();
        lineage_ = {};
        unreadable_.clear();
        export_id_ = 0;
        poll_.reset();
    }
    if (!wanted && poll_.is_unsupported()) {
        poll_.reset(); // the next time that the lineage is wanted, it is requested again
    }
    if (!poll_.due(world, now) || poll_.is_unsupported()) {
        return;
    }
    if (poll_.pending()) { // the request has timed out
        export_id_ = 0;
    }
    if (export_id_ != 0) {
        evod::v1::Request request;
        request.mutable_continue_export()->set_export_id(export_id_);
        return poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
            export_id_ = 0;
            if (response != nullptr) {
                take(response->export_part());
            }
        });
    }
    const std::uint64_t shown = snapshot->about.generation();
    const std::uint64_t newest =
        world.feed.replay() != nullptr ? std::max(shown, world.feed.replay()->last_generation()) : shown;
    if (wanted && (lineage_.empty() || lineage_.last() < newest)) {
        begin(world, newest, now);
    }
}

void LineagePoll::begin(ViewedWorld& world, std::uint64_t newest, Clock::time_point now) {
    const auto& about = world.feed.snapshot()->about;
    const std::uint64_t organisms =
        std::max<std::uint64_t>(1, std::uint64_t{about.live().organism_count()} * std::max(about.island_count(), 1u));
    const std::uint64_t generations = std::clamp<std::uint64_t>(Lineage::organisms_max / organisms, 2, generations_max);
    evod::v1::Request request;
    request.mutable_export_run()->set_world(world.feed.world());
    request.mutable_export_run()->set_table(evod::v1::RUN_TABLE_LINEAGE);
    request.mutable_export_run()->set_format(evod::v1::TEXT_FORMAT_CSV);
    // The last known generation is requested again, because its fitness was unknown before it ended.
    request.mutable_export_run()->set_first_generation(lineage_.empty() ? newest - std::min(newest, generations) + 1
                                                                        : lineage_.last());
    lineage_.begin_table();
    known_before_ = lineage_.version();
    begun_ = Clock::now();
    poll_.send(world, std::move(request), now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            take(response->export_part());
        }
    });
}

void LineagePoll::take(const evod::v1::ExportPart& part) {
    auto wrong = lineage_.add(part.text());
    if (!part.last() && part.export_id() == 0) {
        wrong = "export_part.export_id is 0";
    }
    unreadable_ = wrong ? "The server's answer is invalid: " + *wrong : "";
    if (wrong) {
        return poll_.wait(Poll::after_refusal);
    }
    if (!part.last()) {
        export_id_ = part.export_id();
        return poll_.make_due(); // request the next part at once
    }
    lineage_.end_table();
    const bool nothing_new = lineage_.version() == known_before_;
    poll_.wait(std::max<Clock::duration>(nothing_new ? Clock::duration{Poll::after_refusal} : interval,
                                         4 * (Clock::now() - begun_)));
}

} // namespace evod::viewer
