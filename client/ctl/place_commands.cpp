// Commands that change a running world: place and remove food, poison and organisms.
#include "client/ctl/caller.h"
#include "client/ctl/input_file.h"
#include "client/ctl/text.h"
#include "proto/codec/population_csv.h"
#include "proto/command_line/command.h"

#include <charconv>
#include <optional>
#include <string>
#include <vector>

namespace evod::ctl {

namespace {

const std::vector<std::string> kinds = {"food", "poison", "organism"};

struct Position {
    double x_px, y_px;
};

/// Parses "100,200.5".
std::optional<Position> parse_position(const std::string& word) {
    Position position{};
    const char* const end = word.data() + word.size();
    const auto x = std::from_chars(word.data(), end, position.x_px);
    if (x.ec != std::errc{} || x.ptr == end || *x.ptr != ',') {
        return std::nullopt;
    }
    const auto y = std::from_chars(x.ptr + 1, end, position.y_px);
    return y.ec == std::errc{} && y.ptr == end ? std::optional{position} : std::nullopt;
}

std::string check_position(const std::string& word) {
    return parse_position(word) ? "" : "got " + word + ", allowed X,Y in px, such as 100,200";
}

using Genes = std::vector<float>;

std::vector<Genes> genes_in(const std::string& path, const v1::FreeGeneList& list) {
    std::vector<Genes> organisms;
    const codec::Population population = population_in(path, list);
    const auto gene_count = static_cast<std::ptrdiff_t>(population.gene_names.size());
    for (const std::vector<float>& genes : population.islands) {
        for (auto begin = genes.begin(); begin != genes.end(); begin += gene_count) {
            organisms.emplace_back(begin, begin + gene_count);
        }
    }
    return organisms;
}

struct PlaceOptions {
    std::string kind, file;
    std::vector<std::string> positions;
    std::uint32_t island = 0;
    std::optional<std::uint32_t> copy;
};

/// Returns the genes of each organism to place, or of one for all places.
std::vector<Genes> genes_of(Caller& caller, const Common& common, const PlaceOptions& options) {
    if (options.copy) {
        v1::Request request;
        request.mutable_get_organism()->set_world(common.world);
        request.mutable_get_organism()->set_island(options.island);
        request.mutable_get_organism()->set_organism(*options.copy);
        const v1::OrganismInfo organism = caller.call(std::move(request)).organism();
        return {{organism.genes().begin(), organism.genes().end()}};
    }
    std::vector<Genes> organisms = genes_in(options.file, caller.world(common.world).free_genes());
    if (organisms.size() != 1 && organisms.size() < options.positions.size()) {
        throw Stop{ExitCode::Usage, "the population file " + options.file + " contains " +
                                        std::to_string(organisms.size()) + " organisms, too few for " +
                                        std::to_string(options.positions.size()) + " places"};
    }
    return organisms;
}

/// Returns a sentence such as "placed food 3, 4 on island 0, from tick 120".
template <class Ids>
std::string sentence_of(const char* verb, const Ids& ids, const v1::Response& response) {
    std::string text = verb;
    bool first = true;
    for (const auto& [kind, list] : {std::pair{"food", &ids.food()}, std::pair{"poison", &ids.poison()},
                                     std::pair{"organism", &ids.organisms()}}) {
        for (int i = 0; i < list->size(); ++i) {
            text += (i > 0 ? ", " : std::string{first ? " " : ", "} + kind + " ") + std::to_string(list->Get(i));
            first = false;
        }
    }
    return text + (std::string{" on island "} + std::to_string(ids.island()) + ", generation ") +
           std::to_string(ids.generation()) + ", from tick " + std::to_string(response.applied_tick()) + "\n";
}

void need_place(const Caller& caller) {
    caller.need("place", "place or remove items and organisms");
}

void place(const Common& common, const PlaceOptions& options) {
    if ((options.kind == "organism") != (options.copy || !options.file.empty())) {
        throw Stop{ExitCode::Usage, options.kind == "organism" ? "place organism: give --from FILE or --copy ID"
                                                               : "--from and --copy are for organisms only"};
    }
    Caller caller{common};
    need_place(caller);
    v1::Request request;
    v1::Place& command = *request.mutable_place();
    command.set_world(common.world);
    command.set_island(options.island);
    const std::vector<Genes> organisms =
        options.kind == "organism" ? genes_of(caller, common, options) : std::vector<Genes>{};
    for (std::size_t i = 0; i < options.positions.size(); ++i) {
        const Position position = *parse_position(options.positions[i]);
        if (organisms.empty()) {
            v1::PlacedItem& item = *command.add_items();
            item.set_kind(options.kind == "food" ? v1::ITEM_KIND_FOOD : v1::ITEM_KIND_POISON);
            item.set_x_px(position.x_px);
            item.set_y_px(position.y_px);
            continue;
        }
        v1::PlacedOrganism& organism = *command.add_organisms();
        organism.set_x_px(position.x_px);
        organism.set_y_px(position.y_px);
        const Genes& genes = organisms[organisms.size() == 1 ? 0 : i];
        organism.mutable_genes()->Add(genes.begin(), genes.end());
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return sentence_of("placed", response.placed(), response); });
}

struct RemoveOptions {
    std::string kind;
    std::vector<std::string> ids;
    std::uint32_t island = 0;
    std::optional<std::uint64_t> generation;
};

void remove(const Common& common, const RemoveOptions& options) {
    Caller caller{common};
    need_place(caller);
    v1::Request request;
    v1::Remove& command = *request.mutable_remove();
    command.set_world(common.world);
    command.set_island(options.island);
    if (options.generation) {
        command.set_generation(*options.generation);
    }
    auto& ids = *(options.kind == "food"     ? command.mutable_food()
                  : options.kind == "poison" ? command.mutable_poison()
                                             : command.mutable_organisms());
    for (const std::string& word : options.ids) {
        std::uint32_t id = 0;
        (void)std::from_chars(word.data(), word.data() + word.size(), id); // index_number has accepted the word
        ids.Add(id);
    }
    const v1::Response response = caller.call(std::move(request));
    print(common, response, [&] { return sentence_of("removed", response.removed(), response); });
}

} // namespace

void add_place_commands(command_line::Command& app, const Common& common) {
    const char* const group = "Change";
    auto& place_command =
        app.add_command("place", "Place food, poison or organisms in the current generation").group(group);
    auto& placed = place_command.keep(PlaceOptions{});
    place_command.add_option("KIND", &placed.kind, "What to place").choices(kinds).required();
    place_command.add_option("PLACE", &placed.positions, "Places X,Y in px from the upper left corner, such as 100,200")
        .check(check_position)
        .count(1, 1000)
        .required();
    place_command.add_option("--island", &placed.island, "Island, numbered from 0").check(index_number);
    auto from = place_command.add_option(
        "--from", &placed.file,
        "Population CSV file, as `evoctl export --what population` writes it; its organisms go to the places in order, "
        "and a single organism to all of them");
    place_command.add_option("--copy", &placed.copy, "Place copies of this organism of the island")
        .check(index_number)
        .excludes(from);
    place_command.footer("Placed items do not reappear after they were eaten. Placed organisms breed like the others.\n"
                         "Examples:\n  evoctl place food 100,200 300,250.5\n"
                         "  evoctl place organism 100,200 --copy 12\n"
                         "  evoctl place organism 100,200 --from best.csv --island 1");
    place_command.action([&] { place(common, placed); });

    auto& remove_command =
        app.add_command("remove", "Remove food, poison or organisms from the current generation").group(group);
    auto& removed = remove_command.keep(RemoveOptions{});
    remove_command.add_option("KIND", &removed.kind, "What to remove").choices(kinds).required();
    remove_command.add_option("ID", &removed.ids, "Numbers of the items or organisms, from 0")
        .check(index_number)
        .count(1, 1000)
        .required();
    remove_command.add_option("--island", &removed.island, "Island, numbered from 0").check(index_number);
    remove_command
        .add_option("--generation", &removed.generation,
                    "Generation to which the numbers belong; refused if it is not the current one")
        .check(at_least_one);
    remove_command.footer("Examples:\n  evoctl remove organism 12\n  evoctl remove food 3 4 --generation 7");
    remove_command.action([&] { remove(common, removed); });
}

} // namespace evod::ctl
