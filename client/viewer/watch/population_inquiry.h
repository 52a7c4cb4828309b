// PopulationInquiry: asks for the organisms of an island, page by page, until all of one generation are here.
//
// A generation that ends between two pages is begun anew, but not at once: large populations of a fast world would be
// asked for without a pause, and most of the time is left to pictures.
//
// Owner        who shows the population.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/watch/inquiry.h"
#include "client/viewer/watch/population.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace evod::viewer {

class PopulationInquiry {
  public:
    using Clock = Inquiry::Clock;

    /// Whose population it is.
    struct Of {
        std::string world, run_id;
        std::uint32_t island = 0;
        std::size_t gene_count = 0;
        friend bool operator==(const Of&, const Of&) = default;
    };

    /// pause  at least so long from a whole population until the next is asked for.
    explicit PopulationInquiry(Clock::duration pause) : pause_{pause} {}

    /// Asks for what is missing of what was begun, or begins anew where another one is wanted, now that it may be.
    /// With another `of` than before nothing is known.
    ///
    /// returns  whether one was begun.
    bool update(Watch& watch, const Of& of, bool wanted, Clock::time_point now);

    /// The last that came whole; null: none has yet.
    const Population* whole() const { return whole_ ? &*whole_ : nullptr; }
    /// Rises with each that came whole.
    std::uint64_t whole_count() const { return whole_count_; }
    /// Why it is not known, in a sentence; empty if it is, or comes.
    std::string trouble() const;
    /// Whether the server will never tell.
    bool is_unknown() const { return inquiry_.is_unknown(); }

  private:
    void take(const evod::v1::Population& page);
    void begin_anew() { coming_ = Population{of_.gene_count}; }

    Clock::duration pause_;
    Of of_;
    Inquiry inquiry_;
    Population coming_;
    std::optional<Population> whole_;
    std::uint64_t whole_count_ = 0;
    Clock::time_point begun_{};
    std::string unreadable_;
};

} // namespace evod::viewer
