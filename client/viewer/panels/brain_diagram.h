// BrainDiagram: draws the neural network of an organism. Each neuron has the colour of its activation; each line has
// the colour of its weight's sign, and is the wider, the larger the weight is.
//
// Positive numbers are orange and negative ones blue, which every kind of colour vision distinguishes.
//
// Owner        none: functions and plain data.
// Threads      none; used on the drawing thread.
#pragma once

#include "client/viewer/drawing/gui.h"
#include "client/viewer/drawing/palette.h"
#include "evod/v1/world.pb.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace evod::viewer {

/// A network as neurons and lines. Positions are in pixels from the upper left corner of the diagram.
struct BrainDiagram {
    enum class Kind { Input, Hidden, Output, Bias };
    struct Neuron {
        Kind kind = Kind::Hidden;
        std::string name; // "food_bearing", "hidden3", "turn", "bias"
        float activation = 0;
        float x = 0, y = 0, radius = 0;
    };
    struct Line {
        std::size_t from = 0, to = 0; // indices in `neurons`
        float weight = 0;
        float strength = 0; // |weight| as a share of the largest one in the network
    };
    std::vector<Neuron> neurons;
    std::vector<Line> lines; // weak ones first, so that strong ones are drawn above them
    float width = 0, height = 0;
};

/// From the edges of the diagram to the neurons, whose names are there, in pixels.
struct LabelWidths {
    float inputs = 0, outputs = 0;
};

/// Computes the diagram of a network.
///
/// weights  in the order of evod::v1::Brain
/// width    of the diagram, pixels
/// returns  nullopt if the number of weights does not fit the network
std::optional<BrainDiagram> brain_diagram(const evod::v1::Brain& brain, std::span<const float> weights, float width,
                                          LabelWidths labels, float scale);

/// White at 0, orange at 1 and blue at −1; between them the colours are mixed.
Colour activation_colour(float activation);

/// Returns the neuron at a point of the diagram; nullopt if there is none.
std::optional<std::size_t> neuron_at(const BrainDiagram& diagram, float x, float y);

/// Describes a neuron: its name, its activation and its strongest inputs.
std::string neuron_text(const BrainDiagram& diagram, std::size_t neuron);

/// Builds the diagram as a widget of the current panel, with the name "Network". The note of a neuron appears while the
/// mouse is on it, and only its lines are drawn then.
void build_brain(const evod::v1::Brain& brain, std::span<const float> weights, const Gui& gui);

} // namespace evod::viewer
