#include "client/viewer/world/status_text.h"

#include "client/core/duration.h"

#include <cctype>
#include <cmath>

namespace evod::viewer {

namespace {

/// Returns the field name without the name of its request: "fork_world.name" → "name".
std::string last_field_name(std::string_view field) {
    return std::string{field.substr(field.rfind('.') + 1)};
}

} // namespace

std::string capitalised(std::string text) {
    if (!text.empty()) {
        text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
    }
    return text;
}

std::string speed_text(double factor) {
    // Speeds below 1 are shown as fractions, because 1/8× is easier to read than 0.125×.
    const double inverse = factor > 0 ? 1 / factor : 0;
    return factor > 0 && factor < 1 && inverse == std::round(inverse) ? print("1/%g×", inverse)
                                                                      : shown_number(factor) + "×";
}

std::string speed_text(const evod::v1::Speed& speed) {
    return speed.max() ? "max" : speed_text(speed.real_time_factor());
}

std::string storage_text(const evod::v1::Storage& storage) {
    return capitalised(core::to_text(storage));
}

const char* state_text(evod::v1::RunState state, const evod::v1::Storage& storage, bool awaits_fitness) {
    return state == evod::v1::RUN_STATE_WAITING ? "waiting – Space runs" : state_word(state, storage, awaits_fitness);
}

const char* state_word(evod::v1::RunState state, const evod::v1::Storage& storage, bool awaits_fitness) {
    switch (state) {
    case evod::v1::RUN_STATE_WAITING:
        return "waiting";
    case evod::v1::RUN_STATE_RUNNING:
        return core::worlds_wait(storage) ? "waits for the disk" : awaits_fitness ? "waits for fitness" : "running";
    case evod::v1::RUN_STATE_PAUSED:
        return "paused";
    case evod::v1::RUN_STATE_TERMINATED:
        return "ended";
    default:
        return "…";
    }
}

std::string refusal_text(const evod::v1::Status& status) {
    std::string text = core::to_text(status, last_field_name);
    for (std::size_t end = 0, line = 0; (end = text.find("\n  ", end)) != std::string::npos; ++line) {
        text.replace(end, 3, line == 0 ? ": " : "; ");
    }
    return capitalised(std::move(text));
}

std::string connection_loss_text(const core::ConnectionStatus& status, bool has_token) {
    if (status.token_needed && !has_token) { // the server's message mentions options of evoctl
        return "The server requires a token: ask its administrator for one";
    }
    return status.refusal ? refusal_text(*status.refusal) : capitalised(status.reason);
}

std::string generation_title(const evod::v1::SnapshotFrame& snapshot) {
    return "Generation " + with_separators(snapshot.generation());
}

std::string replay_label(const evod::v1::Replay& replay) {
    return replay.replay_of().empty() ? "REPLAY" : "REPLAY of " + replay.replay_of();
}

std::string shown_text(const std::string& world, const evod::v1::Replay* replay,
                       const evod::v1::SnapshotFrame* snapshot) {
    if (replay == nullptr) {
        return "World " + world;
    }
    return "Replay of " + (replay->replay_of().empty() ? "a file" : replay->replay_of()) +
           (snapshot == nullptr ? "" : ", generation " + with_separators(snapshot->generation()));
}

std::string place_text(const std::string& world, const evod::v1::SnapshotFrame& snapshot) {
    std::string text = world;
    if (snapshot.island_count() > 1) {
        text += print(" · island %u of 0–%u", snapshot.island(), snapshot.island_count() - 1);
    }
    return text;
}

std::string place_and_speed_text(const std::string& world, const evod::v1::SnapshotFrame& snapshot,
                                 const RunControl& control) {
    std::string text = place_text(world, snapshot) + " · " + speed_text(control.speed());
    if (control.state() == evod::v1::RUN_STATE_RUNNING && snapshot.ticks_per_s() > 0) {
        text += " (" + with_separators(static_cast<std::uint64_t>(std::llround(snapshot.ticks_per_s()))) + " ticks/s)";
    }
    return text;
}

std::vector<std::string> statistics_texts(const evod::v1::SnapshotFrame& snapshot,
                                          const evod::v1::GenerationStatistics* last_generation) {
    const evod::v1::LiveStatistics& live = snapshot.live();
    std::vector<std::string> pieces{
        "alive " + with_separators(live.alive_count()) + " of " + with_separators(live.organism_count()),
        print("mean health %.1f", live.health_mean()),
        "food eaten " + with_separators(live.food_eaten()),
        "poison eaten " + with_separators(live.poison_eaten()),
        "tick " + with_separators(snapshot.tick()) + " (" + core::duration(snapshot.simulated_s()) + ")",
    };
    const bool has_predators = live.predator_count() + live.eaten_count() > 0 ||
                               (last_generation != nullptr && last_generation->has_predators());
    if (live.born_count() > 0) {
        pieces.insert(pieces.begin() + 1, "born " + with_separators(live.born_count()));
    }
    if (has_predators) {
        pieces.insert(pieces.begin() + 1, "predators " + with_separators(live.predator_count()) + ", prey eaten " +
                                              with_separators(live.eaten_count()));
    }
    if (last_generation != nullptr) {
        pieces.push_back(print("fitness of generation %llu: best %s, mean %s",
                               static_cast<unsigned long long>(last_generation->generation()),
                               shown_fitness(last_generation->fitness_best()).c_str(),
                               shown_fitness(last_generation->fitness_mean()).c_str()));
        if (last_generation->has_predators()) {
            pieces.push_back(print("of its predators: best %s, mean %s",
                                   shown_fitness(last_generation->predators().fitness_best()).c_str(),
                                   shown_fitness(last_generation->predators().fitness_mean()).c_str()));
        }
    }
    return pieces;
}

} // namespace evod::viewer
