#include "client/viewer/island/mark_painter.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

namespace evod::viewer {

namespace {

constexpr float middle = 500; // of an imaginary island in which each mark lies, in px
constexpr float body_health = 0.75f;

/// A camera that shows one px of the world per pixel, with the middle of the imaginary island at `centre`.
Camera camera_at(ImVec2 centre, float radius, double scale) {
    const double half = 1.5 * radius + 2;
    Camera camera;
    camera.set_viewport({centre.x - half, centre.y - half, 2 * half, 2 * half}, scale);
    camera.set_island(2 * middle, 2 * middle);
    camera.zoom_at(camera.viewport().centre(), 1 / camera.zoom());
    return camera;
}

} // namespace

struct MarkPainter::State {
    struct Mark {
        State& state;
        Camera camera;
        ShapeStyle style;
        float radius;
    };
    struct Drawing {
        ShapePainter painter;
        Layer layer;
    };

    /// Called by Dear ImGui when it draws the widgets.
    static void draw(const ImDrawList*, const ImDrawCmd* command) {
        const Mark& mark = *static_cast<const Mark*>(command->UserCallbackData);
        auto& drawing = mark.state.drawing;
        if (!drawing) {
            drawing = std::make_unique<Drawing>();
        }
        const bool is_body = mark.style.form == Form::Body, is_triangle = mark.style.form == Form::Triangle,
                   has_tips = is_triangle || mark.style.form == Form::Leaf || mark.style.form == Form::Star;
        const float radius = is_body ? 0.65f * mark.radius : has_tips ? 0.6f * mark.radius : mark.radius;
        if (mark.style.form == Form::Line || mark.style.form == Form::Arrow) {
            drawing->layer.set(std::array{Line{middle - radius, middle, middle + radius, middle}});
        } else {
            const float half_height = is_body || is_triangle ? body_health : radius;
            drawing->layer.set(std::array{Shape{middle, middle, radius, half_height}});
        }
        const ImVec2 window = ImGui::GetIO().DisplaySize;
        const ImVec4& clip = command->ClipRect;
        drawing->painter.begin(mark.camera, static_cast<unsigned>(window.x), static_cast<unsigned>(window.y));
        drawing->painter.clip({clip.x, clip.y, clip.z - clip.x, clip.w - clip.y});
        drawing->painter.draw(drawing->layer, mark.style);
        drawing->painter.end();
    }

    std::unique_ptr<Drawing> drawing; // created when the first mark is drawn
    std::deque<Mark> marks;           // of the frame that is built; its draw lists refer to them
    int frame = -1;
};

MarkPainter::MarkPainter() : state_{std::make_unique<State>()} {}
MarkPainter::~MarkPainter() = default;
MarkPainter::MarkPainter(MarkPainter&&) noexcept = default;
MarkPainter& MarkPainter::operator=(MarkPainter&&) noexcept = default;

void MarkPainter::add(ImDrawList& list, ImVec2 centre, float radius, double scale, const ShapeStyle& style,
                      std::optional<Colour> colour) {
    if (std::exchange(state_->frame, ImGui::GetFrameCount()) != ImGui::GetFrameCount()) {
        state_->marks.clear();
    }
    State::Mark& mark = state_->marks.emplace_back(*state_, camera_at(centre, radius, scale), style, radius);
    mark.style.fill = colour.value_or(style.fill);
    mark.style.fill_low = colour.value_or(style.fill_low);
    list.AddCallback(State::draw, &mark);
    list.AddCallback(ImDrawCallback_ResetRenderState, nullptr);
}

} // namespace evod::viewer
