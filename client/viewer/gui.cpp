#include "client/viewer/gui.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace evod::viewer {

namespace {

constexpr const char* font_folder = "/usr/share/fonts/truetype/dejavu/";

ImFont* load_font(const char* name, float pixels) {
    // Latin, and the signs of ours beyond it: ω, … and −.
    static constexpr ImWchar ranges[] = {0x0020, 0x00ff, 0x03c9, 0x03c9, 0x2010, 0x2026, 0x2212, 0x2212, 0};
    const std::string path = std::string{font_folder} + name;
    if (!std::filesystem::exists(path)) {
        throw std::runtime_error{"no font " + path + ": install the package fonts-dejavu-core"};
    }
    ImFont* font = ImGui::GetIO().Fonts->AddFontFromFileTTF(path.c_str(), pixels, nullptr, ranges);
    if (font == nullptr) {
        throw std::runtime_error{"the font " + path + " cannot be read"};
    }
    return font;
}

/// The index of a mouse button in Dear ImGui; others have none.
int button_index(sf::Mouse::Button button) {
    return button == sf::Mouse::Left ? 0 : button == sf::Mouse::Right ? 1 : button == sf::Mouse::Middle ? 2 : -1;
}

/// The keys that panels and fields of text ask for.
struct NamedKey {
    ImGuiKey name;
    sf::Keyboard::Key key;
};
constexpr NamedKey named_keys[] = {
    {ImGuiKey_LeftArrow, sf::Keyboard::Left}, {ImGuiKey_RightArrow, sf::Keyboard::Right},
    {ImGuiKey_PageUp, sf::Keyboard::PageUp},  {ImGuiKey_PageDown, sf::Keyboard::PageDown},
    {ImGuiKey_Home, sf::Keyboard::Home},      {ImGuiKey_End, sf::Keyboard::End},
    {ImGuiKey_Enter, sf::Keyboard::Enter},    {ImGuiKey_Space, sf::Keyboard::Space},
    {ImGuiKey_Tab, sf::Keyboard::Tab},        {ImGuiKey_Backspace, sf::Keyboard::BackSpace},
    {ImGuiKey_Delete, sf::Keyboard::Delete},  {ImGuiKey_Escape, sf::Keyboard::Escape},
    {ImGuiKey_UpArrow, sf::Keyboard::Up},     {ImGuiKey_DownArrow, sf::Keyboard::Down},
};

} // namespace

Gui::Gui() {
    ImGui::CreateContext();
    ImGui::StyleColorsLight();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is remembered in files
    for (const NamedKey& named : named_keys) {
        io.KeyMap[named.name] = named.key;
    }
    try {
        text_ = load_font("DejaVuSans.ttf", 15);
        title_ = load_font("DejaVuSans-Bold.ttf", 22);
        label_ = load_font("DejaVuSans.ttf", 14);
    } catch (...) {
        ImGui::DestroyContext();
        throw;
    }
    if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
        ImGui::DestroyContext();
        throw std::runtime_error{"Dear ImGui cannot draw here: OpenGL 3.3 is needed"};
    }
}

Gui::~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext();
}

void Gui::handle(const sf::Event& event) {
    ImGuiIO& io = ImGui::GetIO();
    switch (event.type) {
    case sf::Event::MouseMoved:
        io.MousePos = {static_cast<float>(event.mouseMove.x), static_cast<float>(event.mouseMove.y)};
        break;
    case sf::Event::MouseLeft:
        io.MousePos = {-1e9f, -1e9f};
        break;
    case sf::Event::MouseButtonPressed:
    case sf::Event::MouseButtonReleased:
        if (const int index = button_index(event.mouseButton.button); index >= 0) {
            io.MouseDown[index] = event.type == sf::Event::MouseButtonPressed;
        }
        break;
    case sf::Event::MouseWheelScrolled:
        (event.mouseWheelScroll.wheel == sf::Mouse::VerticalWheel ? io.MouseWheel : io.MouseWheelH) +=
            event.mouseWheelScroll.delta;
        break;
    case sf::Event::KeyPressed:
    case sf::Event::KeyReleased:
        if (event.key.code != sf::Keyboard::Unknown) {
            io.KeysDown[event.key.code] = event.type == sf::Event::KeyPressed;
        }
        io.KeyCtrl = event.key.control;
        io.KeyShift = event.key.shift;
        break;
    case sf::Event::LostFocus:
        std::fill(std::begin(io.MouseDown), std::end(io.MouseDown), false);
        std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
        break;
    case sf::Event::TextEntered:
        io.AddInputCharacter(event.text.unicode);
        break;
    default:
        break;
    }
}

Captured Gui::captured() const {
    const ImGuiIO& io = ImGui::GetIO();
    return {.keyboard = io.WantCaptureKeyboard, .mouse = io.WantCaptureMouse};
}

void Gui::begin(unsigned width_pixels, unsigned height_pixels, double seconds) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(width_pixels), static_cast<float>(height_pixels)};
    io.DeltaTime = static_cast<float>(std::max(seconds, 1e-4));
    ImGui_ImplOpenGL3_NewFrame();
    ImGui::NewFrame();
}

void Gui::draw() {
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

} // namespace evod::viewer
