#include "server/parameters/gene_list.h"

#include "proto/text/number_text.h"
#include "server/evolution/gene_layout.h"

#include <boost/json/serialize.hpp>
#include <boost/json/string.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace evod::parameters {
namespace {

using base::Violation;
using evolution::FreeGene;
using text::number_text;

constexpr double whole_max = 1 << 24; // float32 contains all whole numbers up to here
constexpr double bound_max = 1e12;
constexpr std::uint32_t listed_genes_max = 1000;

bool is_name(std::string_view text) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    return !text.empty() && text.size() <= 60 && is_letter(text.front()) &&
           std::ranges::all_of(text, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

std::string quoted(std::string_view text) {
    return boost::json::serialize(boost::json::string{text});
}

/// Checks one gene after another.
class Checker {
  public:
    Checker(std::string_view field, std::vector<Violation>& violations) : list_{field}, violations_{violations} {}

    void check(const FreeGene& gene, std::size_t index) {
        field_ = std::string{list_} + "[" + std::to_string(index) + "]";
        check_name(gene);
        switch (gene.kind) {
        case FreeGene::Kind::Number:
            check_number(gene);
            break;
        case FreeGene::Kind::Choice:
            if (gene.choices.size() < 2 || gene.choices.size() > 1000) {
                refuse(".choices", "2 to 1000 choices", std::to_string(gene.choices.size()));
            } else if (std::set(gene.choices.begin(), gene.choices.end()).size() != gene.choices.size()) {
                refuse(".choices", "choices that are all different", "one of them twice");
            }
            break;
        case FreeGene::Kind::Permutation:
            if (gene.count < 2 || gene.count > listed_genes_max) {
                refuse(".permutation", "2 to " + std::to_string(listed_genes_max), std::to_string(gene.count));
            }
            break;
        }
    }

  private:
    void refuse(const char* field, std::string allowed, std::string got) {
        violations_.push_back({field_ + field, std::move(allowed), std::move(got)});
    }

    void check_name(const FreeGene& gene) {
        if (!is_name(gene.name)) {
            refuse(".name", "letters, digits and _, not a digit first, at most 60", quoted(gene.name));
            return;
        }
        const bool numbered = gene.kind == FreeGene::Kind::Permutation;
        for (std::uint32_t i = 0; i < (numbered ? std::min(gene.count, listed_genes_max) : 1); ++i) {
            const std::string name = gene.name + (numbered ? std::to_string(i) : "");
            if (!names_.insert(name).second) {
                refuse(".name", "a name that no other gene has", quoted(name));
                return;
            }
        }
    }

    void check_number(const FreeGene& gene) {
        const auto is_within = [](double value) { return std::abs(value) <= bound_max; };
        if (!is_within(gene.min) || !is_within(gene.max)) {
            refuse(is_within(gene.min) ? ".max" : ".min", "-1e12 to 1e12",
                   number_text(is_within(gene.min) ? gene.max : gene.min));
        } else if (!(gene.min < gene.max)) {
            refuse(".max", "above min (" + number_text(gene.min) + ")", number_text(gene.max));
        } else if (!(gene.mutation_step >= 0 && gene.mutation_step <= bound_max)) {
            refuse(".mutation_step", "0 to 1e12", number_text(gene.mutation_step));
        } else if (!(gene.step >= 0 && gene.step <= bound_max)) {
            refuse(".step", "0 to 1e12", number_text(gene.step));
        } else if (gene.logarithmic && gene.min < 1e-30) {
            refuse(".min", "1e-30 or more if the scale is logarithmic", number_text(gene.min));
        } else if (gene.logarithmic && gene.step > 0) {
            refuse(".step", "none if the scale is logarithmic", number_text(gene.step));
        } else if (gene.step > 0) {
            check_step(gene);
        } else if (!(static_cast<float>(gene.min) < static_cast<float>(gene.max))) {
            refuse(".max", "a bound that float32 distinguishes from min", number_text(gene.max));
        }
    }

    void check_step(const FreeGene& gene) {
        const double steps = (gene.max - gene.min) / gene.step;
        const double largest = std::max(std::abs(gene.min), std::abs(gene.max));
        if (gene.step == 1 && largest > whole_max) {
            refuse(std::abs(gene.min) > whole_max ? ".min" : ".max",
                   "whole numbers within ±16777216, which float32 contains",
                   number_text(std::abs(gene.min) > whole_max ? gene.min : gene.max));
        } else if (gene.step < largest / whole_max) {
            refuse(".step", "at least " + number_text(largest / whole_max) + ", because values are float32",
                   number_text(gene.step));
        } else if (std::abs(steps - std::nearbyint(steps)) > 1e-6 * steps + 1e-9) {
            refuse(".max", "min plus a whole number of steps", number_text(gene.max));
        } else if (steps >= whole_max) {
            refuse(".step", "at most 16777216 values between min and max", number_text(gene.step));
        }
    }

    std::string_view list_;
    std::string field_; // "free_genes[2]"
    std::vector<Violation>& violations_;
    std::set<std::string> names_{evolution::body_gene_names.begin(), evolution::body_gene_names.end()};
};

/// Reads one gene of the list.
class GeneReader {
  public:
    GeneReader(std::string field, std::vector<Violation>& violations)
        : field_{std::move(field)}, violations_{violations} {}

    FreeGene read(const JsonNode& node, std::size_t index) {
        FreeGene gene;
        gene.name = "free" + std::to_string(index);
        if (!node.is_object()) {
            violations_.push_back({with_line(field_, node.line),
                                   R"(an object such as {"name": "angle", "min": 0, "max": 1})", node.quoted()});
            return gene;
        }
        if (node.find("choices") != nullptr) {
            gene.kind = FreeGene::Kind::Choice;
        } else if (node.find("permutation") != nullptr) {
            gene.kind = FreeGene::Kind::Permutation;
        }
        for (const JsonMember* member : unique_members(node, field_ + ".", violations_)) {
            read(*member, gene);
        }
        return gene;
    }

  private:
    void refuse(const JsonMember& member, std::string allowed) {
        violations_.push_back(
            {with_line(field_ + "." + member.name, member.line), std::move(allowed), member.value.quoted()});
    }

    void read(const JsonMember& member, FreeGene& gene) {
        const JsonNode& value = member.value;
        const bool is_number = gene.kind == FreeGene::Kind::Number;
        if (member.name == "name") {
            value.is_string() ? gene.name = value.string(), void() : refuse(member, "a string");
        } else if (is_number && (member.name == "min" || member.name == "max" || member.name == "step" ||
                                 member.name == "mutation_step")) {
            double& field = member.name == "min"    ? gene.min
                            : member.name == "max"  ? gene.max
                            : member.name == "step" ? gene.step
                                                    : gene.mutation_step;
            value.is_number() ? field = value.real(), void() : refuse(member, "a number");
        } else if (is_number && member.name == "scale") {
            const std::string scale = value.is_string() ? value.string() : "";
            gene.logarithmic = scale == "logarithmic";
            if (scale != "linear" && scale != "logarithmic") {
                refuse(member, "\"linear\" or \"logarithmic\"");
            }
        } else if (member.name == "choices") {
            read_choices(member, gene);
        } else if (gene.kind == FreeGene::Kind::Permutation && member.name == "permutation") {
            const auto count = value.whole_number();
            count &&*count >= 2 &&*count <= listed_genes_max
                ? gene.count = static_cast<std::uint32_t>(*count),
                  void() : refuse(member, "2 to " + std::to_string(listed_genes_max));
        } else {
            refuse(member, is_number ? "name, min, max, step, scale, mutation_step, choices or permutation"
                                     : "no other field than name with choices or permutation");
        }
    }

    void read_choices(const JsonMember& member, FreeGene& gene) {
        const auto is_choice = [](const JsonNode& node) { return node.is_string() || node.is_number(); };
        if (!member.value.is_array() || !std::ranges::all_of(member.value.elements, is_choice)) {
            return refuse(member, "a list of strings or numbers");
        }
        for (const JsonNode& choice : member.value.elements) {
            gene.choices.push_back(choice.is_string() ? choice.string() : std::string{choice.text});
        }
    }

    std::string field_;
    std::vector<Violation>& violations_;
};

} // namespace

std::vector<Violation> faults_of(std::span<const FreeGene> list, std::string_view field) {
    std::vector<Violation> violations;
    Checker checker{field, violations};
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        checker.check(list[i], i);
        count += list[i].count;
    }
    if (count > listed_genes_max) {
        violations.push_back(
            {std::string{field}, "at most " + std::to_string(listed_genes_max) + " genes", std::to_string(count)});
    }
    return violations;
}

evolution::FreeGenes read_gene_list(const JsonNode& array, std::string_view field, std::vector<Violation>& violations) {
    if (array.elements.size() > listed_genes_max) {
        violations.push_back({with_line(field, array.line), "at most " + std::to_string(listed_genes_max) + " genes",
                              std::to_string(array.elements.size())});
        return {};
    }
    std::vector<FreeGene> list;
    const std::size_t before = violations.size();
    for (std::size_t i = 0; i < array.elements.size(); ++i) {
        GeneReader reader{std::string{field} + "[" + std::to_string(i) + "]", violations};
        list.push_back(reader.read(array.elements[i], i));
    }
    if (violations.size() > before) {
        return {};
    }
    for (Violation& violation : faults_of(list, field)) {
        violation.field = with_line(violation.field, array.line);
        violations.push_back(std::move(violation));
    }
    return violations.size() > before ? evolution::FreeGenes{} : evolution::FreeGenes{std::move(list)};
}

base::Result<evolution::FreeGenes> parse_gene_list(std::string_view text) {
    const auto array = parse_json(text);
    if (!array) {
        return array.error();
    }
    std::vector<Violation> violations;
    if (!array->is_array()) {
        violations.push_back({"free_genes", "a list of genes", array->quoted()});
    }
    auto genes = read_gene_list(*array, "free_genes", violations);
    if (!violations.empty()) {
        return base::Refusal{.code = base::RefusalCode::InvalidArgument,
                             .message = "invalid list of genes",
                             .violations = std::move(violations)};
    }
    return genes;
}

std::string to_json_text(const evolution::FreeGenes& genes) {
    std::string text;
    for (const FreeGene& gene : genes.list()) {
        text += (text.empty() ? "[{\"name\": " : ",\n {\"name\": ") + quoted(gene.name);
        switch (gene.kind) {
        case FreeGene::Kind::Number:
            text += ", \"min\": " + number_text(gene.min) + ", \"max\": " + number_text(gene.max);
            text += gene.step > 0 ? ", \"step\": " + number_text(gene.step) : "";
            text += gene.logarithmic ? R"(, "scale": "logarithmic")" : "";
            text += gene.mutation_step > 0 ? ", \"mutation_step\": " + number_text(gene.mutation_step) : "";
            break;
        case FreeGene::Kind::Choice:
            for (std::size_t i = 0; i < gene.choices.size(); ++i) {
                text += (i == 0 ? ", \"choices\": [" : ", ") + quoted(gene.choices[i]);
            }
            text += "]";
            break;
        case FreeGene::Kind::Permutation:
            text += ", \"permutation\": " + std::to_string(gene.count);
            break;
        }
        text += "}";
    }
    return text.empty() ? "[]" : text + "]";
}

} // namespace evod::parameters
