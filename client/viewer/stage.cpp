#include "client/viewer/stage.h"

#include "client/viewer/offscreen.h"

#include <imgui.h>

namespace evod::viewer {

void Stage::draw(Watch& watch, Camera& camera, const Frame& frame) {
    camera.set_viewport(viewport_of(frame.width_pixels, frame.height_pixels));
    link::WorldView& view = watch.view();
    std::optional<std::size_t> pointed_at;
    if (const wire::Picture* picture = watch.picture()) {
        camera.set_island(picture->about.width_px(), picture->about.height_px());
        if (frame.pointed_at) {
            pointed_at = organism_at(*frame.pointed_at, *picture, view.organisms_at(frame.blend), camera);
        }
    }
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    scene_.draw(view, frame.blend, camera, frame.width_pixels, frame.height_pixels, pointed_at);
    scene_.draw_labels(view, frame.blend, camera, *ImGui::GetBackgroundDrawList(), gui_.label());
    overlay_.build(watch, gui_, frame.now);
    panels_.build({watch, gui_, frame.now});
    if (pointed_at) {
        overlay_.build_organism(*watch.picture(), *pointed_at, *frame.pointed_at, gui_);
    }
    gui_.draw();
}

sf::Image Stage::capture(Watch& watch, Camera& camera, const Frame& frame) {
    return draw_off_screen(frame.width_pixels, frame.height_pixels, [&] { draw(watch, camera, frame); });
}

} // namespace evod::viewer
