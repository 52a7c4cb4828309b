// Sight: what each organism knows of the items around it, so that it need not look anew in every tick.
//
// Of each kind an organism knows the nearest item, and a distance within which there is no other. The distance becomes
// less as the organism moves and as items appear; while what it sees is nearer than that, the nearest item is known
// without a look. So an organism looks in some 4 % of the ticks for each kind, and what it sees is, bit for bit, what
// it would see if it looked.
//
// Owner        an island. Columns are by body index, as long as those of the bodies.
// Threads      organisms look side by side; changes of items are noticed side by side.
// Determinism  what is seen does not depend on when organisms looked.
#pragma once

#include "server/base/column.h"
#include "server/base/executor.h"
#include "server/physics/bodies.h"
#include "server/physics/broad_phase.h"
#include "server/simulation/items.h"
#include "server/simulation/living.h"
#include "server/simulation/organism_kernels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace evod::simulation {

class Sight {
  public:
    /// Everybody has to look.
    void begin(const physics::Circles& bodies, const Living& living, const Items& food, const Items& poison);

    /// Lets those look who have to, of the bodies [begin, end); ranges may be done side by side.
    void look(const physics::Circles& bodies, const Living& living, const Items& food, const Items& poison,
              base::Range range);

    /// Takes note of what food, or poison, has come and gone since the last call. Bodies are where views were last
    /// brought up to date. The two may be done side by side.
    void notice_food(const physics::Circles& bodies, const physics::NearPairs& near, const Living& living, Items& food,
                     base::Executor& executor);
    void notice_poison(const physics::Circles& bodies, const physics::NearPairs& near, const Living& living,
                       Items& poison, base::Executor& executor);

    void reorder(const physics::Reordering& reordering);
    /// The body has become void.
    void remove(std::size_t body);

    /// Fills in what kernels need of the sight.
    void add_to(OrganismColumns& columns, const Living& living, const Items& food, const Items& poison);

  private:
    struct View {
        base::Column<float> others; // no other item is nearer than this, px; < 0: has to look
        base::Column<physics::Coordinate> x,
            y;                     // of the nearest item; elsewhere if there is none within the looked-at radius
        float look_radius_max = 0; // px
    };

    static void begin(View& view, const physics::Circles& bodies, const base::Column<float>& radius,
                      const Items& items);
    /// Those of a block who have to look, and from where.
    struct Looks {
        std::uint32_t indices[physics::circles_per_block];
        ItemQuery queries[physics::circles_per_block];
        std::size_t count = 0;
    };
    static void begin_look(Looks& looks, const View& view, const physics::Circles& bodies,
                           const base::Column<float>& radius, const Items& items, base::Range block);
    static void finish_look(const Looks& looks, View& view, const Items& items);
    static void notice(View& view, const physics::Circles& bodies, const physics::NearPairs& near,
                       const base::Column<float>& radius, Items& items, base::Executor& executor);
    /// How many bodies were near; if more than concerned_max, not all of them have been looked at.
    static std::size_t notice(View& view, const physics::Circles& bodies, const physics::NearPairs& near,
                              const base::Column<float>& radius, std::span<const Items::Change> changes,
                              std::size_t concerned_max);
    static void notice(View& view, const physics::Circles& bodies, const base::Column<float>& radius,
                       const Items::Change& change, std::uint32_t body);

    base::Column<physics::Coordinate> x_, y_; // where bodies were when views were last brought up to date
    View food_, poison_;
};

} // namespace evod::simulation
