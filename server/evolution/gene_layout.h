// Gene layout: which genes the chromosomes of a world have, in chromosome order: the six genes of the body, the weights
// of the brain, and the free genes. If a client rates organisms without bodies that have free genes, the chromosome
// consists of the free genes alone: nothing reads the others.
//
// Determinism  the numbers of genes and their names depend only on parameters that take effect at a reset, so all
//              generations of a run have the same layout. The bounds may change between two generations.
#pragma once

#include "server/evolution/ga_parameters.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace evod::evolution {

/// The genes of the body, with which a chromosome begins if has_body_genes().
enum Gene : unsigned { NormalSpeed, Impulse, BodySize, BaseHealth, FoodRadius, PoisonRadius };
constexpr unsigned body_gene_count = 6;
constexpr std::array<std::string_view, body_gene_count> body_gene_names = {
    "normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"};

/// A contiguous part of a chromosome.
struct GeneRange {
    unsigned first = 0, count = 0;
    friend bool operator==(const GeneRange&, const GeneRange&) = default;
};

/// Returns whether chromosomes contain the genes of the body, and the weights of the brain; otherwise they consist of
/// the free genes.
bool has_body_genes(const Parameters& parameters);

/// The number of genes of a chromosome, at least 1.
unsigned gene_count(const Parameters& parameters);

/// The genes of a group; GeneGroup::All is the whole chromosome.
GeneRange genes_of(GeneGroup group, const Parameters& parameters);

/// The genes of a group without the free genes, if these have a list (free_genes.h).
GeneRange unlisted_genes_of(GeneGroup group, const Parameters& parameters);

/// The allowed range of each gene, both ends included; shape (gene_count).
struct GeneBounds {
    Eigen::ArrayXf min, max;
};
GeneBounds gene_bounds(const Parameters& parameters);

struct GeneLayout {
    std::vector<std::string> names; // shape (gene_count)
    std::vector<GeneGroup> groups;  // shape (gene_count): Body, Brain or Free
    GeneBounds bounds;
};
GeneLayout gene_layout(const Parameters& parameters);

} // namespace evod::evolution
