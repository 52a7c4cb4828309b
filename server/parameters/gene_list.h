// Gene list: reads, checks and writes lists of free genes (evolution/free_genes.h) as experiment files contain them:
//
//     "free_genes": [{"name": "angle", "min": -90, "max": 90},
//                    {"name": "rate", "min": 0.001, "max": 1, "scale": "logarithmic"},
//                    {"name": "layers", "min": 1, "max": 8, "step": 1},
//                    {"name": "material", "choices": ["steel", "wood"]},
//                    {"name": "tour", "permutation": 32}]
//
// A gene without a name is called free0, free1 and so on, by its place in the list.
#pragma once

#include "server/base/result.h"
#include "server/evolution/free_genes.h"
#include "server/parameters/json_text.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace evod::parameters {

/// Returns what is wrong with a list: names that are not valid or not unique; bounds that are not finite, in the wrong
/// order or beyond ±1e12; steps that do not lead from min to max, or that float32 cannot distinguish near the bounds
/// (so whole numbers are within ±2^24); a logarithmic gene with min <= 0 or a step; fewer than 2 or more than 1000
/// choices; more than 1000 genes. Violations are named `field` + "[2].step".
std::vector<base::Violation> faults_of(std::span<const evolution::FreeGene> list, std::string_view field);

/// Reads a list from a JSON array, and checks it. Adds violations, which name the field and its line.
evolution::FreeGenes read_gene_list(const JsonNode& array, std::string_view field,
                                    std::vector<base::Violation>& violations);
/// Reads the output of to_json_text(). Refused if the text is not a valid list.
base::Result<evolution::FreeGenes> parse_gene_list(std::string_view text);
/// Returns a list as a JSON array with one gene per line; "[]" if it is empty.
std::string to_json_text(const evolution::FreeGenes& genes);

} // namespace evod::parameters
