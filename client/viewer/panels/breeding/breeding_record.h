// BreedingRecord: how one generation was bred, as far as the server has told of it: its answers come in pages.
//
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/panels/breeding/stepper.h"
#include "evod/v1/commands.pb.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class BreedingRecord {
  public:
    /// Of each list no more than this is asked for; who is beyond is not shown.
    static constexpr std::uint32_t rows_kept_max = 20'000;

    struct Key {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::uint64_t generation = 0; // of the parents
        friend bool operator==(const Key&, const Key&) = default;
    };

    explicit BreedingRecord(Key key) : key_{std::move(key)} {}
    const Key& key() const { return key_; }

    /// What is to be asked so that `moment` can be shown, or nullopt: nothing is missing, or the server gave none of
    /// what it was asked for.
    std::optional<evod::v1::GetBreeding> wanted(Moment moment) const;

    /// Takes in the answer to wanted(). An answer of another generation is left out.
    void add(const evod::v1::Breeding& page);

    bool known() const { return known_.has_value(); }
    /// The lists hold what has come, from the first row on. Only where known().
    const evod::v1::Breeding& breeding() const { return *known_; }
    /// Null where the row has not come.
    const evod::v1::Contender* contender(std::uint32_t organism) const;
    const evod::v1::Pick* pick(std::uint32_t index) const;
    const evod::v1::Descendant* descendant(std::uint32_t id) const;

    /// The picks and descendants there are to step through.
    std::uint32_t pick_count() const;
    std::uint32_t descendant_count() const;

    /// The choice of a parameter of the genetic algorithm, "roulette"; empty where it is not told.
    std::string choice(const char* parameter) const;
    /// A number of it, whether real or a count, or a flag as 0 or 1.
    std::optional<double> number(const char* parameter) const;

  private:
    const evod::v1::ParameterValue* parameter(const char* name) const;

    Key key_;
    std::optional<evod::v1::Breeding> known_; // of all pages together
    bool fruitless_ = false;                  // the last page brought nothing
};

} // namespace evod::viewer
