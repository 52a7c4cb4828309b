// BreedingRecord: how one generation was bred, merged from the pages that the server has sent so far.
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
    /// Maximum number of rows of each list that are requested and shown.
    static constexpr std::uint32_t rows_kept_max = 20'000;

    struct Key {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::uint64_t generation = 0; // generation of the parents
        friend bool operator==(const Key&, const Key&) = default;
    };

    explicit BreedingRecord(Key key) : key_{std::move(key)} {}
    const Key& key() const { return key_; }

    /// Returns the next request that is needed to show `moment`. Returns nullopt if no data is missing, or if the last
    /// answer contained no new row.
    std::optional<evod::v1::GetBreeding> wanted(Moment moment) const;

    /// Adds the answer to the request from wanted(). Ignores an answer about another generation.
    void add(const evod::v1::Breeding& page);

    bool known() const { return known_.has_value(); }
    /// Returns the merged answers. Each list contains the rows received so far, from row 0. Requires known().
    const evod::v1::Breeding& breeding() const { return *known_; }
    /// Returns the contender with this organism id; null if its row has not been received.
    const evod::v1::Contender* contender(std::uint32_t organism) const;
    const evod::v1::Pick* pick(std::uint32_t index) const;
    const evod::v1::Descendant* descendant(std::uint32_t id) const;

    /// Returns the number of picks and of descendants that the user can step through, at most rows_kept_max each.
    std::uint32_t pick_count() const;
    std::uint32_t descendant_count() const;

    /// Returns the value of a parameter with named choices, such as "roulette"; empty if the server did not send the
    /// parameter.
    std::string choice(const char* parameter) const;
    /// Returns the value of a real or whole-number parameter; a flag is 0 or 1.
    std::optional<double> number(const char* parameter) const;

  private:
    const evod::v1::ParameterValue* parameter(const char* name) const;

    Key key_;
    std::optional<evod::v1::Breeding> known_; // all pages merged
    bool no_new_row_ = false;                 // the last page contained no new row
};

} // namespace evod::viewer
