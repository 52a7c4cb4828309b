#include "client/viewer/world/whole_population.h"

#include "proto/codec/population_csv.h"

#include <utility>

namespace evod::viewer {

namespace {

core::Error failed(std::string what) {
    return {.kind = core::Error::Kind::Usage, .what = std::move(what)};
}

/// Returns the genes organism by organism.
std::vector<float> rows_of(const Population& population) {
    std::vector<float> rows;
    for (std::uint32_t id = 0; id < population.size(); ++id) {
        for (std::size_t gene = 0; gene < population.gene_count(); ++gene) {
            rows.push_back(population.gene(gene)[id]);
        }
    }
    return rows;
}

} // namespace

void WholePopulation::request(ViewedWorld& world, Handler handler) {
    state_ = std::make_shared<State>();
    state_->island_count = world.feed.island_count();
    state_->genes.world = world.feed.name();
    state_->genes.population.gene_names = world.feed.gene_names();
    state_->handler = std::move(handler);
    state_->page = Population{state_->genes.population.gene_names.size()};
    send(world, state_);
}

void WholePopulation::send(ViewedWorld& world, const std::shared_ptr<State>& state) {
    evod::v1::Request request;
    auto& query = *request.mutable_get_population();
    query.set_world(state->genes.world);
    query.set_island(static_cast<std::uint32_t>(state->genes.population.islands.size()));
    query.set_first_organism(state->page.next());
    world.server.send(std::move(request),
                      [&world, weak = std::weak_ptr{state}](const core::Result<evod::v1::Response>& response) {
                          const auto state = weak.lock();
                          if (!state) {
                              return;
                          }
                          if (std::string refusal = refusal_of(response); !refusal.empty()) {
                              state->handler(failed(std::move(refusal)));
                          } else {
                              take(world, state, response->population());
                          }
                      });
}

void WholePopulation::take(ViewedWorld& world, const std::shared_ptr<State>& state, const evod::v1::Population& page) {
    const bool first = state->genes.population.islands.empty() && state->page.next() == 0;
    if (!first && (page.generation() != state->genes.generation || state->page.is_outdated_by(page))) {
        if (++state->attempt > attempts_max) {
            state->handler(failed("The generations are too short to read a whole one: pause the world first"));
            return;
        }
        state->genes.population.islands.clear();
        state->page = Population{state->genes.population.gene_names.size()};
        return send(world, state);
    }
    state->genes.generation = page.generation();
    if (const auto wrong = state->page.add(page)) {
        state->handler(failed("The server's answer is invalid: " + *wrong));
        return;
    }
    if (state->page.complete()) {
        state->genes.population.islands.push_back(rows_of(state->page));
        state->page = Population{state->genes.population.gene_names.size()};
    }
    if (state->genes.population.islands.size() < state->island_count) {
        send(world, state);
    } else {
        state->handler(std::move(state->genes));
    }
}

} // namespace evod::viewer
