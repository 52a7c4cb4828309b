// Free genes with rules of their own: a list that gives each free gene a name, bounds, a step, a scale, choices, or an
// order. A world without a list has free genes that are real numbers between free_gene_min and free_gene_max.
//
// The list takes effect at a reset, so all generations of a run have the same list.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace evod::evolution {

/// One entry of the list: a number, a choice, or a permutation. parameters/gene_list.h checks lists.
struct FreeGene {
    enum class Kind {
        Number,     // a real number; with a step, one of min, min + step, min + 2 step, …
        Choice,     // one of the choices, whose index the chromosome contains
        Permutation // `count` genes that contain 0 … count − 1, each once
    };

    std::string name; // [A-Za-z_][A-Za-z0-9_]*; a permutation's genes are NAME0, NAME1, …
    Kind kind = Kind::Number;
    double min = 0, max = 1;          // Number: min < max. The highest value is min plus a whole number of steps
    double step = 0;                  // Number: 0 means that all values are allowed
    bool logarithmic = false;         // Number: mutation and initial values follow the logarithm; min > 0, no step
    double mutation_step = 0;         // Number: size of a creep mutation; 0: free_mutation_step · (max − min)
    std::vector<std::string> choices; // Choice: at least 2, all different
    std::uint32_t count = 1;          // Permutation: at least 2; otherwise 1

    friend bool operator==(const FreeGene&, const FreeGene&) = default;
};

/// A list of free genes; empty if the world has none. Copies share the entries.
class FreeGenes {
  public:
    FreeGenes() = default;
    explicit FreeGenes(std::vector<FreeGene> list);
    // Not inline: GCC 12 would warn of uninitialised memory wherever parameters are destroyed.
    FreeGenes(const FreeGenes& other);
    FreeGenes& operator=(const FreeGenes& other);
    ~FreeGenes();

    bool empty() const { return list_ == nullptr; }
    const std::vector<FreeGene>& list() const;
    /// The number of genes of a chromosome that the list describes.
    std::uint32_t gene_count() const;

    friend bool operator==(const FreeGenes& a, const FreeGenes& b) {
        return a.list_ == b.list_ || a.list() == b.list();
    }

  private:
    std::shared_ptr<const std::vector<FreeGene>> list_;
};

/// The values of one gene, and their positions: the numbers from which mutation and crossover compute new values. The
/// position of a value is the value itself, its logarithm, or, with a step or choices, its index among the values.
class GeneValues {
  public:
    explicit GeneValues(const FreeGene& gene);

    bool is_ordered() const { return ordered_; } // false for choices
    /// The number of values; 0 if there is one for every real number.
    std::uint32_t count() const { return count_; }
    float min() const { return min_value_; }
    float max() const { return max_value_; }
    /// Position of the lowest and of the highest value.
    double first() const { return first_; }
    double last() const { return last_; }
    /// The largest step of a uniform creep mutation in positions. `share`: free_mutation_step.
    double creep(double share) const { return creep_ > 0 ? creep_ : share * (last_ - first_); }

    double position_of(float value) const;
    /// Returns the value at a position. A position between two values counts as the nearer one.
    float to_value(double position) const;
    bool contains(float value) const;

  private:
    bool ordered_, logarithmic_;
    double min_, step_;
    std::uint32_t count_;
    double first_, last_, creep_;
    float min_value_, max_value_;
};

} // namespace evod::evolution
