// Fitness functions of the body genes alone: for teaching, and to test the algorithm without the physics.
#pragma once

#include "server/evolution/chromosome.h"

namespace evod::simulation {

/// Returns the sum of the body genes, which is greatest if every gene is at its upper bound.
double gene_sum(const evolution::BodyGenes& genes);

/// Returns −(10 n + Σ (x² − 10 cos 2πx)) with x = (gene − 150)/25 for each of the n body genes: 0 if every gene is 150,
/// with a local maximum near every 25 gene units.
/// Source  Rastrigin 1974; Mühlenbein, Schomisch & Born 1991, "The parallel genetic algorithm as function optimizer".
double rastrigin(const evolution::BodyGenes& genes);

} // namespace evod::simulation
