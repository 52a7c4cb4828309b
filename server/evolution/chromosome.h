// Chromosomes: six real genes each, kept as the columns of one matrix.
#pragma once

#include "server/evolution/parameters.h"

#include <Eigen/Core>

#include <array>
#include <string_view>

namespace evod::evolution {

/// The genes in chromosome order.
enum Gene : unsigned { NormalSpeed, Impulse, BodySize, BaseHealth, FoodRadius, PoisonRadius };
constexpr unsigned gene_count = 6;
constexpr std::array<std::string_view, gene_count> gene_names = {"normal_speed", "impulse",     "body_size",
                                                                 "base_health",  "food_radius", "poison_radius"};

/// Shape (gene_count, organisms): a column is a chromosome, in order of organism.
using GeneMatrix = Eigen::Array<float, gene_count, Eigen::Dynamic>;
using Chromosome = Eigen::Array<float, gene_count, 1>;

/// A gene stays within [min, max].
struct GeneBounds {
    Chromosome min, max;
};

GeneBounds gene_bounds(const Parameters& parameters);

} // namespace evod::evolution
