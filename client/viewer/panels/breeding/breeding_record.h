// BreedingRecord: how one generation was bred, collected from the pages that the server has sent so far.
//
// Owner        BreedingPanel.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/panels/breeding/stepper.h"
#include "evod/v1/commands.pb.h"

#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class BreedingRecord {
  public:
    /// Rows requested of each list; further rows are not shown.
    static constexpr std::uint32_t rows_kept_max = 20'000;

    struct Key {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::uint64_t generation = 0; // of the parents
        friend bool operator==(const Key&, const Key&) = default;
    };

    explicit BreedingRecord(Key key) : key_{std::move(key)} {}
    const Key& key() const { return key_; }

    /// The next request that `moment` needs; nullopt if nothing is missing, or if the last answer brought no new row.
    std::optional<evod::v1::GetBreeding> wanted(Moment moment) const;

    /// Adds the answer to wanted(). Ignores an answer about another generation.
    void add(const evod::v1::Breeding& page);

    bool known() const { return known_.has_value(); }
    /// Each list holds the rows received so far, from row 0. Requires known().
    const evod::v1::Breeding& breeding() const { return *known_; }
    /// Null if the row has not been received.
    const evod::v1::Contender* contender(std::uint32_t organism) const;
    const evod::v1::Pick* pick(std::uint32_t index) const;
    const evod::v1::Descendant* descendant(std::uint32_t id) const;

    /// Picks and descendants to step through, at most rows_kept_max.
    std::uint32_t pick_count() const;
    std::uint32_t descendant_count() const;

    /// The choice of a parameter of the genetic algorithm, "roulette"; empty if the server did not send it.
    std::string choice(const char* parameter) const;
    /// The value of a real or count parameter, or a flag as 0 or 1.
    std::optional<double> number(const char* parameter) const;

  private:
    const evod::v1::ParameterValue* parameter(const char* name) const;

    Key key_;
    std::optional<evod::v1::Breeding> known_; // all pages merged
    bool fruitless_ = false;                  // the last page brought no new row
};

} // namespace evod::viewer
