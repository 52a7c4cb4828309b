#include "client/viewer/stage.h"

#include "client/viewer/legend.h"
#include "client/viewer/offscreen.h"
#include "client/viewer/panels/organism_panel.h"

#include <imgui.h>

namespace evod::viewer {

namespace {

std::optional<std::size_t> index_of(std::optional<std::uint32_t> id, const wire::Picture& picture) {
    const auto& ids = picture.organisms.id;
    const auto place = id ? std::ranges::lower_bound(ids, *id) : ids.end();
    return place != ids.end() && *place == *id ? std::optional{static_cast<std::size_t>(place - ids.begin())}
                                               : std::nullopt;
}

} // namespace

void Stage::select_at(Watch& watch, const Camera& camera, Point screen) {
    if (const wire::Picture* picture = watch.picture()) {
        const auto index = organism_at(screen, *picture, watch.view().organisms_at(blend_), camera);
        watch.select(index ? std::optional{picture->organisms.id[*index]} : std::nullopt);
        if (index) {
            panels_.show(OrganismPanel::name);
        }
    }
}

void Stage::draw(Watch& watch, Camera& camera, const Frame& frame) {
    camera.set_viewport(viewport_of(frame.width_pixels, frame.height_pixels));
    link::WorldView& view = watch.view();
    Scene::Marked marked;
    blend_ = frame.blend;
    if (const wire::Picture* picture = watch.picture()) {
        camera.set_island(picture->about.width_px(), picture->about.height_px());
        sight_.update(watch, camera, frame.now);
        sight_.follow(watch, camera, frame.blend);
        if (frame.pointed_at) {
            marked.pointed_at = organism_at(*frame.pointed_at, *picture, view.organisms_at(frame.blend), camera);
        }
        marked.selected = index_of(watch.selected(), *picture);
    }
    gui_.begin(frame.width_pixels, frame.height_pixels, std::chrono::duration<double>{frame.now - drawn_}.count());
    drawn_ = frame.now;
    scene_.draw(view, frame.blend, camera, frame.width_pixels, frame.height_pixels, sight_, marked);
    if (!sight_.shows_density(camera)) {
        scene_.draw_labels(view, frame.blend, camera, *ImGui::GetBackgroundDrawList(), gui_.label());
    }
    overlay_.build(watch, gui_, frame.now);
    if (const wire::Picture* picture = watch.picture()) {
        build_legend(legend_of(sight_, *picture, scene_.density_scale(), scene_.density_cell_px()), camera, gui_);
        if (sight_.shown.minimap) {
            minimap_.build(watch, camera);
        }
    }
    panels_.build({watch, gui_, frame.now, sight_});
    if (marked.pointed_at) {
        overlay_.build_organism(*watch.picture(), *marked.pointed_at, *frame.pointed_at, gui_);
    }
    gui_.draw();
}

sf::Image Stage::capture(Watch& watch, Camera& camera, const Frame& frame) {
    return draw_off_screen(frame.width_pixels, frame.height_pixels, [&] { draw(watch, camera, frame); });
}

} // namespace evod::viewer
