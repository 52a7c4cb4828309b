// MouseTool: what a click in an island does: select an organism, place food, poison or an organism, or remove what is
// there.
//
// Owner        Panels.
// Threads      none; used by the thread that draws.
#pragma once

#include "client/viewer/world/viewed_world.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace evod::viewer {

class MouseTool {
  public:
    enum class Kind { Select, Food, Poison, Organism, Remove };
    static constexpr std::array<std::string_view, 5> names{"Select", "Food", "Poison", "Organism", "Remove"};

    /// The organism that the tool places: its genes, and where they come from: "a copy of organism 12".
    struct Model {
        std::string name;
        std::vector<float> genes;
    };
    /// A point of an island, and the ids of what is drawn there.
    struct Target {
        std::uint32_t island = 0;
        std::uint64_t generation = 0;
        double x_px = 0, y_px = 0;
        std::optional<std::uint32_t> organism{}, food{}, poison{};
    };

    Kind kind() const { return kind_; }
    void choose(Kind kind) { kind_ = kind; }
    /// Chooses the tool that places organisms with these genes.
    void place(Model model);
    const std::optional<Model>& model() const { return model_; }

    /// Chooses the tool that places organisms with these genes while the user drags one from a list with the mouse.
    void drag(Model model);
    bool dragging() const { return drag_ == Drag::Held; }
    /// Call when the user has released the mouse.
    void drop() { drag_ = Drag::Dropped; }
    /// Returns whether drop() was called since the last call.
    bool take_drop() { return std::exchange(drag_, dragging() ? Drag::Held : Drag::Nothing) == Drag::Dropped; }

    /// Returns why the tool cannot act in this world, as a sentence without a full stop; empty if it can.
    std::string problem(Kind kind, const ViewedWorld& world) const;
    /// Returns what a click there would do: "Place food", "Remove organism 12", "Nothing to remove here".
    std::string hint(const Target& target) const;
    /// Returns the request for a click there; nullopt if there is nothing to do. Requires a tool other than Select.
    std::optional<evod::v1::Request> request(const std::string& world, const Target& target) const;
    /// Sends the request for a click there, or adds a notice with the problem.
    void click(ViewedWorld& world, const Target& target) const;

  private:
    enum class Drag { Nothing, Held, Dropped };

    Drag drag_ = Drag::Nothing;
    Kind kind_ = Kind::Select;
    std::optional<Model> model_;
};

} // namespace evod::viewer
