#include "client/viewer/panels/brain_diagram.h"

#include "client/viewer/drawing/ink.h"
#include "client/viewer/drawing/widgets.h"
#include "client/viewer/text/numbers.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace evod::viewer {

namespace {

using NeuronKind = BrainDiagram::Kind;

constexpr Colour positive = palette::series_orange, negative = palette::series_blue;
constexpr float row_pixels = 20, radius_pixels = 7; // of a layer with few neurons, at scale 1
constexpr float height_pixels_max = 256;            // of a layer with many neurons, at scale 1

std::uint8_t mixed(std::uint8_t from, std::uint8_t to, float share) {
    return static_cast<std::uint8_t>(std::lround(static_cast<float>(from) + share * static_cast<float>(to - from)));
}

std::string shown_activation(float activation) {
    return print("%s%.2f", activation < 0 ? "−" : "", std::abs(double{activation}));
}

/// Builds a diagram layer by layer.
class Builder {
  public:
    Builder(BrainDiagram& diagram, std::span<const float> weights, float scale)
        : diagram_{diagram}, weights_{weights}, scale_{scale} {}

    /// Adds a layer with equal distances between its neurons, and a bias below it if `has_bias`. Returns the indices of
    /// its first neuron, and of the one after its last.
    template <class Name>
    std::pair<std::size_t, std::size_t> add_layer(NeuronKind kind,
                                                  const google::protobuf::RepeatedField<float>& activations,
                                                  const Name& name, float x, bool has_bias) {
        const auto count = static_cast<float>(activations.size() + has_bias);
        const float row = std::min(diagram_.height / count, row_pixels * scale_);
        const float radius = std::min(radius_pixels * scale_, row * 0.42f);
        const float top = (diagram_.height - row * count) / 2 + row / 2;
        const std::size_t begin = diagram_.neurons.size();
        for (int i = 0; i < activations.size(); ++i) {
            diagram_.neurons.push_back(
                {kind, name(i), activations.Get(i), x, top + row * static_cast<float>(i), radius});
        }
        if (has_bias) {
            diagram_.neurons.push_back({NeuronKind::Bias, "bias", 1, x, top + row * (count - 1), radius});
        }
        return {begin, diagram_.neurons.size()};
    }

    /// Connects every neuron of a layer with every neuron of the layer before it, except its bias.
    void connect(std::pair<std::size_t, std::size_t> before, std::pair<std::size_t, std::size_t> layer) {
        for (std::size_t to = layer.first; to < layer.second; ++to) {
            if (diagram_.neurons[to].kind == NeuronKind::Bias) {
                continue;
            }
            for (std::size_t from = before.first; from < before.second; ++from) {
                diagram_.lines.push_back({from, to, weights_[next_++]});
            }
        }
    }

  private:
    BrainDiagram& diagram_;
    std::span<const float> weights_;
    float scale_;
    std::size_t next_ = 0;
};

} // namespace

std::optional<BrainDiagram> brain_diagram(const evod::v1::Brain& brain, std::span<const float> weights, float width,
                                          LabelWidths labels, float scale) {
    const int bias = brain.has_bias() ? 1 : 0;
    const int inputs = brain.inputs_size(), hidden = brain.hidden_size(), outputs = brain.outputs_size();
    const auto weight_count = static_cast<std::size_t>(hidden * (inputs + bias) + outputs * (hidden + bias));
    if (inputs == 0 || hidden == 0 || outputs == 0 || weights.size() != weight_count) {
        return std::nullopt;
    }
    BrainDiagram diagram;
    diagram.width = width;
    const int rows = std::max({inputs + bias, hidden + bias, outputs});
    diagram.height = std::min(static_cast<float>(rows) * row_pixels, height_pixels_max) * scale;
    const auto named = [](const auto& names) {
        return [&names](int i) { return i < names.size() ? names.Get(i) : std::to_string(i + 1); };
    };
    const float left = labels.inputs, right = width - labels.outputs;
    Builder builder{diagram, weights, scale};
    const auto first =
        builder.add_layer(NeuronKind::Input, brain.inputs(), named(brain.input_names()), left, bias != 0);
    const auto middle = builder.add_layer(
        NeuronKind::Hidden, brain.hidden(), [](int i) { return "hidden" + std::to_string(i + 1); }, (left + right) / 2,
        bias != 0);
    const auto last = builder.add_layer(NeuronKind::Output, brain.outputs(), named(brain.output_names()), right, false);
    builder.connect(first, middle);
    builder.connect(middle, last);
    float largest = 0;
    for (const BrainDiagram::Line& line : diagram.lines) {
        largest = std::max(largest, std::abs(line.weight));
    }
    for (BrainDiagram::Line& line : diagram.lines) {
        line.strength = largest > 0 ? std::abs(line.weight) / largest : 0;
    }
    std::ranges::stable_sort(diagram.lines, {}, &BrainDiagram::Line::strength);
    return diagram;
}

Colour activation_colour(float activation) {
    const Colour full = activation < 0 ? negative : positive;
    const float share = std::min(std::abs(activation), 1.f);
    return {mixed(255, full.red, share), mixed(255, full.green, share), mixed(255, full.blue, share)};
}

std::optional<std::size_t> neuron_at(const BrainDiagram& diagram, float x, float y) {
    for (std::size_t i = 0; i < diagram.neurons.size(); ++i) {
        const BrainDiagram::Neuron& neuron = diagram.neurons[i];
        if (std::hypot(neuron.x - x, neuron.y - y) <= neuron.radius + 2) {
            return i;
        }
    }
    return std::nullopt;
}

std::string neuron_text(const BrainDiagram& diagram, std::size_t neuron) {
    const BrainDiagram::Neuron& of = diagram.neurons[neuron];
    if (of.kind == NeuronKind::Bias) {
        return "bias: a constant 1";
    }
    std::string text = of.name + ": " + shown_activation(of.activation);
    constexpr int shown_max = 8;
    int shown = 0;
    for (std::size_t i = diagram.lines.size(); i-- > 0;) { // the strongest first
        const BrainDiagram::Line& line = diagram.lines[i];
        if (line.to == neuron && shown++ < shown_max) {
            text += print("\n%s × weight %s", diagram.neurons[line.from].name.c_str(),
                          shown_activation(line.weight).c_str());
        }
    }
    return text + (shown > shown_max ? print("\nand %d weaker weights", shown - shown_max) : "");
}

namespace {

void draw_lines(const BrainDiagram& diagram, ImVec2 corner, std::optional<std::size_t> pointed_at, float scale,
                ImDrawList& list) {
    for (const BrainDiagram::Line& line : diagram.lines) {
        if (pointed_at && line.from != *pointed_at && line.to != *pointed_at) {
            continue;
        }
        const BrainDiagram::Neuron &from = diagram.neurons[line.from], &to = diagram.neurons[line.to];
        const auto alpha = static_cast<std::uint8_t>(24 + 231 * line.strength * line.strength);
        list.AddLine({corner.x + from.x, corner.y + from.y}, {corner.x + to.x, corner.y + to.y},
                     ink(faint(line.weight < 0 ? negative : positive, alpha)), scale * (0.6f + 2.6f * line.strength));
    }
}

/// in_first  whether the neuron belongs to the first layer, whose names are at the left
void draw_neuron(const BrainDiagram::Neuron& neuron, bool in_first, ImVec2 corner, const ImFont& font, float scale,
                 ImDrawList& list) {
    const ImVec2 at{corner.x + neuron.x, corner.y + neuron.y};
    if (neuron.kind == NeuronKind::Bias) {
        const float half = neuron.radius * 0.8f;
        list.AddRectFilled({at.x - half, at.y - half}, {at.x + half, at.y + half}, ink(palette::strip));
        list.AddRect({at.x - half, at.y - half}, {at.x + half, at.y + half}, ink(palette::text_quiet), 0, 0, scale);
    } else {
        list.AddCircleFilled(at, neuron.radius, ink(activation_colour(neuron.activation)), 20);
        list.AddCircle(at, neuron.radius, ink(palette::text), 20, std::min(1.25f * scale, 0.2f * neuron.radius));
    }
    const float gap = neuron.radius + 5 * scale, top = at.y - font.FontSize / 2;
    if (neuron.kind == NeuronKind::Output) {
        const float end = write(list, font, {at.x + gap, top}, palette::text, neuron.name);
        write(list, font, {end + 4 * scale, top}, palette::text_quiet, shown_activation(neuron.activation));
    } else if (neuron.kind == NeuronKind::Input) {
        std::string name = neuron.name;
        std::ranges::replace(name, '_', ' ');
        write_to_the_left(list, font, {at.x - gap, top}, palette::text, name);
    } else if (neuron.kind == NeuronKind::Bias && in_first) {
        write_to_the_left(list, font, {at.x - gap, top}, palette::text_quiet, neuron.name);
    }
}

} // namespace

void build_brain(const evod::v1::Brain& brain, std::span<const float> weights, const Gui& gui) {
    const ImFont& font = gui.label();
    const float scale = gui.scale();
    const auto widest = [&](const auto& names) {
        float width = 0;
        for (const std::string& name : names) {
            width = std::max(width, size_of(name, font).x);
        }
        return width + (radius_pixels + 6) * scale;
    };
    const float number = size_of(" −0.00", font).x + 4 * scale;
    const auto diagram = brain_diagram(brain, weights, ImGui::GetContentRegionAvail().x,
                                       {widest(brain.input_names()), widest(brain.output_names()) + number}, scale);
    if (!diagram) {
        return;
    }
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::Dummy({diagram->width, diagram->height});
    widgets::mark("Network");
    const ImVec2 mouse = ImGui::GetMousePos();
    const auto pointed_at =
        ImGui::IsItemHovered() ? neuron_at(*diagram, mouse.x - corner.x, mouse.y - corner.y) : std::nullopt;
    ImDrawList& list = *ImGui::GetWindowDrawList();
    draw_lines(*diagram, corner, pointed_at, scale, list);
    for (const BrainDiagram::Neuron& neuron : diagram->neurons) {
        draw_neuron(neuron, neuron.x == diagram->neurons.front().x, corner, font, scale, list);
    }
    if (pointed_at) {
        widgets::note(neuron_text(*diagram, *pointed_at));
    }
    widgets::small_text("Circles: activation; lines: weights, wider if larger. Orange: positive, blue: negative.");
}

} // namespace evod::viewer
