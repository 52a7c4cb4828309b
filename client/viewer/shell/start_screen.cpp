#include "client/viewer/shell/start_screen.h"

#include "client/viewer/drawing/palette.h"
#include "client/viewer/drawing/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cstring>

namespace evod::viewer {

namespace {

template <std::size_t size>
void put(std::array<char, size>& field, const std::string& text) {
    field.fill('\0');
    std::memcpy(field.data(), text.data(), std::min(text.size(), size - 1));
}

} // namespace

StartScreen::StartScreen(Screen& screen, const core::Options& initial)
    : screen_{screen}
    , options_{initial}
    , recent_{in_state_folder("recent_servers").value_or(std::filesystem::path{})}
    , tls_{initial.tls.has_value()} {
    put(address_, core::to_text(initial.server));
    put(token_, initial.token);
    put(ca_, initial.tls ? initial.tls->ca : "");
}

void StartScreen::remember(const core::Endpoint& server) {
    recent_.add(server);
}

std::optional<core::Options> StartScreen::run() {
    chosen_.reset();
    closing_ = false;
    sf::Window& window = screen_.window();
    while (window.isOpen() && !chosen_) {
        for (sf::Event event; screen_.poll(event);) {
            closing_ = closing_ || event.type == sf::Event::Closed;
        }
        if (closing_) {
            window.close();
            break;
        }
        const WindowRenderer::Frame frame = screen_.frame(Screen::Clock::now());
        screen_.show(nullptr, frame, [&] { screen_.renderer().draw([&](const Gui& gui) { build(gui); }, frame); });
    }
    return chosen_;
}

void StartScreen::build(const Gui& gui) {
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float scale = gui.scale();
    ImGui::SetNextWindowPos({window.x / 2, window.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowSize({std::min(540 * scale, window.x), 0});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {window.x, window.y});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {24 * scale, 20 * scale});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * scale);
    ImGui::Begin("##start", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings);
    ImGui::PushFont(&gui.title());
    ImGui::TextUnformatted("evoview");
    ImGui::PopFont();
    widgets::small_text("Choose the evod server whose worlds you want to see.");
    ImGui::Dummy({0, 6 * scale});
    if (!reason_.empty()) {
        widgets::small_text(reason_, palette::warning);
        widgets::mark("error");
        ImGui::Dummy({0, 6 * scale});
    }
    const bool entered = build_fields(gui);
    ImGui::Dummy({0, 6 * scale});
    if (widgets::button("Connect") || entered) {
        choose();
    }
    ImGui::SameLine();
    if (widgets::button("Quit")) {
        closing_ = true;
    }
    build_recent();
    ImGui::End();
    ImGui::PopStyleVar(2);
}

bool StartScreen::build_fields(const Gui& gui) {
    bool entered = false;
    const float label_width = 90 * gui.scale();
    const auto label = [&](const char* text) {
        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted(text);
        ImGui::SameLine(label_width);
        ImGui::SetNextItemWidth(-1);
    };
    constexpr ImGuiInputTextFlags on_enter = ImGuiInputTextFlags_EnterReturnsTrue;
    label("Server");
    if (ImGui::IsWindowAppearing()) {
        ImGui::SetKeyboardFocusHere();
    }
    entered |= ImGui::InputTextWithHint("##server", "host, host:port or [IPv6]:port", address_.data(), address_.size(),
                                        on_enter | ImGuiInputTextFlags_AutoSelectAll);
    widgets::mark_field("Server", address_.data());
    label("Token");
    entered |= ImGui::InputTextWithHint("##token", "none", token_.data(), token_.size(),
                                        on_enter | ImGuiInputTextFlags_Password);
    widgets::mark_field("Token", token_.data());
    widgets::explain("Identifies you; the server's administrator issues it. It is sent to the server and not saved.");
    label("");
    widgets::checkbox("TLS", tls_);
    widgets::explain("Encrypts the connection and checks the server's identity.");
    if (tls_) {
        label("CA file");
        entered |= ImGui::InputTextWithHint("##ca", "the system's certificates", ca_.data(), ca_.size(), on_enter);
        widgets::mark_field("CA file", ca_.data());
        widgets::explain("PEM file with the certificate that signed the server's certificate, such as its evod.crt.");
    }
    return entered;
}

void StartScreen::build_recent() {
    if (!recent_.problem().empty()) {
        ImGui::Separator();
        widgets::small_text(recent_.problem(), palette::stopped);
    }
    if (recent_.addresses().empty()) {
        return;
    }
    ImGui::Separator();
    widgets::small_text("Recent servers");
    for (const std::string& address : recent_.addresses()) {
        if (ImGui::Selectable(address.c_str(), address == address_.data(), ImGuiSelectableFlags_AllowDoubleClick)) {
            if (address != address_.data()) {
                put(token_, ""); // the token was for another server
            }
            put(address_, address);
            if (ImGui::IsMouseDoubleClicked(0)) {
                choose();
            }
        }
        widgets::mark(address);
    }
}

void StartScreen::choose() {
    const auto server = core::parse_endpoint(address_.data());
    if (!server) {
        reason_ = server.error().what;
        return;
    }
    options_.server = *server;
    options_.token = token_.data();
    if (tls_) {
        core::Options::Tls files = options_.tls.value_or(core::Options::Tls{});
        files.ca = ca_.data();
        options_.tls = files;
    } else {
        options_.tls.reset();
    }
    reason_.clear();
    chosen_ = options_;
}

} // namespace evod::viewer
