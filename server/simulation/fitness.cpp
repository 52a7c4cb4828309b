#include "server/simulation/fitness.h"

#include "server/base/elementary.h"

namespace evod::simulation {

double gene_sum(const evolution::BodyGenes& genes) {
    double sum = 0;
    for (unsigned gene = 0; gene < evolution::body_gene_count; ++gene) {
        sum += static_cast<double>(genes(gene));
    }
    return sum;
}

double rastrigin(const evolution::BodyGenes& genes) {
    double sum = 10.0 * evolution::body_gene_count;
    for (unsigned gene = 0; gene < evolution::body_gene_count; ++gene) {
        const double x = (static_cast<double>(genes(gene)) - 150) / 25;
        sum += x * x - 10 * base::cos_turns(x);
    }
    return -sum;
}

} // namespace evod::simulation
