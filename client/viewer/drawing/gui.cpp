#include "client/viewer/drawing/gui.h"

#include "client/viewer/drawing/imgui_keys.h"

#include <SFML/System/Utf.hpp>
#include <SFML/Window/Clipboard.hpp>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

constexpr const char* font_folder = "/usr/share/fonts/truetype/dejavu/";

ImFont* load_font(const char* name, float pixels) {
    // The ranges contain Latin-1 and the other characters that evoview displays: ω, …, →, ↗ and −.
    static constexpr ImWchar ranges[] = {0x0020, 0x00ff, 0x03c9, 0x03c9, 0x2010, 0x2026, 0x2190,
                                         0x2193, 0x2197, 0x2197, 0x2212, 0x2212, 0};
    const std::string path = std::string{font_folder} + name;
    if (!std::filesystem::exists(path)) {
        throw std::runtime_error{"font not found: " + path + ": install the package fonts-dejavu-core"};
    }
    ImFontConfig config;
    config.OversampleH =
        3; // the default of Dear ImGui until 1.89; with the later default no pixel of thin text has its full colour
    ImFont* font = ImGui::GetIO().Fonts->AddFontFromFileTTF(path.c_str(), pixels, &config, ranges);
    if (font == nullptr) {
        throw std::runtime_error{"could not read the font " + path};
    }
    return font;
}

/// Returns the index of a mouse button in Dear ImGui; -1 for buttons that Dear ImGui does not support.
int button_index(sf::Mouse::Button button) {
    return button == sf::Mouse::Left ? 0 : button == sf::Mouse::Right ? 1 : button == sf::Mouse::Middle ? 2 : -1;
}

using Key = sf::Keyboard;

/// A key that Dear ImGui must receive as a key event. Letters are needed only together with Ctrl.
struct NamedKey {
    ImGuiKey name;
    Key::Key key;
    bool with_control = false;
};
constexpr NamedKey named_keys[] = {
    {ImGuiKey_Tab, Key::Tab},           {ImGuiKey_LeftArrow, Key::Left}, {ImGuiKey_RightArrow, Key::Right},
    {ImGuiKey_UpArrow, Key::Up},        {ImGuiKey_DownArrow, Key::Down}, {ImGuiKey_PageUp, Key::PageUp},
    {ImGuiKey_PageDown, Key::PageDown}, {ImGuiKey_Home, Key::Home},      {ImGuiKey_End, Key::End},
    {ImGuiKey_Insert, Key::Insert},     {ImGuiKey_Delete, Key::Delete},  {ImGuiKey_Backspace, Key::Backspace},
    {ImGuiKey_Enter, Key::Enter},       {ImGuiKey_Escape, Key::Escape},  {ImGuiKey_A, Key::A, true},
    {ImGuiKey_C, Key::C, true},         {ImGuiKey_V, Key::V, true},      {ImGuiKey_X, Key::X, true},
    {ImGuiKey_Y, Key::Y, true},         {ImGuiKey_Z, Key::Z, true},      {ImGuiKey_Space, Key::Space},
};

const NamedKey* find_named(Key::Key key) {
    const auto* found = std::ranges::find(named_keys, key, &NamedKey::key);
    return found == std::end(named_keys) ? nullptr : found;
}

bool is_one_of(Key::Key key, Key::Key left, Key::Key right) {
    return key == left || key == right;
}

} // namespace

Gui::Gui(double scale) : scale_{static_cast<float>(scale)} {
    ImGui::CreateContext();
    ImGui::StyleColorsLight();
    ImGuiStyle& style = ImGui::GetStyle();
    style.FrameBorderSize = 1; // makes white fields visible on light panels
    style.Colors[ImGuiCol_Border].w = 0.5f;
    style.Colors[ImGuiCol_PopupBg].w = 1;
    style.Colors[ImGuiCol_SliderGrab].w = style.Colors[ImGuiCol_SliderGrabActive].w = 0.35f; // it lies under the number
    style.ScaleAllSizes(scale_);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // prevents Dear ImGui from writing a settings file
    io.UserData = widget_positions_.get();
    prepare_keys();
    io.ClipboardUserData = &clipboard_;
    io.GetClipboardTextFn = [](void* kept) {
        const auto utf8 = sf::Clipboard::getString().toUtf8();
        return static_cast<std::string*>(kept)->assign(utf8.begin(), utf8.end()).c_str();
    };
    io.SetClipboardTextFn = [](void*, const char* text) {
        sf::Clipboard::setString(sf::String::fromUtf8(text, text + std::char_traits<char>::length(text)));
    };
    try {
        text_ = load_font("DejaVuSans.ttf", std::round(15 * scale_));
        title_ = load_font("DejaVuSans-Bold.ttf", std::round(22 * scale_));
        label_ = load_font("DejaVuSans.ttf", std::round(14 * scale_));
    } catch (...) {
        ImGui::DestroyContext();
        throw;
    }
    if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
        ImGui::DestroyContext();
        throw std::runtime_error{"Dear ImGui could not start: OpenGL 3.3 is required"};
    }
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void Gui::handle(const sf::Event& event) {
    waiting_.push_back(event);
}

bool Gui::pass_on_key(const sf::Event& event, Received& received) {
    const sf::Event::KeyEvent& key = event.key;
    const bool pressed = event.type == sf::Event::KeyPressed;
    if (const NamedKey* named = find_named(key.code)) {
        const bool down = pressed && (!named->with_control || key.control);
        if (held_keys_[key.code] != down) {
            if (received.key || received.text) {
                return false;
            }
            received.key = true;
            held_keys_[key.code] = down;
            set_key(named->name, down);
        }
    }
    // SFML may report the state of modifier keys before the event, so the state of the key that was pressed or released
    // is taken from the event type.
    const auto held = [&](bool reported, Key::Key left, Key::Key right) {
        return is_one_of(key.code, left, right) ? pressed : reported;
    };
    set_modifiers(held(key.control, Key::LControl, Key::RControl), held(key.shift, Key::LShift, Key::RShift),
                  held(key.alt, Key::LAlt, Key::RAlt), held(key.system, Key::LSystem, Key::RSystem));
    return true;
}

bool Gui::pass_on(const sf::Event& event, Received& received) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.type) {
    case sf::Event::MouseMoved:
        if (received.button) { // the press or release happened at the previous position
            return false;
        }
        io.MousePos = {static_cast<float>(event.mouseMove.x), static_cast<float>(event.mouseMove.y)};
        break;
    case sf::Event::MouseLeft:
        io.MousePos = {-1e9f, -1e9f};
        break;
    case sf::Event::MouseButtonPressed:
    case sf::Event::MouseButtonReleased:
        if (const int index = button_index(event.mouseButton.button); index >= 0) {
            if (received.button) {
                return false;
            }
            received.button = true;
            io.MouseDown[index] = event.type == sf::Event::MouseButtonPressed;
        }
        break;
    case sf::Event::MouseWheelScrolled:
        (event.mouseWheelScroll.wheel == sf::Mouse::VerticalWheel ? io.MouseWheel : io.MouseWheelH) +=
            event.mouseWheelScroll.delta;
        break;
    case sf::Event::KeyPressed:
    case sf::Event::KeyReleased:
        return received.button ? false : pass_on_key(event, received);
    case sf::Event::TextEntered:
        if (received.key || received.button) {
            return false;
        }
        if (event.text.unicode >= ' ' && event.text.unicode != 127) { // control characters arrive as key events
            received.text = true;
            io.AddInputCharacter(event.text.unicode);
        }
        break;
    case sf::Event::LostFocus:
        std::ranges::fill(io.MouseDown, false);
        held_keys_.reset();
        for (const NamedKey& named : named_keys) {
            set_key(named.name, false);
        }
        set_modifiers(false, false, false, false);
        break;
    default:
        break;
    }
    return true;
}

Captured Gui::captured() const {
    const ImGuiIO& io = ImGui::GetIO();
    return {.keyboard = io.WantCaptureKeyboard, .mouse = io.WantCaptureMouse};
}

std::optional<std::string> Gui::typed_text() const {
    ImGuiContext& context = *ImGui::GetCurrentContext();
    const ImGuiInputTextState& field = context.InputTextState;
    if (!context.IO.WantTextInput || field.ID == 0 || field.ID != context.ActiveId) {
        return std::nullopt;
    }
    std::string text;
    for (int i = 0; i < field.CurLenW; ++i) {
        const sf::Uint32 sign = field.TextW[i];
        sf::Utf8::encode(sign, std::back_inserter(text));
    }
    return text;
}

bool Gui::close_popup() {
    // Dear ImGui closes popups with Esc only if keyboard navigation is on.
    const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
    bool visible = false;
    while (!open.empty() && !visible) {
        const ImGuiWindow* window = open.back().Window;
        visible = window == nullptr || window->Active; // a popup whose window is not active belongs to a hidden panel
        ImGui::ClosePopupToLevel(open.Size - 1, true);
    }
    return visible;
}

void Gui::begin(unsigned width_pixels, unsigned height_pixels, double seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(width_pixels), static_cast<float>(height_pixels)};
    io.DeltaTime = static_cast<float>(std::max(seconds, 1e-4));
    Received received;
    while (!waiting_.empty() && pass_on(waiting_.front(), received)) {
        waiting_.pop_front();
    }
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void Gui::draw() {
    widget_positions_->end_frame(ImGui::GetCurrentContext()->HoveredId);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

} // namespace evod::viewer
