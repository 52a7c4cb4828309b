// WholePopulation: requests the genes of all organisms of the viewed world, of all its islands, in one generation.
//
// The server answers page by page. If another generation begins or an organism is placed before the last
// page, the request starts again.
//
// Owner        FreezerPanel.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/population.h"
#include "client/viewer/world/viewed_world.h"
#include "proto/codec/population_csv.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace evod::viewer {

class WholePopulation {
  public:
    static constexpr unsigned attempts_max = 10;

    struct Genes {
        std::string world;
        std::uint64_t generation = 0;
        codec::Population population;
    };
    /// A function that receives the genes, or why they could not be read.
    using Handler = std::function<void(const core::Result<Genes>&)>;

    /// Sends the first request for the viewed world. A later ViewedWorld::update() calls the handler, unless this
    /// object was destroyed or has begun another request.
    void request(ViewedWorld& world, Handler handler);

  private:
    struct State {
        std::uint32_t island_count = 1;
        unsigned attempt = 1;
        Population page{}; // of the island that is being read
        Genes genes{};
        Handler handler{};
    };
    static void send(ViewedWorld& world, const std::shared_ptr<State>& state);
    static void take(ViewedWorld& world, const std::shared_ptr<State>& state, const evod::v1::Population& page);

    std::shared_ptr<State> state_; // the handlers of requests have weak references
};

} // namespace evod::viewer
