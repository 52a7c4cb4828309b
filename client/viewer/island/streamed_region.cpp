#include "client/viewer/island/streamed_region.h"

namespace evod::viewer {

std::optional<evod::v1::View> StreamedRegion::update(const Camera& camera, evod::v1::Detail detail,
                                                     Clock::time_point now) {
    const Rectangle visible = camera.visible();
    const bool covered = region_ && region_->contains({visible.left, visible.top}) &&
                         region_->contains({visible.left + visible.width, visible.top + visible.height});
    const bool is_far_too_large = region_ && region_->width > 6 * visible.width;
    if ((covered && !is_far_too_large && detail == detail_) || (region_ && now - changed_ < interval)) {
        return std::nullopt;
    }
    region_ = {visible.left - visible.width / 2, visible.top - visible.height / 2, 2 * visible.width,
               2 * visible.height};
    detail_ = detail;
    changed_ = now;
    evod::v1::View view;
    view.mutable_region()->set_left_px(region_->left);
    view.mutable_region()->set_top_px(region_->top);
    view.mutable_region()->set_width_px(region_->width);
    view.mutable_region()->set_height_px(region_->height);
    view.set_detail(detail);
    return view;
}

} // namespace evod::viewer
