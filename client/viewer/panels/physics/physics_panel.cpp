#include "client/viewer/panels/physics/physics_panel.h"

#include "client/viewer/drawing/widgets.h"
#include "client/viewer/panels/plots/plot.h"
#include "client/viewer/world/status_text.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace evod::viewer {
namespace {

constexpr double demo_s = 10; // length of the motion shown, in simulated seconds
constexpr float tick_ms_min = 1, tick_ms_max = 1000;
constexpr std::size_t table_rows = 8;

// The table of constant acceleration, as in `evod check --integrators`.
constexpr double acceleration_m_s2 = 2, acceleration_s = 2.4;
constexpr double acceleration_ticks_s[] = {0.8, 0.4, 0.2, 0.1, 0.05};

/// Plots a quantity over time, with the y axis starting at 0. The title contains the newest value.
template <class Of>
void draw_measure(std::string title, const MotionHistory& history, Of&& of) {
    const std::vector<double> tick =
        history.curve([](const evod::v1::Motion& motion) { return double(motion.tick()); });
    const std::vector<double> measure = history.curve(of);
    Plot plot{.title = std::move(title)};
    plot.series.push_back({.colour = palette::organism, .x = tick, .y = measure});
    curve_widget(plot.title.c_str(), plot, {0, 1.6 * std::max(*std::ranges::max_element(measure), 1e-6)},
                 4 * ImGui::GetFontSize());
}

/// Draws a collapsible header. Returns whether it is open.
bool opened(const char* title) {
    const bool open = ImGui::CollapsingHeader(title, ImGuiTreeNodeFlags_DefaultOpen);
    widgets::mark(title);
    return open;
}

} // namespace

void PhysicsPanel::build(Context& context) {
    poll(context);
    if (opened("Bodies of this island")) {
        build_motion();
    }
    if (opened("Effect of the tick length")) {
        build_demo();
    }
    if (opened("Constant acceleration")) {
        build_constant_acceleration();
    }
}

void PhysicsPanel::poll(Context& context) {
    ViewedWorld& world = context.world;
    if (world.feed.place_number() != place_number_) {
        place_number_ = world.feed.place_number();
        history_.clear();
    }
    if (!poll_.due(world, context.now)) {
        return;
    }
    evod::v1::Request request;
    request.mutable_get_motion()->set_world(world.feed.world());
    request.mutable_get_motion()->set_island(world.feed.island());
    poll_.send(world, std::move(request), context.now, [this](const evod::v1::Response* response) {
        if (response != nullptr) {
            history_.add(response->motion());
        }
    });
}

void PhysicsPanel::build_motion() {
    if (!poll_.problem().empty()) {
        widgets::small_text(poll_.problem(), palette::warning);
    }
    if (history_.empty()) {
        ImGui::TextUnformatted("…");
        return;
    }
    const evod::v1::Motion& now = history_.last();
    const TickVerdict verdict = judge_tick(now);
    widgets::small_text(verdict.sentence, verdict.level == TickVerdict::Level::Good    ? palette::running
                                          : verdict.level == TickVerdict::Level::Close ? palette::stopped
                                                                                       : palette::warning);
    ImGui::Text("%s bodies, %s pairs touch; tick of %.4g s", with_separators(now.body_count()).c_str(),
                with_separators(now.touching_count()).c_str(), now.tick_s());
    using Motion = evod::v1::Motion;
    const double momentum = std::hypot(now.momentum_x(), now.momentum_y());
    draw_measure("kinetic energy " + with_unit(now.kinetic_energy(), "kg px²/s²"), history_,
                 [](const Motion& m) { return m.kinetic_energy(); });
    draw_measure("momentum " + with_unit(momentum, "kg px/s"), history_,
                 [](const Motion& m) { return std::hypot(m.momentum_x(), m.momentum_y()); });
    draw_measure("deepest overlap " + with_unit(now.deepest_overlap_px(), "px"), history_,
                 [](const Motion& m) { return m.deepest_overlap_px(); });
    draw_measure("fastest body " + with_unit(now.fastest_px_s(), "px/s"), history_,
                 [](const Motion& m) { return m.fastest_px_s(); });
    draw_measure("movement of the fastest body per tick, in radii: " + shown_number(now.fastest_step_share()), history_,
                 [](const Motion& m) { return m.fastest_step_share(); });
    const double step_px = now.fastest_px_s() * now.tick_s();
    widgets::small_text(
        print("The fastest body moves %.3g px per tick; the contact search uses strips of %.4g px. The deepest "
              "overlap is %.2g of the smaller body's radius. In this generation %s moves were longer than the "
              "body's radius, and max_speed_px_s limited a body %s times.",
              step_px, now.cell_px(), now.deepest_overlap_share(), with_separators(now.too_fast_count()).c_str(),
              with_separators(now.speed_limit_count()).c_str()),
        palette::text);
}

void PhysicsPanel::set_curves(const TimeStepDemo& demo) {
    using Row = TimeStepDemo::Row;
    const auto curve = [&](const char* name, Colour colour, TimeStepDemo::State Row::*state) {
        Curve made{name, colour, {}, {}};
        const double energy = demo.energy(rows_.front().exact);
        for (const Row& row : rows_) {
            made.x_px.push_back((row.*state).x);
            made.energy.push_back(demo.energy(row.*state) / energy);
        }
        return made;
    };
    t_s_.clear();
    for (const Row& row : rows_) {
        t_s_.push_back(row.t_s);
    }
    curves_ = {curve("explicit Euler", palette::explicit_euler, &Row::explicit_euler),
               curve("symplectic Euler", palette::symplectic_euler, &Row::symplectic_euler),
               curve("exact solution", palette::text, &Row::exact)};
}

void PhysicsPanel::build_demo() {
    bool changed = rows_.empty();
    if (ImGui::RadioButton("a spring", spring_)) {
        changed = spring_ = true;
    }
    widgets::mark("a spring");
    ImGui::SameLine();
    if (ImGui::RadioButton("damped motion", !spring_)) {
        spring_ = false;
        changed = true;
    }
    widgets::mark("damped motion");
    const char* rate_label = spring_ ? "ω, 1/s" : "damping, 1/s";
    changed |= ImGui::SliderFloat(rate_label, &rate_per_s_, 0.5f, 10, "%.1f",
                                  ImGuiSliderFlags_AlwaysClamp); // prevents a rate of 0 and a division by 0
    widgets::mark_field(rate_label, rate_per_s_);
    changed |= ImGui::SliderFloat("tick, ms", &tick_ms_, tick_ms_min, tick_ms_max, "%.0f",
                                  ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    widgets::mark_field("tick, ms", tick_ms_);
    if (!history_.empty() && widgets::button("use the tick of this world")) {
        tick_ms_ = std::clamp(static_cast<float>(history_.last().tick_s() * 1000), tick_ms_min, tick_ms_max);
        changed = true;
    }
    const double dt = static_cast<double>(tick_ms_) / 1000, rate = static_cast<double>(rate_per_s_);
    const TimeStepDemo demo{spring_ ? TimeStepDemo::System{rate, 0, {100, 0}}
                                    : TimeStepDemo::System{0, rate, {0, 100}}};
    if (changed) {
        rows_ = demo.rows(dt, static_cast<std::size_t>(demo_s / dt));
        set_curves(demo);
    }
    const std::string steps = with_separators(rows_.size() - 1) + " steps";
    widgets::small_text(steps);
    widgets::mark(steps);
    Plot x{.title = "x in 10 s, px"}, energy{.title = "energy, relative to the start"};
    for (const Curve& curve : curves_) {
        x.series.push_back({.colour = curve.colour, .x = t_s_, .y = curve.x_px});
        energy.series.push_back({.colour = curve.colour, .x = t_s_, .y = curve.energy});
    }
    const double reach = spring_ ? 200 : 150 / rate;
    const float height = 7 * ImGui::GetFontSize();
    curve_widget("##x", x, {spring_ ? -reach : 0, reach}, height);
    curve_widget("##energy", energy, {0, 3}, height);
    for (std::size_t i = curves_.size(); i-- > 0;) {
        widgets::small_text(curves_[i].name, curves_[i].colour);
        if (i > 0) {
            ImGui::SameLine();
        }
    }

    if (ImGui::BeginTable("steps", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) {
        for (const char* name : {"t, s", "x, px"}) {
            ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, 1);
        }
        for (const char* name : {"symplectic Euler", "explicit Euler"}) {
            ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, 2);
        }
        ImGui::TableHeadersRow();
        const std::size_t stride = std::max<std::size_t>(rows_.size() / table_rows, 1);
        for (std::size_t i = 0; i < rows_.size(); i += stride) {
            const TimeStepDemo::Row& row = rows_[i];
            ImGui::TableNextRow();
            for (const double value : {row.t_s, row.exact.x}) {
                ImGui::TableNextColumn();
                ImGui::Text("%.4g", value);
            }
            for (const double value : {row.symplectic_euler.x, row.explicit_euler.x}) {
                ImGui::TableNextColumn();
                ImGui::Text("%.4g (%+.3g)", value, value - row.exact.x);
            }
        }
        ImGui::EndTable();
    }
    if (spring_) {
        widgets::small_text(
            print("Errors are in parentheses. ω·dt is %.3g. Explicit Euler multiplies the energy by 1 + ω²dt² = "
                  "%.4g in every step, however short. Symplectic Euler, the default of a world, %s.",
                  rate * dt, demo.explicit_growth(dt),
                  demo.symplectic_is_stable(dt)
                      ? "keeps the energy near its initial value, because ω·dt is below 2"
                      : "keeps the energy near its initial value only if ω·dt is below 2, which is not so here"),
            palette::text);
    } else {
        widgets::small_text(
            print("Errors are in parentheses. c·dt is %.3g. Each step multiplies the velocity by 1 − c·dt; the "
                  "exact factor is e^(−c·dt). If c·dt is above 1, the body reverses its direction; above 2, it "
                  "also becomes faster. The damping of a world uses the exact factor at any tick length.",
                  rate * dt),
            palette::text);
    }
}

void PhysicsPanel::build_constant_acceleration() const {
    const TimeStepDemo demo{{.omega_per_s = 0, .start = {0, 0}, .acceleration = acceleration_m_s2}};
    const TimeStepDemo::State exact = demo.exact(acceleration_s);
    widgets::small_text(
        print("A body accelerates from rest at a = %g m/s² for t = %g s. It moves exactly ½at² = %.2f m; "
              "its speed is then %.2f m/s with every tick length.",
              acceleration_m_s2, acceleration_s, exact.x, exact.v),
        palette::text);
    if (ImGui::BeginTable("tick lengths", 3, ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV)) {
        ImGui::TableSetupColumn("tick, s", ImGuiTableColumnFlags_WidthStretch, 1);
        for (const char* name : {"symplectic Euler, m", "explicit Euler, m"}) {
            ImGui::TableSetupColumn(name, ImGuiTableColumnFlags_WidthStretch, 2);
        }
        ImGui::TableHeadersRow();
        for (const double tick_s : acceleration_ticks_s) {
            const auto ticks = static_cast<std::size_t>(std::lround(acceleration_s / tick_s));
            const TimeStepDemo::Row end = demo.rows(tick_s, ticks).back();
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::Text("%.2f", tick_s);
            for (const double x : {end.symplectic_euler.x, end.explicit_euler.x}) {
                ImGui::TableNextColumn();
                const std::string cell = print("%.2f (%+.2f)", x, x - exact.x);
                ImGui::TextUnformatted(cell.c_str());
                widgets::mark(cell);
            }
        }
        ImGui::EndTable();
    }
    widgets::small_text(
        "Errors are in parentheses: +½·a·t·tick for symplectic Euler, −½·a·t·tick for explicit Euler. Half "
        "the tick gives half the error.",
        palette::text);
}

} // namespace evod::viewer
