// Sweep design: derives the cells of a sweep from a grid, a list or a Latin hypercube of parameters.
//
// Threads      none.
// Determinism  the cells depend only on the text, the experiment and the seed of the sweep.
// Source       Latin hypercube: McKay, Beckman & Conover 1979, "A Comparison of Three Methods for Selecting Values of
//              Input Variables", Technometrics 21(2), doi:10.2307/1268522.
#pragma once

#include "server/experiments/sweep_dimension.h"
#include "server/experiments/sweep_file.h"

namespace evod::experiments {

/// Reads a member "grid", "list" or "latin_hypercube" of a sweep file into sweep.swept and sweep.cells. If the design
/// is invalid or has too many runs, adds errors and leaves the cells empty.
///
/// sweep  must already contain the parameters, replicates and seed of the file.
void read_design(const parameters::JsonMember& design, Sweep& sweep, SweepErrors& errors);

} // namespace evod::experiments
