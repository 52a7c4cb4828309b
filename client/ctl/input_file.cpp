#include "client/ctl/input_file.h"

#include "client/ctl/stop.h"
#include "client/ctl/text.h"
#include "proto/files/input_file.h"

#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>

#include <sstream>
#include <utility>

namespace evod::ctl {
namespace {

/// The text of a choice: a string or a number.
std::string text_of(const boost::json::value& choice) {
    return choice.is_string()   ? std::string{choice.get_string()}
           : choice.is_double() ? number_text(choice.get_double())
                                : boost::json::serialize(choice);
}

} // namespace

std::string text_in(const std::string& path, std::string_view kind, std::size_t bytes_max) {
    auto text = files::read_input(path, kind, bytes_max);
    if (!text) {
        throw Stop{ExitCode::Usage, path + ": " + text.error().why};
    }
    return *std::move(text);
}

codec::Population population_in(const std::string& path, const v1::FreeGeneList& list) {
    std::istringstream file{text_in(path, "a population file", organisms_bytes_max)};
    auto population = codec::read_population(file, list);
    if (!population) {
        throw Stop{ExitCode::Usage, "the population file " + path + " is invalid: " + population.error().what};
    }
    return *std::move(population);
}

v1::FreeGeneList choices_in(const std::string& experiment_json) {
    v1::FreeGeneList list;
    boost::system::error_code error;
    const boost::json::value experiment = boost::json::parse(experiment_json, error);
    const auto* const genes = error ? nullptr : experiment.find_pointer("/free_genes", error);
    const auto* const entries = genes == nullptr ? nullptr : genes->if_array();
    for (std::size_t i = 0; entries != nullptr && i < entries->size(); ++i) {
        const auto* const entry = (*entries)[i].if_object();
        const auto* const choices = entry == nullptr ? nullptr : entry->if_contains("choices");
        if (choices == nullptr || !choices->is_array()) {
            continue;
        }
        const auto* const name = entry->if_contains("name");
        v1::FreeGene& gene = *list.add_genes();
        gene.set_name(name != nullptr && name->is_string() ? text_of(*name) : "free" + std::to_string(i));
        for (const boost::json::value& choice : choices->get_array()) {
            gene.add_choices(text_of(choice));
        }
    }
    return list;
}

} // namespace evod::ctl
