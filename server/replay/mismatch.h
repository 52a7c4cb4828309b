// Mismatch: finds the first difference between a stored record and the same record after a new simulation.
#pragma once

#include "server/run_file/records.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::replay {

/// The first number that differs, as text.
struct Mismatch {
    std::string part; // name of the number: "the fitness of organism 3 on island 0"
    std::string stored, simulated;
};

// Each function returns the first difference; nullopt if there is none. Numbers are compared exactly, but −0 equals 0,
// because SQLite stores −0 as 0. Selection accounts may differ in their last digits.

std::optional<Mismatch> compare(const simulation::Opening& stored, const simulation::Opening& simulated);
// Both vectors have one entry per island.
//
// gene_names  the names of the genes, in chromosome order; a gene beyond them is named by its index.
std::optional<Mismatch> compare(const std::vector<evolution::NextGeneration>& stored,
                                const std::vector<evolution::NextGeneration>& simulated,
                                std::span<const std::string> gene_names = {});
std::optional<Mismatch> compare(const std::vector<simulation::IslandOpening>& stored,
                                const std::vector<simulation::IslandOpening>& simulated);
std::optional<Mismatch> compare(const simulation::Founders& stored, const simulation::Founders& simulated);
std::optional<Mismatch> compare(const std::vector<run_file::IslandOutcome>& stored,
                                const std::vector<run_file::IslandOutcome>& simulated);
std::optional<Mismatch> compare(const std::vector<simulation::GenerationStatistics>& stored,
                                const std::vector<simulation::GenerationStatistics>& simulated,
                                std::span<const std::string> gene_names = {});
std::optional<Mismatch> compare(const base::StateHash& stored, const base::StateHash& simulated);
std::optional<Mismatch> compare(const simulation::WorldState& stored, const simulation::WorldState& simulated);
/// Compares requested parameters.
std::optional<Mismatch> compare_requested(const parameters::RequestedParameters& stored,
                                          const parameters::RequestedParameters& simulated);

} // namespace evod::replay
