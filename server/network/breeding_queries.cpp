#include "server/network/breeding_queries.h"

#include "server/base/within_memory.h"
#include "server/protocol/breeding.h"
#include "server/protocol/refusals.h"
#include "server/replay/breeding.h"
#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <utility>

namespace evod::network {
namespace {

// A generous estimate of the size of an answer.
constexpr std::ptrdiff_t answer_bytes = 2 << 20;

base::Result<replay::Bred> breeding_of(const v1::GetBreeding& request, const runtime::FoundRun& run,
                                       const std::stop_token& stop) {
    const auto file = run.run.open();
    if (!file) {
        return file.error();
    }
    if (auto held = (*file)->pin_snapshot(); !held) {
        return held.error();
    }
    replay::WantedBreeding wanted{.generation = {},
                                  .seen_from = run.generation,
                                  .island = request.island(),
                                  .rows = protocol::wanted_rows(request)};
    if (request.has_generation()) {
        wanted.generation = request.generation();
    }
    const auto executor = runtime::make_executor(1);
    return replay::breeding_of(**file, wanted, *executor, stop);
}

/// Whether the answer omits rows because of a limit.
bool is_shortened(const v1::GetBreeding& request, const v1::Breeding& answer) {
    const auto more = [](std::uint64_t first, int rows, std::uint32_t count) {
        return first + static_cast<std::uint64_t>(rows) < count;
    };
    return more(request.first_contender(), answer.contenders_size(), answer.contender_count()) ||
           more(request.first_pick(), answer.picks_size(), answer.pick_count()) ||
           more(request.first_descendant(), answer.descendants_size(), answer.descendant_count());
}

} // namespace

void BreedingQueries::ask(Session& session, std::uint64_t request_id, const v1::GetBreeding& request,
                          runtime::FoundRun run) {
    waiting_.push_back({session.number(), session.weak_from_this(), request_id, request, std::move(run)});
    begin_next();
}

void BreedingQueries::begin_next() {
    while (under_way_.size() < at_once) {
        const auto next = std::ranges::find_if(waiting_, [&](const Asked& asked) {
            return std::ranges::find(under_way_, asked.session, &Work::session) == under_way_.end();
        });
        if (next == waiting_.end()) {
            return;
        }
        Asked asked = std::move(*next);
        waiting_.erase(next);
        begin(std::move(asked));
    }
}

void BreedingQueries::begin(Asked asked) {
    if (const auto asking = asked.asking.lock()) {
        asking->expect(answer_bytes);
    }
    under_way_.push_back({asked.session, {}});
    const auto work = std::prev(under_way_.end());
    work->stop = jobs_.add([this, work, asked = std::move(asked)](const std::stop_token& stop) {
        outbox_.answer([this, work, asked, response = response_to(asked, stop)]() mutable {
            if (const auto asking = asked.asking.lock()) {
                asking->expect(-answer_bytes);
                if (is_shortened(asked.request, response.breeding())) {
                    limit_counters_.met(Limit::BreedingRows);
                }
                asking->answer(std::move(response));
            }
            under_way_.erase(work);
            begin_next();
        });
    });
}

v1::Response BreedingQueries::response_to(const Asked& asked, const std::stop_token& stop) {
    const auto bred = base::within_memory([&] { return breeding_of(asked.request, asked.run, stop); });
    if (!bred) {
        return protocol::refusing(asked.request_id, protocol::with_paths(bred.error(), "get_breeding"));
    }
    v1::Response response;
    response.set_request_id(asked.request_id);
    *response.mutable_breeding() = protocol::to_proto(bred->record, bred->parameters);
    response.mutable_breeding()->set_generation(bred->generation);
    response.mutable_breeding()->set_island(bred->island);
    return response;
}

void BreedingQueries::forget(const Session& session) {
    std::erase_if(waiting_, [&](const Asked& asked) { return asked.session == session.number(); });
    for (Work& work : under_way_) {
        if (work.session == session.number()) {
            work.stop.request_stop();
        }
    }
}

} // namespace evod::network
